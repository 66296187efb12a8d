// The back ends, one line each, in the order `sysid list` prints them.
#include "core/table.hpp"
#include "inference/backend.hpp"
#include "inference/mh.hpp"
#include "inference/optimum.hpp"

namespace sysid {
namespace {

BackendRow const backend_rows[] = {
    {"mh",
     "Metropolis-Hastings chains, adaptive or spherical Gaussian proposal",
     {.proper_prior = true},
     Aim::posterior,
     mh::settings(),
     &mh::refuse,
     &mh::run},
    {"map",
     "the most probable parameters, with Laplace standard deviations",
     {.proper_prior = true},
     Aim::declared_posterior,
     {},
     &no_refusal,
     &optimum::run_map},
    {"ml",
     "the likeliest parameters, with Laplace standard deviations",
     {.proper_prior = true},
     Aim::likelihood,
     {},
     &no_refusal,
     &optimum::run_ml},
};

}  // namespace

std::span<BackendRow const> backends() { return backend_rows; }

BackendRow const* find_backend(std::string_view name) { return row_named(backend_rows, name); }

std::vector<Summary> summarise(FitResult const& result) {
  if (!result.summaries.empty()) return result.summaries;
  std::vector<Summary> summaries;
  for (int p = 0; p < result.draws.parameter_count; ++p) {
    auto const parameter = static_cast<std::size_t>(p);
    ChainValues values;
    if (!result.unthinned.empty()) {
      values = result.unthinned[parameter];
    } else {
      for (Chain const& chain : result.draws.chains) {
        values.emplace_back();
        for (auto const& draw : chain.values) values.back().push_back(draw[parameter]);
      }
    }
    summaries.push_back(summarise(result.draws.names[parameter], result.draws.units[parameter], values));
  }
  return summaries;
}

}  // namespace sysid
