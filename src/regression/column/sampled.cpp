// One projection for all of them; they differ in the smoother.
#include "regression/column/sampled.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "regression/column/evaluation.hpp"
#include "regression/column/signals.hpp"
#include "regression/column/smoothing.hpp"

namespace sysid::regression {
namespace {

using Samples = std::vector<double>;

/// A linear filter for derivatives, for a step of 1; NaN where it cannot say.
struct Smoother {
  /// noise_sd: of the channel.
  std::function<Samples(std::span<double const>, int derivative, double noise_sd)> channel;
  /// reference: the first channel that the equation reads, and its noise.
  std::function<Samples(std::span<double const> input, std::span<double const> reference, double noise_sd)> input;
  bool derives = true;
};

class SampledProjection : public Projection {
 public:
  SampledProjection(Dictionary dictionary, std::span<Experiment const> experiments, Smoother smoother)
      : dictionary_(std::move(dictionary)),
        experiments_(experiments.begin(), experiments.end()),
        smoother_(std::move(smoother)),
        noise_sd_(noise_of_channels(dictionary_, experiments_)) {
    for (Equation const& equation : dictionary_.equations) project(equation);
  }

  Columns const& columns(int equation) const override { return columns_[static_cast<std::size_t>(equation)]; }
  Columns whitened(int equation, Eigen::VectorXd const&, double) const override { return columns(equation); }
  double own_noise(int, Eigen::VectorXd const&) const override { return 0; }
  int reweightings() const override { return 0; }
  ResidualSize residual_size() const override { return ResidualSize::propagated; }
  std::vector<double> const& noise_sd() const override { return noise_sd_; }
  int half_width() const override { return 0; }
  Concerns const& concerns(int equation) const override { return concerns_[static_cast<std::size_t>(equation)]; }

 private:
  void project(Equation const& equation) {
    Columns& columns = columns_.emplace_back();
    Concerns& concerns = concerns_.emplace_back();
    std::vector<NodeId> roots = {equation.known};
    for (Term const& term : equation.terms) roots.push_back(term.expression);
    std::vector<Symbol> const symbols = symbols_below(dictionary_, roots);
    std::vector<int> used;
    for (Symbol const& symbol : symbols) {
      if (symbol.kind != Symbol::Kind::state) continue;
      int const channel = smoother_.derives ? base_channel(dictionary_, symbol.index, symbol.order)
                                            : channel_of(dictionary_, symbol.index, symbol.order);
      if (channel < 0) {
        Concern concern{.kind = Concern::Kind::not_measured};
        concern.clause = fmt::format("no channel measures `{}`{}", symbol_text(dictionary_, symbol.index, symbol.order),
                                     smoother_.derives ? ", or a quantity that gives it by differentiation" : "");
        concerns.push_back(std::move(concern));
      } else if (std::find(used.begin(), used.end(), channel) == used.end()) {
        used.push_back(channel);
      }
    }
    Concerns const of_record = record_concerns(dictionary_, experiments_, used);
    concerns.insert(concerns.end(), of_record.begin(), of_record.end());
    if (any_fatal(concerns)) return;

    std::vector<Eigen::MatrixXd> blocks;
    for (Experiment const& experiment : experiments_) blocks.push_back(block(experiment, roots, symbols, used));
    columns = stacked(blocks, equation.terms.size());
  }

  /// Roots at the samples where every symbol has a value: [rows x roots].
  Eigen::MatrixXd block(Experiment const& experiment, std::vector<NodeId> const& roots, std::vector<Symbol> const& symbols,
                        std::vector<int> const& used) {
    int const count = static_cast<int>(experiment.time.size());
    double const step = *uniform_step(experiment);
    std::map<NodeId, Samples> values;
    for (Symbol const& symbol : symbols) values[symbol.leaf] = symbol_values(symbol, experiment, step, used);
    Eigen::MatrixXd const all = evaluate_columns(
        dictionary_.graph, roots, [&](NodeId leaf) -> std::span<double const> { return values.at(leaf); }, count);
    std::vector<int> rows;
    for (int i = 0; i < count; ++i)
      if (usable(experiment, {}, i) && std::all_of(values.begin(), values.end(), [&](auto const& entry) {
            return std::isfinite(entry.second[static_cast<std::size_t>(i)]);
          }))
        rows.push_back(i);
    return rows_at(all, rows);
  }

  Samples symbol_values(Symbol const& symbol, Experiment const& experiment, double step, std::vector<int> const& used) const {
    if (symbol.kind == Symbol::Kind::time) return experiment.time;
    if (symbol.kind == Symbol::Kind::input) {
      InputSides const sides = input_sides(experiment.inputs[static_cast<std::size_t>(symbol.index)], symbol.order);
      Samples acting;
      for (std::size_t i = 0; i < sides.after.size(); ++i) acting.push_back((sides.before[i] + sides.after[i]) / 2);
      if (used.empty()) return acting;
      auto const reference = static_cast<std::size_t>(used.front());
      return smoother_.input(acting, experiment.measured[reference], noise_sd_[reference]);
    }
    auto const channel = static_cast<std::size_t>(smoother_.derives ? base_channel(dictionary_, symbol.index, symbol.order)
                                                                    : channel_of(dictionary_, symbol.index, symbol.order));
    int const derivative = symbol.order - dictionary_.channels[channel].order;
    Samples smooth = smoother_.channel(experiment.measured[channel], derivative, noise_sd_[channel]);
    for (int k = 0; k < derivative; ++k)
      for (double& value : smooth) value /= step;
    return smooth;
  }

