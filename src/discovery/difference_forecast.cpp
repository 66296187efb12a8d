// Sample by sample through the graph of the dictionary.
#include "discovery/difference_forecast.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numeric/random.hpp"
#include "core/text/number.hpp"
#include "linear_algebra/decompositions.hpp"
#include "regression/column/signals.hpp"

namespace sysid {
namespace {

constexpr int settling_rows = 50;
constexpr int drawn_runs = 50;
constexpr double beyond_expected = 2;  // of the errors that add up along a free run
constexpr double rounding = 1e-9;      // of that sd
constexpr double worth_a_word = 0.1;   // of the sd of what is measured

using Samples = std::vector<std::vector<double>>;  // [state][row]

class DifferenceRun {
 public:
  DifferenceRun(regression::Dictionary const& dictionary, regression::Discovery const& discovery, Experiment const& experiment)
      : dictionary_(dictionary), experiment_(experiment), rows_(static_cast<int>(experiment.time.size())) {
    for (std::size_t e = 0; e < dictionary.equations.size(); ++e) {
      regression::Equation const& equation = dictionary.equations[e];
      regression::FoundEquation const& found = discovery.equations[e];
      Equation each{
          dictionary.graph[equation.known].index,       {}, found.chosen.coefficient, found.moving_average, found.own_noise,
          cholesky_or_diagonal(found.chosen.covariance)};
      for (int const term : found.chosen.terms) each.roots.push_back(equation.terms[static_cast<std::size_t>(term)].expression);
      equations_.push_back(std::move(each));
    }
    measured_.resize(dictionary.states.size());
    for (std::size_t c = 0; c < dictionary.channels.size(); ++c)
      measured_[static_cast<std::size_t>(dictionary.channels[c].state)] = experiment.measured[c];
    std::vector<NodeId> roots;
    for (Equation const& each : equations_) roots.insert(roots.end(), each.roots.begin(), each.roots.end());
    for (regression::Symbol const& symbol : regression::symbols_below(dictionary, roots)) lags_ = std::max(lags_, symbol.lag);
  }

  Samples const& measured() const { return measured_; }
  std::size_t state(std::size_t equation) const { return static_cast<std::size_t>(equations_[equation].state); }

  /// Of each equation what it predicts from measured samples, NaN where one that it reads is missing; the errors are kept.
  Samples one_step() {
    Samples predicted(equations_.size(), std::vector<double>(static_cast<std::size_t>(rows_), missing));
    Samples& errors = errors_ = predicted;
    for (int i = lags_; i < rows_; ++i)
      for (std::size_t e = 0; e < equations_.size(); ++e) {
        auto const row = static_cast<std::size_t>(i);
        predicted[e][row] = value(e, i, measured_, equations_[e].coefficients) + carried(e, i, errors[e]);
        errors[e][row] = measured_[state(e)][row] - predicted[e][row];
      }
    return predicted;
  }

  /// The first row from which a free run can go once errors before are known; nothing where there is none.
  std::optional<int> begin() const {
    for (int i = std::max(lags_, std::min(settling_rows, rows_ / 4)); i < rows_; ++i) {
      bool all = true;
      for (int k = 1; k <= lags_ && all; ++k)
        all = std::all_of(measured_.begin(), measured_.end(),
                          [&](auto const& each) { return std::isfinite(each[static_cast<std::size_t>(i - k)]); });
      if (all) return i;
    }
    return std::nullopt;
  }

  /// Channels of a free run that began at row `begin`.
  FreeMotion shown(int experiment, int begin, Samples const& free) const {
    FreeMotion out{experiment, 0, begin, {}};
    for (regression::Channel const& channel : dictionary_.channels)
      out.channels.push_back(free[static_cast<std::size_t>(channel.state)]);
    return out;
  }

