// Leave-one-out predictions in closed form, and the findings based on them.
#include "app/process/process_scores.hpp"

#include <fmt/format.h>

#include <cmath>

#include "app/process/process_draws.hpp"
#include "diagnostics/bands.hpp"
#include "diagnostics/residuals/residual_tests.hpp"
#include "gaussian_process/concern.hpp"
#include "gaussian_process/leave_one_out.hpp"

namespace sysid {
namespace {

constexpr int most_samples = 5000;
constexpr double far = 2;  // ranges of the inputs fitted

// What the inputs that were fitted leave to the prior.
void look_at_inputs(ProcessTarget const& target, std::size_t c, ProcessTarget::Regression const& regression, Findings& findings) {
  ProcessChannel const& layout = target.model().channels()[c];
  Eigen::MatrixXd const& inputs = regression.observations.inputs;
  std::vector<int> columns;
  std::vector<std::pair<std::string, std::string>> names;  // of the process and its input
  for (Process const& process : target.model().model().processes)
    for (Quantity const& input : process.inputs)
      if (process.channel == static_cast<int>(c)) {
        columns.push_back(static_cast<int>(columns.size()));
        names.emplace_back(process.name, input.name);
      }
  if (int const repeated = gaussian_process::repeated_inputs(inputs, columns); repeated > 0)
    findings.push_back(
        {FindingCode::duplicate_inputs,
         Severity::note,
         {target.model().model().channels[c].name},
         fmt::format("{} of {} samples of {} have the same inputs as another sample: differences between them are treated as noise",
                     repeated, inputs.rows(), target.model().model().channels[c].name),
         ""});
  auto const hyper_parameters = layout.covariance.hyper_parameters();
  std::pair<std::string, std::string> last;
  for (std::size_t k = 0; k < hyper_parameters.size(); ++k) {
    if (hyper_parameters[k].name != "length" || hyper_parameters[k].column < 0) continue;
    auto const column = inputs.col(hyper_parameters[k].column);
    double const range = column.maxCoeff() - column.minCoeff();
    auto const& name = names[static_cast<std::size_t>(hyper_parameters[k].column)];
    bool const scaled = hyper_parameters[k].unit.input == 1;  // of the periodic kernel it is a pure number
    if (!scaled || range <= 0 || regression.parameters[k] <= far * range || name == last) continue;
    last = name;
    findings.push_back({FindingCode::length_beyond_range,
                        Severity::note,
                        {name.first, name.second},
                        fmt::format("the length-scale of `{1}` along `{0}` is {2:.2g} times the range that was fitted: along this "
                                    "input the process is constant or linear, and the prior determines the length-scale",
                                    name.second, name.first, regression.parameters[k] / range),
                        "remove the input if the fit is as good without it; otherwise add a linear term to the parametric part"});
  }
}

}  // namespace

FitCheck score_leave_one_out(ProcessTarget const& target, ParameterSpace const& all, std::vector<double> const& declared,
                             std::vector<ExperimentData> const& data) {
  FitCheck result;
  LaneArray const parameters = fitted_parameters(all, declared);
  std::string names;
  for (ExperimentData const& each : data) names += (names.empty() ? "" : ", ") + each.experiment.name;
  for (std::size_t c = 0; c < target.model().channels().size(); ++c) {
    Channel const& channel = target.model().model().channels[c];
    auto const regression = target.regression(parameters, static_cast<int>(c), false);
    if (regression) look_at_inputs(target, c, *regression, result.findings);
    if (!regression || regression->observations.values.size() > most_samples) continue;
    auto const leave_one_out =
        gaussian_process::leave_one_out(target.model().channels()[c].covariance, regression->observations, regression->parameters);
    if (leave_one_out.mean.size() == 0) continue;
    std::vector<double> observed, predicted, standardised;
    int inside = 0;
    for (Eigen::Index i = 0; i < leave_one_out.mean.size(); ++i) {
      // Of what the process is to explain; the parametric part is the same on both sides.
      observed.push_back(channel.from_si(regression->observations.values[i]));
      predicted.push_back(channel.from_si(leave_one_out.mean[i]));
      standardised.push_back((regression->observations.values[i] - leave_one_out.mean[i]) / std::sqrt(leave_one_out.variance[i]));
      inside += std::fabs(standardised.back()) <= 1.959964;
    }
    double const unit_squared = std::pow(rmse(observed, predicted), 2);
    double const measured = target.measured_variance(static_cast<int>(c)) * std::pow(channel.from_si(1), 2);
    FitLine line{names, channel.name, channel.unit_text(), {}};
    line.scores.push_back({{ScoreKind::nmse_left_out}, 100 * unit_squared / measured});
    line.scores.push_back({{ScoreKind::rmse}, rmse(observed, predicted)});
    line.scores.push_back({{ScoreKind::coverage_95}, static_cast<double>(inside) / static_cast<double>(standardised.size())});
    // They are correlated, but in mean square of size one.
    ChiSquaredTest const size = chi_squared(standardised);
    line.scores.push_back({{ScoreKind::chi_squared}, size.per_sample});
    result.lines.push_back(std::move(line));
  }
  return result;
}

Findings channel_band_findings(Prediction prediction, Model const& model, int failed, bool several) {
  prediction.quantities.resize(model.channels.size());  // as ProcessForecast::quantities orders them
  return band_findings(prediction, failed, failed, several);
}

}  // namespace sysid
