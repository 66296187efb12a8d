// The slowest rate is one over the spectral radius of the Jacobian's inverse, found by squaring: units of states cancel in it.
#include "app/preflight/time_scales.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numeric/elementary.hpp"
#include "core/numeric/unit.hpp"
#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "data/table/reading_rules.hpp"
#include "linear_algebra/decompositions.hpp"
#include "model/state_jacobian.hpp"

namespace sysid {
namespace {

constexpr int scale_draws = 64;
constexpr std::size_t most_states = 12;
constexpr double part_of_record = 1e-5;
constexpr double within_a_step = 6.283185307179586;  // a whole oscillation, or a decay to 0.2 %, between two rows
constexpr double share_within_a_step = 0.95;         // a few draws of a wide prior may be slow

/// About the start of a record.
class Linearisation {
 public:
  explicit Linearisation(Model const& model) : model_(model), by_states_(model) {
    for (State const& by : model.states) initial_.push_back(by.initial);
  }

  struct Motion {
    double rate = 0;     // [1/s] of the slowest motion at the start; 0 where there is none
    bool grows = false;  // one of them
  };
  /// parameters [SI], inputs [SI], time [s].
  Motion slowest(std::vector<double> const& parameters, std::vector<double> const& inputs, double time) const {
    std::vector<double> state;
    auto const value = [&](Node const& node) {
      auto const index = static_cast<std::size_t>(node.index);
      switch (node.leaf_kind) {
        case LeafKind::parameter:
          return parameters[index];
        case LeafKind::state:
          return state[index];
        case LeafKind::input:
          return inputs[index];
        case LeafKind::time:
          return time;
        case LeafKind::input_rate:
        case LeafKind::disturbance:
          return 0.0;
        default:
          return std::numeric_limits<double>::quiet_NaN();
      }
    };
    state = model_.graph.evaluate(initial_, [&](NodeId leaf) { return value(model_.graph[leaf]); });
    Eigen::MatrixXd const jacobian = by_states_.at(value);
    if (!jacobian.allFinite() || !std::isfinite(log_absolute_determinant(jacobian))) return {};
    Eigen::MatrixXd power = inverse(jacobian);
    constexpr int squarings = 7;
    double log_size = 0, exponent = 1;  // of the inverse to the power of `exponent`, which is `power` times exp(log_size)
    for (int k = 0; k < squarings; ++k) {
      double const norm = power.norm();
      if (!std::isfinite(norm) || norm == 0) return {};
      power /= norm;
      log_size = 2 * (log_size + elementary::log(norm));
      exponent *= 2;
      power = (power * power).eval();
    }
    double const norm = power.norm();
    if (!std::isfinite(norm) || norm <= 0) return {};
    constexpr double rounding = 1e-10;
    return {elementary::exp(-(log_size + elementary::log(norm)) / exponent),
            largest_real_eigenvalue(jacobian) > rounding * jacobian.norm()};
  }