  /// From row `begin` on by its own samples, with the errors that `one_step` had before it: where noise is a moving average they
  /// tell where the motion is behind the noise of its samples. Errors to come are 0, or drawn where there is a stream.
  Samples free_run(int begin, Stream* stream) const {
    Samples samples = measured_, errors = errors_;
    for (std::vector<double>& each : errors) std::fill(each.begin() + begin, each.end(), 0.0);
    std::vector<Eigen::VectorXd> coefficients;
    for (Equation const& each : equations_) {
      coefficients.push_back(each.coefficients);
      Eigen::VectorXd normals = Eigen::VectorXd::Zero(each.coefficients.size());
      for (double& normal : normals)
        if (stream != nullptr) normal = stream->normal();
      if (normals.size() > 0) coefficients.back() += each.spread * normals;
    }
    for (int i = begin; i < rows_; ++i) {
      auto const row = static_cast<std::size_t>(i);
      for (std::size_t e = 0; e < equations_.size(); ++e)
        if (stream != nullptr) errors[e][row] = equations_[e].noise_sd * stream->normal();
      for (std::size_t e = 0; e < equations_.size(); ++e)
        samples[state(e)][row] = value(e, i, samples, coefficients[e]) + carried(e, i, errors[e]) + errors[e][row];
    }
    return samples;
  }

 private:
  static constexpr double missing = std::numeric_limits<double>::quiet_NaN();

  struct Equation {
    int state;
    std::vector<NodeId> roots;
    Eigen::VectorXd coefficients;
    std::vector<double> moving_average;
    double noise_sd;
    Eigen::MatrixXd spread;  // times standard normal numbers: what the coefficients may be off by
  };

  double value(std::size_t e, int row, Samples const& samples, Eigen::VectorXd const& coefficients) const {
    std::vector<double> const terms = dictionary_.graph.evaluate(equations_[e].roots, [&](NodeId leaf) {
      regression::Symbol const& symbol = *regression::symbol_of(dictionary_, leaf);
      auto const past = static_cast<std::size_t>(row - symbol.lag), index = static_cast<std::size_t>(symbol.index);
      switch (symbol.kind) {
        case regression::Symbol::Kind::time:
          return experiment_.time[past];
        case regression::Symbol::Kind::input:
          return experiment_.inputs[index].sample(static_cast<int>(past));
        case regression::Symbol::Kind::state:
          return samples[index][past];
      }
      return missing;
    });
    double sum = 0;
    for (std::size_t k = 0; k < terms.size(); ++k) sum += coefficients(static_cast<Eigen::Index>(k)) * terms[k];
    return sum;
  }

  /// What errors of samples before add to this one; those that are not known count as 0.
  double carried(std::size_t e, int row, std::vector<double> const& errors) const {
    double sum = 0;
    std::vector<double> const& average = equations_[e].moving_average;
    for (int k = 1; k <= static_cast<int>(average.size()) && k <= row; ++k) {
      double const error = errors[static_cast<std::size_t>(row - k)];
      if (std::isfinite(error)) sum += average[static_cast<std::size_t>(k - 1)] * error;
    }
    return sum;
  }

  regression::Dictionary const& dictionary_;
  Experiment const& experiment_;
  int rows_, lags_ = 0;
  std::vector<Equation> equations_;
  Samples measured_, errors_;
};

struct MeanSquare {
  double sum = 0;
  int count = 0;
  void add(double error) {
    sum += error * error;
    ++count;
  }
  double root() const { return std::isfinite(sum) ? std::sqrt(sum / count) : std::numeric_limits<double>::infinity(); }
};

double sd_of(std::vector<double> const& values) {
  double mean = 0, squares = 0;
  for (double const value : values) mean += value / static_cast<double>(values.size());
  for (double const value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size()));
}

}  // namespace

