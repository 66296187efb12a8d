// Draws and predictions as CSV: comment lines (#) in the head alone, one header, shortest round-trip decimals.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "result/report.hpp"

namespace sysid {

/// As a field of CSV: in quotes where it must be.
std::string csv_field(std::string const& text);

/// A name as Stan's CSV writes it, so that CmdStan's tools, posterior and ArviZ read vectors and parts: `k.1` for k[1], `M.1.2`
/// for M[1, 2], and Stan's sign for a member of a tuple, `joint:k`, for joint.k, since a dot means an index there.
std::string stan_name(std::string const& name);

/// The comment lines that begin every file: program, model, task, seed, data, settings.
std::string csv_head(Report const& report, std::string_view model = {});

/// A chain in the form of Stan's CSV: lp__, accept_stat__, log_prior__, log_likelihood__, then the user's names. `chain` from 0.
std::string draws_csv(Report const& report, int chain);

/// The columns of variances that are there, by the end of their names: "_parameter_variance", "_model_variance", "_noise_variance".
template <class Parts>
auto variance_columns(Parts& parts) {
  std::vector<std::pair<char const*, decltype(&parts.model)>> columns;
  for (auto const& [name, column] : {std::pair("_parameter_variance", &parts.parameter), std::pair("_model_variance", &parts.model),
                                     std::pair("_noise_variance", &parts.noise)})
    if (!column->empty()) columns.emplace_back(name, column);
  return columns;
}

/// t, then per quantity NAME_mean, _sd, _q2.5, _q97.5, with noise NAME_noisy_mean, ..., of an average over models the columns of
/// variances, NAME_measured; last `scored` (0 or 1).
std::string predict_csv(Report const& report, Prediction const& prediction);

/// The scored samples, one a line: which series (channel of an experiment, named in the head), row of the file, and what the sample
/// contributes to each predictive score. The report has criteria.
std::string pointwise_csv(Report const& report);

}  // namespace sysid
