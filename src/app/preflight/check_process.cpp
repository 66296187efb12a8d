// Compares prior draws of the hyper-parameters with the data of the regressions that use them.
#include "app/preflight/check_process.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "app/process/process_fit.hpp"
#include "app/session/fit_target.hpp"
#include "core/numeric/statistics.hpp"
#include "core/text/number.hpp"
#include "diagnostics/prior_checks.hpp"
#include "gaussian_process/regression.hpp"

namespace sysid {
namespace {

constexpr int draws = 64;
constexpr double nearly_straight = 30;  // a length so many times the range of its input
constexpr double most = 0.5;            // share of the draws

ProcessPage::Spread spread_of(std::vector<double> const& values) {
  return {quantile(values, 0.05), quantile(values, 0.5), quantile(values, 0.95)};
}

double share(std::vector<double> const& values, auto const& condition) {
  return static_cast<double>(std::count_if(values.begin(), values.end(), condition)) / static_cast<double>(values.size());
}

/// The places of one input along all records, sorted, each once.
struct Places {
  std::vector<double> distinct;

  explicit Places(Eigen::VectorXd const& column) : distinct(column.begin(), column.end()) {
    std::sort(distinct.begin(), distinct.end());
    distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  }
  double range() const { return distinct.back() - distinct.front(); }
  /// The middle of the gaps between neighbours; 0 of a constant.
  double spacing() const {
    std::vector<double> gaps;
    for (std::size_t i = 1; i < distinct.size(); ++i) gaps.push_back(distinct[i] - distinct[i - 1]);
    return gaps.empty() ? 0 : quantile(gaps, 0.5);
  }
};

/// Rows whose inputs are those of an earlier one.
int repeated_rows(Eigen::MatrixXd const& inputs) {
  std::vector<std::vector<double>> rows;
  for (Eigen::Index i = 0; i < inputs.rows(); ++i) rows.emplace_back(inputs.row(i).begin(), inputs.row(i).end());
  std::sort(rows.begin(), rows.end());
  return static_cast<int>(rows.end() - std::unique(rows.begin(), rows.end()));
}

class ProcessPreflight {
 public:
  ProcessPreflight(Session& session, FitTask const& what, std::vector<ExperimentData> const& data, PreflightPage& page)
      : page_(page),
        model_(process_model(session, what, what.prediction)),
        target_(process_target(what, model_, experiments_of(data), what.solver, session.abandonable())),
        experiments_(static_cast<int>(data.size())),
        seed_(session.options.seed.value_or(what.seed.value_or(1))) {}

  void run() {
    for (int c = 0; c < static_cast<int>(model_->channels().size()); ++c) channel(c);
  }

 private:
  using Regression = ProcessTarget::Regression;

  void channel(int c) {
    std::vector<Regression> const drawn = regressions(c);
    page_.processes.emplace_back();
    ProcessPage& out = page_.processes.back();
    ProcessChannel const& layout = model_->channels()[static_cast<std::size_t>(c)];
    Channel const& declared = model_->model().channels[static_cast<std::size_t>(layout.channel)];
    out.channel = declared.name;
    out.draws = draws;
    out.failed = draws - static_cast<int>(drawn.size());
    if (out.failed > many_failures * draws)
      add(FindingCode::prior_fails, out.failed == draws ? Severity::error : Severity::warning, {declared.name},
          fmt::format("at {} of {} prior draws the likelihood of {} is not finite: {}", out.failed, draws, declared.name,
                      model_->model().integrated() ? "the simulation fails, or a hyper-parameter is not positive"
                                                   : "a hyper-parameter or the noise is not positive"),
          "narrow the priors: amplitudes, lengths and noise must be positive");
    if (drawn.empty()) return;
    Regression const& first = drawn.front();
    out.rows = static_cast<int>(first.observations.values.size());
    out.repeated = repeated_rows(first.observations.inputs);
    out.filtered = gaussian_process::filters(layout.covariance, first.observations);
    auto const [bytes, seconds] = gaussian_process::dense_work(out.rows);
    out.bytes = out.filtered ? 0 : bytes;
    out.seconds = out.filtered ? 0 : seconds;
    double const measured = std::sqrt(target_->measured_variance(c));
    out.measured_sd = width(declared, measured);
    out.unit = declared.unit_text();
    std::size_t k = 0;
    Eigen::Index column = 0;
    for (Process const& process : model_->model().processes) {
      if (process.channel != layout.channel) continue;
      for (KernelUse const& kernel : process.kernels)
        for (gaussian_process::HyperParameterRow const& row : kernel.row->hyper_parameters)
          for (std::size_t d = 0; d < (row.per_input ? kernel.inputs.size() : 1); ++d, ++k)
            hyper_parameter(process, row, kernel.inputs.empty() ? 0 : kernel.inputs[d], column, values(drawn, k), measured, first,
                            out);
      column += static_cast<Eigen::Index>(process.inputs.size());
    }
    std::vector<double> const noise = values(drawn, k);
    ProcessPage::Line line{"noise of " + declared.name, "sd", declared.unit_text(), {}, {}};
    std::vector<double> shown;
    for (double const each : noise) shown.push_back(width(declared, each));
    line.prior = spread_of(shown);
    out.lines.push_back(std::move(line));
    far_from_data(nullptr, noise, measured, declared.name);
  }

