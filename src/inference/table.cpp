// The back ends, one line each, in the order `sysid list` prints them. A new one is a file that exports `settings` and `run`
// (inference/backend/backend.hpp), and a line here.
#include "inference/table.hpp"

#include "core/setting/table.hpp"
#include "inference/automatic.hpp"
#include "inference/chain/mh.hpp"
#include "inference/chain/tempering.hpp"
#include "inference/nuts/nuts.hpp"
#include "inference/optimum.hpp"

namespace sysid {
namespace {

BackendRow const backend_rows[] = {
    {"mh",
     "Metropolis-Hastings chains: proposals drawn around the modes, independent of the current state, and random walks",
     {},
     ObjectiveKind::posterior,
     mh::settings(),
     &mh::refuse,
     &mh::run},
    {"nuts",
     "no-U-turn chains: trajectories guided by the gradient of the log density",
     {.exact_likelihood = true},
     ObjectiveKind::posterior,
     nuts::settings(),
     &nuts::refuse,
     &nuts::run},
    {"tempering",
     "replica exchange between prior and posterior, for several modes and curved or flat posteriors",
     {.exact_likelihood = true},
     ObjectiveKind::posterior,
     tempering::settings(),
     &tempering::refuse,
     &tempering::run},
    {"auto",
     "mh, nuts or tempering, chosen by what the search has found",
     {},
     ObjectiveKind::posterior,
     {},
     &no_refusal,
     &automatic::run},
    {"map",
     "maximum a posteriori (MAP) estimate, with Laplace standard deviations",
     {.exact_likelihood = true},
     ObjectiveKind::declared_posterior,
     {},
     &no_refusal,
     &optimum::run_map},
    {"ml",
     "maximum-likelihood estimate, with Laplace standard deviations",
     {.exact_likelihood = true},
     ObjectiveKind::likelihood,
     {},
     &no_refusal,
     &optimum::run_ml},
};

}  // namespace

std::span<BackendRow const> backends() { return backend_rows; }

BackendRow const* find_backend(std::string_view name) { return row_named(backend_rows, name); }

}  // namespace sysid
