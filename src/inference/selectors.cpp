// The selecting back ends, one line each, in the order `sysid list` prints them.
#include "inference/table.hpp"

#include "core/setting/table.hpp"
#include "inference/abc/abc_smc.hpp"
#include "inference/abc/settings.hpp"
#include "inference/jump/plan.hpp"
#include "inference/jump/reversible_jump.hpp"

namespace sysid {
namespace {

SelectorRow const selector_rows[] = {
    {"abc_smc", "approximate Bayesian computation (ABC) by sequential Monte Carlo, over models and parameters", abc::settings(),
     &abc::refuse, &abc::run},
    {"reversible_jump", "reversible-jump Markov chains: jumps between models, with probabilities from their likelihoods",
     jump::settings(), &jump::refuse, nullptr, &jump::run},
};

}  // namespace

std::span<SelectorRow const> selectors() { return selector_rows; }

SelectorRow const* find_selector(std::string_view name) { return row_named(selector_rows, name); }

}  // namespace sysid