  /// Of one channel at prior draws, where there is one.
  std::vector<Regression> regressions(int c) const {
    ParameterSpace const& space = *target_->space();
    LaneArray theta(space.dimension(), draws);
    space.sample_prior({seed_, Purpose::prior, 0, 0}, theta);
    LaneArray const values = space.values(theta);
    std::vector<Regression> found;
    LaneArray all(static_cast<int>(model_->model().parameters.size()), draws), own(all.rows(), experiments_);
    std::vector<LaneArray> of_experiment;
    for (int e = 0; e < experiments_; ++e) {
      space.select(values, e, all);
      of_experiment.push_back(all);
    }
    for (int w = 0; w < draws; ++w) {
      for (int e = 0; e < experiments_; ++e)
        for (int p = 0; p < own.rows(); ++p) own(p, e) = of_experiment[static_cast<std::size_t>(e)](p, w);
      if (auto regression = target_->regression(own, c, false)) found.push_back(std::move(*regression));
    }
    return found;
  }

  static std::vector<double> values(std::vector<Regression> const& drawn, std::size_t k) {
    std::vector<double> result;
    for (Regression const& each : drawn) result.push_back(each.parameters[k]);
    return result;
  }

  /// A difference in the declared unit.
  static double width(Quantity const& quantity, double si) { return quantity.from_si(si) - quantity.from_si(0); }

  void hyper_parameter(Process const& process, gaussian_process::HyperParameterRow const& row, int input, Eigen::Index column,
                       std::vector<double> const& drawn, double measured, Regression const& first, ProcessPage& out) {
    bool const amplitude = row.unit.output == 1 && row.unit.input == 0, length = row.per_input && row.unit.input == 1;
    if (!amplitude && !length) return;
    Quantity const& quantity = length ? process.inputs[static_cast<std::size_t>(input)] : static_cast<Quantity const&>(process);
    std::vector<double> shown;
    for (double const each : drawn) shown.push_back(width(quantity, each));
    ProcessPage::Line line{process.name, std::string(row.name), quantity.unit_text(), spread_of(shown), {}};
    if (amplitude) {
      far_from_data(&process, drawn, measured, out.channel);
    } else {
      Places const places(first.observations.inputs.col(column + input));
      line.name += " in " + quantity.name;
      line.inputs = ProcessPage::Inputs{width(quantity, places.range()), width(quantity, places.spacing()),
                                        static_cast<int>(places.distinct.size())};
      lengths(process, quantity, drawn, places);
    }
    // Lags of one input share a length.
    bool const said = std::any_of(out.lines.begin(), out.lines.end(), [&](ProcessPage::Line const& other) {
      return other.name == line.name && other.what == line.what && other.prior.middle == line.prior.middle;
    });
    if (!said) out.lines.push_back(std::move(line));
  }

  void lengths(Process const& process, Quantity const& input, std::vector<double> const& drawn, Places const& places) {
    if (places.distinct.size() < 2)
      return add(
          FindingCode::length_and_inputs, Severity::warning, {process.name, input.name},
          fmt::format("{} of `{}` is constant along the data: its length-scale cannot be estimated", input.name, process.name),
          "leave it out of the function, or add a record along which it changes");
    double const spacing = places.spacing(), range = places.range();
    if (double const part = share(drawn, [&](double length) { return length < spacing; }); part >= most)
      add(FindingCode::length_and_inputs, Severity::warning, {process.name, input.name},
          fmt::format("for {:.0f} % of the prior draws the length-scale of `{}` along {} is shorter than the spacing of the "
                      "inputs: the function then acts as additional noise",
                      100 * part, process.name, input.name),
          "check the unit of the input and the prior of the length");
    else if (double const flat = share(drawn, [&](double length) { return length > nearly_straight * range; }); flat >= most)
      add(FindingCode::length_and_inputs, Severity::warning, {process.name, input.name},
          fmt::format("for {:.0f} % of the prior draws the length-scale of `{}` along {} is longer than {} times the range of the "
                      "inputs: the function is then nearly a straight line",
                      100 * flat, process.name, input.name, nearly_straight),
          "check the unit of the input and the prior of the length");
  }

  /// process: nothing where it is the noise of the channel.
  void far_from_data(Process const* process, std::vector<double> const& drawn, double measured, std::string const& channel) {
    if (!(measured > 0)) return;
    double const ratio = quantile(drawn, 0.5) / measured;
    bool const far = ratio > wild || (process != nullptr && ratio < 1 / wild);
    if (!far) return;
    std::vector<std::string> names{channel};
    if (process != nullptr) names.push_back(process->name);
    std::string const what =
        process != nullptr ? fmt::format("the prior amplitude of `{}`", process->name) : "the prior sd of the noise of " + channel;
    page_.findings.push_back(prior_far_from_data(
        std::move(names),
        fmt::format("{} (median of the draws) is {} than the sd of the measured {}", what, times_apart(ratio), channel)));
  }

  void add(FindingCode code, Severity severity, std::vector<std::string> names, std::string message, std::string help) {
    page_.findings.push_back({code, severity, std::move(names), std::move(message), std::move(help)});
  }

  PreflightPage& page_;
  std::shared_ptr<ProcessModel const> model_;
  std::unique_ptr<ProcessTarget> target_;
  int experiments_;
  std::uint64_t seed_;
};

}  // namespace

void preflight_processes(Session& session, FitTask const& what, std::vector<ExperimentData> const& data, PreflightPage& page) {
  ProcessPreflight(session, what, data, page).run();
}

}  // namespace sysid