DifferenceForecasts difference_forecasts(regression::Dictionary const& dictionary, regression::Discovery const& discovery,
                                         std::span<Experiment const> experiments, std::uint64_t seed) {
  std::size_t const count = dictionary.equations.size();
  DifferenceForecasts forecasts;
  std::vector<DifferenceErrors>& out = forecasts.errors;
  out.resize(count);
  std::vector<std::vector<double>> measured(count);
  std::vector<MeanSquare> one_step(count), free_run(count);
  std::vector<std::vector<MeanSquare>> drawn(count, std::vector<MeanSquare>(drawn_runs));
  for (std::size_t k = 0; k < experiments.size(); ++k) {
    DifferenceRun run(dictionary, discovery, experiments[k]);
    Samples const ahead = run.one_step();
    std::optional<int> const begin = run.begin();
    Samples const free = begin ? run.free_run(*begin, nullptr) : Samples();
    if (begin) forecasts.runs.push_back(run.shown(static_cast<int>(k), *begin, free));
    auto const each_row = [&](std::size_t e, int from, auto const& visit) {
      std::vector<double> const& samples = run.measured()[run.state(e)];
      for (std::size_t i = static_cast<std::size_t>(from); i < samples.size(); ++i)
        if (std::isfinite(samples[i])) visit(i, samples[i]);
    };
    for (std::size_t e = 0; e < count; ++e) {
      each_row(e, 0, [&](std::size_t i, double y) {
        measured[e].push_back(y);
        if (std::isfinite(ahead[e][i])) one_step[e].add(y - ahead[e][i]);
      });
      if (begin) each_row(e, *begin, [&](std::size_t i, double y) { free_run[e].add(y - free[run.state(e)][i]); });
    }
    for (int draw = 0; draw < drawn_runs && begin; ++draw) {
      Stream stream({seed, Purpose::prediction, k, static_cast<std::uint64_t>(draw)});
      Samples const noisy = run.free_run(*begin, &stream);
      for (std::size_t e = 0; e < count; ++e)
        each_row(e, *begin, [&](std::size_t i, double) {
          drawn[e][static_cast<std::size_t>(draw)].add(noisy[run.state(e)][i] - free[run.state(e)][i]);
        });
    }
  }
  for (std::size_t e = 0; e < count; ++e) {
    if (!measured[e].empty()) out[e].sd = sd_of(measured[e]);
    if (one_step[e].count > 0) out[e].one_step = one_step[e].root();
    if (free_run[e].count > 0) out[e].free_run = free_run[e].root();
    out[e].own_noise = discovery.equations[e].own_noise;
    if (free_run[e].count == 0) continue;
    std::vector<double> sizes;
    for (MeanSquare const& each : drawn[e]) sizes.push_back(each.root());
    out[e].diverging =
        static_cast<int>(std::count_if(sizes.begin(), sizes.end(), [](double size) { return !std::isfinite(size); }));
    std::sort(sizes.begin(), sizes.end());  // the median: few that diverge make no expectation
    out[e].expected = sizes[sizes.size() / 2];
  }
  return forecasts;
}

Findings forecast_findings(CheckedDictionary const& dictionary, std::vector<DifferenceErrors> const& errors,
                           std::string const& held_out) {
  Findings findings;
  auto const lost = [&](std::string message, std::string help) {
    findings.push_back({FindingCode::free_run_lost, Severity::warning, {held_out}, std::move(message), std::move(help)});
  };
  auto const percent = [](double part, double of) { return significant(100 * part / of, 3); };
  for (std::size_t e = 0; e < errors.size(); ++e) {
    DifferenceErrors const& each = errors[e];
    std::string const& target = dictionary.equations[e].text;
    if (each.one_step && *each.one_step > std::max(beyond_expected * each.own_noise, rounding * each.sd)) {
      lost(each.own_noise > 0
               ? fmt::format("the error of `{}` one sample ahead on {} is {} times that on the rows of the discovery", target,
                             held_out, significant(*each.one_step / each.own_noise, 3))
               : fmt::format("the error of `{}` one sample ahead on {} is {} % of the sd of the samples there, and on the rows of "
                             "the discovery it has none",
                             target, held_out, percent(*each.one_step, each.sd)),
           "the equation does not hold on these rows: look for missing terms, and for another amplitude or input");
      continue;
    }
    if (each.free_run && !std::isfinite(*each.free_run)) {
      lost(fmt::format("a free run of `{}` on {} does not stay finite", target, held_out),
           "the equation predicts the next sample only: leave out terms that grow fast, or look for missing ones");
      continue;
    }
    if (each.diverging > 0)
      findings.push_back(
          {FindingCode::draws_not_bounded,
           Severity::warning,
           {held_out},
           fmt::format("{} of {} free runs of `{}` on {}, with drawn errors and coefficients, do not stay finite", each.diverging,
                       drawn_runs, target, held_out),
           "a term destabilises the motion where the record has few samples: leave it out, or use a record of larger "
           "amplitude"});
    if (!each.free_run || !each.expected || !(*each.free_run > std::max(beyond_expected * *each.expected, worth_a_word * each.sd)))
      continue;
    lost(
        fmt::format("the rms error of a free run of `{}` on {} is {} % of the standard deviation of its samples; the errors of the "
                    "equation and of its coefficients explain an error of only {} %",
                    target, held_out, percent(*each.free_run, each.sd), percent(*each.expected, each.sd)),
        "the equation predicts the next sample, but not the motion: look for missing terms or lags; where the samples are noisy "
        "and "
        "follow each other fast, use a differential equation");
  }
  return findings;
}

}  // namespace sysid
