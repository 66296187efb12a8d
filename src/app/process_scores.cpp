// Leave-one-out predictions in closed form, and what they say of the model.
#include "app/process_scores.hpp"

#include <fmt/format.h>

#include <cmath>

#include "app/process_draws.hpp"
#include "gaussian_process/left_out.hpp"
#include "inference/residual_tests.hpp"

namespace sysid {
namespace {

constexpr int most_samples = 5000;

}  // namespace

ProcessScores score_left_out(ProcessTarget const& target, ParameterSpace const& all, std::vector<double> const& declared,
                             std::vector<ExperimentData> const& data) {
  ProcessScores result;
  LaneArray const parameters = fitted_parameters(all, declared);
  std::string names;
  for (ExperimentData const& each : data) names += (names.empty() ? "" : ", ") + each.experiment.name;
  for (std::size_t c = 0; c < target.model().channels().size(); ++c) {
    Channel const& channel = target.model().model().channels[c];
    auto const regression = target.regression(parameters, static_cast<int>(c), false);
    if (!regression || regression->observations.values.size() > most_samples) continue;
    auto const left_out =
        gaussian_process::leave_one_out(target.model().channels()[c].covariance, regression->observations, regression->parameters);
    if (left_out.mean.size() == 0) continue;
    std::vector<double> observed, predicted, standardised;
    int inside = 0;
    for (Eigen::Index i = 0; i < left_out.mean.size(); ++i) {
      // Of what the process is to explain; the white part is the same on both sides.
      observed.push_back(channel.from_si(regression->observations.values[i]));
      predicted.push_back(channel.from_si(left_out.mean[i]));
      standardised.push_back((regression->observations.values[i] - left_out.mean[i]) / std::sqrt(left_out.variance[i]));
      inside += std::fabs(standardised.back()) <= 1.959964;
    }
    double const unit_squared = std::pow(rmse(observed, predicted), 2);
    double const measured = target.measured_variance(static_cast<int>(c)) * std::pow(channel.from_si(1), 2);
    FitLine line{names, channel.name, channel.unit_text(), {}};
    line.scores.push_back({"nmse_left_out", 100 * unit_squared / measured});
    line.scores.push_back({"rmse", rmse(observed, predicted)});
    line.scores.push_back({"coverage_95", static_cast<double>(inside) / static_cast<double>(standardised.size())});
    // They are correlated, but in mean square of size one.
    ChiSquaredTest const size = chi_squared(standardised);
    line.scores.push_back({"chi_squared_per_sample", size.per_sample});
    result.lines.push_back(std::move(line));
  }
  return result;
}

}  // namespace sysid