 private:
  Model const& model_;
  StateJacobian by_states_;
  std::vector<NodeId> initial_;
};

struct Rates {
  std::vector<double> slowest;  // [1/s] of the slowest motion, ascending over draws; 0 where there is none
  bool grow = false;            // at any of them
  double least() const { return slowest.front(); }
  double most() const { return slowest.back(); }
  auto above(double rate) const { return slowest.end() - std::upper_bound(slowest.begin(), slowest.end(), rate); }
};

Rates rates_of(Linearisation const& linear, ParameterSpace const& space, LaneArray const& values, int experiment,
               Experiment const& along) {
  LaneArray parameters(static_cast<int>(space.model().parameters.size()), values.width());
  space.select(values, experiment, parameters);
  std::vector<double> inputs;
  for (InputSignal const& input : along.inputs) inputs.push_back(input.sample(0));
  Rates rates;
  for (int w = 0; w < values.width(); ++w) {
    std::vector<double> own;
    for (int p = 0; p < parameters.rows(); ++p) own.push_back(parameters(p, w));
    auto const [rate, grows] = linear.slowest(own, inputs, along.time.front());
    rates.slowest.push_back(rate);
    rates.grow = rates.grow || grows;
  }
  std::sort(rates.slowest.begin(), rates.slowest.end());
  return rates;
}

/// "1/year" of a rate, "year" of a time, where the dimension is a power of time alone; else empty.
std::string unit_per(Unit const& unit, std::string const& of_time) {
  Dimension others = unit.dimension;
  auto const power = others[2];
  others[2] = {};
  if (others != Dimension{} || power.denominator != 1 || power.numerator == 0) return {};
  std::string const factor = std::abs(power.numerator) == 1 ? of_time : fmt::format("{}^{}", of_time, std::abs(power.numerator));
  if (power.numerator > 0) return factor;
  return fmt::format("{}/{}", unit.radian.numerator != 0 ? "rad" : "1", factor);
}

/// Sampled parameters with the unit that they have if their numbers are per unit of the record's time.
std::vector<std::string> declared_in(Model const& model, std::string const& of_time) {
  std::vector<std::string> all;
  for (Parameter const& parameter : model.parameters) {
    if (!parameter.prior || !parameter.unit) continue;
    std::string const unit = unit_per(*parameter.unit, of_time);
    if (!unit.empty() && unit != parameter.unit->text) all.push_back(fmt::format("parameter {} [{}]", parameter.name, unit));
  }
  return all;
}

std::string in_seconds(double seconds) { return significant(seconds, 2) + " s"; }

/// "`time t [ms]`" where the times are read in seconds; empty otherwise.
std::string in_milliseconds(DataBlock const& block, double scale) {
  if (scale != 1 || !block.time || !block.rules.stamp.empty()) return "";
  return fmt::format(": `time {}` if its numbers are milliseconds", column_text(block.time->column, "ms"));
}

Finding fast_finding(CheckedFile const& file, Model const& model, ExperimentData const& data, Rates const& rates, double step) {
  DataBlock const& block = file.data[static_cast<std::size_t>(data.use.data)];
  double const scale = data.experiment.time_unit ? data.experiment.time_unit->scale : 1;
  auto const fast = rates.above(within_a_step / step);
  double const least = rates.slowest[rates.slowest.size() - static_cast<std::size_t>(fast)];
  std::string const draws = fast == scale_draws ? "at every prior draw" : fmt::format("at {} of {} prior draws", fast, scale_draws);
  return {
      FindingCode::time_scales_apart,
      Severity::warning,
      {data.experiment.name},
      fmt::format("rows of {} are {} apart, but {} even the slowest motion of `{}` is over, or has made a whole oscillation, "
                  "before the next row: its rate is {} to {} rad/s",
                  data.experiment.name, in_seconds(step), draws, model.name, significant(least, 2), significant(rates.most(), 2)),
      fmt::format("correct the unit of {} in `{}`{}; or correct the units of the parameters that contain a time. If all units "
                  "are right: for a motion that decays between two rows, replace its equation by its steady state; if the "
                  "motion continues to oscillate over several rows, sample faster",
                  block.time          ? "`time`"
                  : block.step_stated ? "`step`"
                                      : "`rate`",
                  block.name, in_milliseconds(block, scale))};
}

Finding apart_finding(CheckedFile const& file, Model const& model, ExperimentData const& data, Rates const& rates) {
  Experiment const& experiment = data.experiment;
  double const length = experiment.time.back() - experiment.time.front();
  double const scale = experiment.time_unit ? experiment.time_unit->scale : 1;
  std::string const unit = experiment.time_unit ? experiment.time_unit->text : "s";
  std::string const words =
      scale == 1 ? in_seconds(length) : fmt::format("{} {}, which is {}", significant(length / scale, 3), unit, in_seconds(length));
  std::vector<std::string> const declared = scale == 1 ? std::vector<std::string>{} : declared_in(model, unit);
  std::string const block = file.data[static_cast<std::size_t>(data.use.data)].name;
  return {
      FindingCode::time_scales_apart,
      Severity::warning,
      {experiment.name},
      fmt::format("{} lasts {}, but at every prior draw even the slowest motion of `{}` takes only {} to {}: the unit of time or "
                  "the units of the rates are wrong",
                  experiment.name, words, model.name, in_seconds(1 / rates.most()), in_seconds(1 / rates.least())),
      declared.empty()
          ? fmt::format("correct the unit of `time` in `{}`, or the units of the parameters that contain a time", block)
          : fmt::format("write {}{}; or correct the unit of `time` in `{}`", quoted(declared),
                        declared.size() == 1 ? fmt::format(" if the numbers of its prior are per {}", unit)
                                             : fmt::format(" where the numbers of the prior are in [{}]", unit),
                        block)};
}

}  // namespace

std::optional<Finding> time_scales_apart(CheckedFile const& file, Model const& model, ParameterSpace const& space,
                                         std::vector<ExperimentData> const& data) {
  if (!model.integrated() || model.implicit || model.states.empty() || model.states.size() > most_states) return std::nullopt;
  if (!improper_coordinates(space.infos()).empty()) return std::nullopt;
  try {
    Linearisation const linear(model);
    LaneArray theta(space.dimension(), scale_draws);
    space.sample_prior({1, Purpose::start, 0, 0}, theta);
    LaneArray const values = space.values(theta);
    for (std::size_t e = 0; e < data.size(); ++e) {
      std::vector<double> const& time = data[e].experiment.time;
      if (time.size() < 3) continue;
      double shortest = std::numeric_limits<double>::infinity();
      for (std::size_t i = 1; i < time.size(); ++i) shortest = std::min(shortest, time[i] - time[i - 1]);
      Rates const rates = rates_of(linear, space, values, static_cast<int>(e), data[e].experiment);
      if (rates.least() * (time.back() - time.front()) * part_of_record > 1 && rates.least() * shortest > 1)
        return apart_finding(file, model, data[e], rates);
      bool const fast = static_cast<double>(rates.above(within_a_step / shortest)) > share_within_a_step * scale_draws;
      if (!model.filtered() && !rates.grow && fast) return fast_finding(file, model, data[e], rates, shortest);
    }
  } catch (InternalError const&) {  // a function without a derivative
  }
  return std::nullopt;
}

}  // namespace sysid