  Dictionary dictionary_;
  std::vector<Experiment> experiments_;
  Smoother smoother_;
  std::vector<double> noise_sd_;
  std::vector<Columns> columns_;
  std::vector<Concerns> concerns_;
};

Samples copy(std::span<double const> samples) { return {samples.begin(), samples.end()}; }

}  // namespace

namespace savitzky_golay {
namespace {
constexpr SettingRow rows[] = {
    {"window", SettingKind::integer, "21", 3, 100001, "", "number of samples of a local polynomial, odd"},
    {"order", SettingKind::integer, "5", 1, 12, "", "degree of the local polynomial"},
};
}  // namespace

std::span<SettingRow const> settings() { return rows; }

std::string refuse(Settings const& settings, int derivatives) {
  if (settings.integer("window") % 2 == 0) return "window must be odd";
  if (settings.integer("order") >= settings.integer("window")) return "order must be smaller than window";
  if (settings.integer("order") < derivatives)
    return fmt::format("order must be {} at least: the equation needs this derivative of what is measured", derivatives);
  return {};
}

std::unique_ptr<Projection> project(Dictionary const& dictionary, std::span<Experiment const> experiments,
                                    Settings const& settings) {
  int const half = static_cast<int>(settings.integer("window")) / 2, degree = static_cast<int>(settings.integer("order"));
  auto const pass = [half, degree](std::span<double const> samples, int derivative, double) {
    if (derivative > degree) return Samples(samples.size(), 0.0);
    return filtered(samples, savitzky_golay_weights(half, degree, derivative), 1);
  };
  return std::make_unique<SampledProjection>(
      dictionary, experiments,
      Smoother{pass, [pass](std::span<double const> input, std::span<double const>, double) { return pass(input, 0, 0); }});
}
}  // namespace savitzky_golay

namespace smoothing_spline {
namespace {

constexpr SettingRow rows[] = {
    {"penalty", SettingKind::real, "0", 0, 1e16, "",
     "weight of the squared third derivative, with time in sampling intervals; 0: chosen so that the residual is as large as the "
     "noise"},
};
constexpr int margin = 5;  // samples left out at the ends, where high derivatives of a spline are not to be trusted

Samples smooth(std::span<double const> samples, int derivative, double penalty) {
  Samples values = SmoothingSpline(samples, penalty).derivative(derivative);
  double const missing = std::numeric_limits<double>::quiet_NaN();
  std::size_t const n = values.size();
  for (std::size_t i = 0; i < n; ++i)
    if (i < margin || i + margin >= n || !std::isfinite(samples[i])) values[i] = missing;
  return values;
}

}  // namespace

std::span<SettingRow const> settings() { return rows; }

std::unique_ptr<Projection> project(Dictionary const& dictionary, std::span<Experiment const> experiments,
                                    Settings const& settings) {
  double const fixed = settings.real("penalty");
  auto const penalty = [fixed](std::span<double const> samples, double noise_sd) {
    return fixed > 0 ? fixed : penalty_for_noise(samples, noise_sd);
  };
  auto const of_channel = [penalty](std::span<double const> samples, int derivative, double noise_sd) {
    if (derivative > 3 || samples.size() < 2 * margin + 1) return Samples(samples.size(), std::numeric_limits<double>::quiet_NaN());
    return smooth(samples, derivative, penalty(samples, noise_sd));
  };
  auto const of_input = [penalty](std::span<double const> input, std::span<double const> reference, double noise_sd) {
    if (input.size() < 2 * margin + 1) return Samples(input.size(), std::numeric_limits<double>::quiet_NaN());
    return smooth(input, 0, penalty(reference, noise_sd));
  };
  return std::make_unique<SampledProjection>(dictionary, experiments, Smoother{of_channel, of_input});
}
}  // namespace smoothing_spline

namespace central {
std::unique_ptr<Projection> project(Dictionary const& dictionary, std::span<Experiment const> experiments, Settings const&) {
  auto const difference = [](std::span<double const> samples, int derivative, double) {
    Samples values = copy(samples);
    constexpr double first[] = {-0.5, 0, 0.5}, second[] = {1, -2, 1};
    for (int left = derivative; left > 0; left -= left >= 2 ? 2 : 1)
      values = filtered(values, left >= 2 ? std::span<double const>(second) : std::span<double const>(first), 1);
    return values;
  };
  auto const keep = [](std::span<double const> input, std::span<double const>, double) { return copy(input); };
  return std::make_unique<SampledProjection>(dictionary, experiments, Smoother{difference, keep});
}
}  // namespace central

namespace measured {
std::unique_ptr<Projection> project(Dictionary const& dictionary, std::span<Experiment const> experiments, Settings const&) {
  auto const channel = [](std::span<double const> samples, int, double) { return copy(samples); };
  auto const input = [](std::span<double const> samples, std::span<double const>, double) { return copy(samples); };
  return std::make_unique<SampledProjection>(dictionary, experiments, Smoother{channel, input, false});
}
}  // namespace measured

}  // namespace sysid::regression
