// Columns of samples at lags, whitened by what the residual is a moving average of.
#include "regression/column/difference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/numeric/elementary.hpp"
#include "linear_algebra/decompositions.hpp"
#include "regression/column/evaluation.hpp"
#include "regression/column/moving_average.hpp"
#include "regression/column/signals.hpp"

namespace sysid::regression::difference {
namespace {

constexpr SettingRow rows[] = {
    {"moving_average", SettingKind::integer, "-1", -1, 50, "",
     "order of the moving average that describes the noise; 0: white noise; -1: chosen from the record, at most 6"},
};

constexpr int most_chosen = 6;
constexpr int most_traced = 25;  // rows before which inputs are looked for in errors
constexpr double far_from_independent = 5.5;

class DifferenceProjection : public Projection, public NoiseOfEquation {
 public:
  DifferenceProjection(Dictionary dictionary, std::span<Experiment const> experiments, Settings const& settings)
      : dictionary_(std::move(dictionary)),
        experiments_(experiments.begin(), experiments.end()),
        order_(static_cast<int>(settings.integer("moving_average"))) {
    for (Equation const& equation : dictionary_.equations) project(equation);
  }

  Columns const& columns(int equation) const override { return of(equation).columns; }
  Columns whitened(int equation, Eigen::VectorXd const&, double) const override { return columns(equation); }
  double own_noise(int, Eigen::VectorXd const&) const override { return 0; }
  int reweightings() const override { return 0; }
  ResidualSize residual_size() const override { return ResidualSize::unknown; }
  NoiseOfEquation const* noise_of_equation() const override { return this; }
  std::vector<double> const& noise_sd() const override { return noise_sd_; }
  int half_width() const override { return 0; }
  Concerns const& concerns(int equation) const override { return of(equation).concerns; }

  std::vector<int> orders() const override {
    std::vector<int> all;
    for (int order = std::max(0, order_); order <= (order_ < 0 ? most_chosen : order_); ++order) all.push_back(order);
    return all;
  }

  Columns whitened(int equation, Eigen::VectorXd const& coefficients, int order) const override {
    Columns const& raw = columns(equation);
    if (order == 0) return raw;
    std::vector<Run> const& runs = of(equation).runs;
    MovingAverage const noise = noise_of(equation, coefficients, order);
    Columns out{noise.freed(noise.divided(raw.known, runs), runs), noise.freed(noise.divided(raw.terms, runs), runs)};
    MovingAverage::Errors const e = noise.errors(raw.known - raw.terms * coefficients, runs);
    Eigen::MatrixXd const slopes = noise.freed(noise.slopes(e, runs), runs);
    Eigen::Index const left = slopes.rows() - order;
    if (left <= 0 || !slopes.allFinite() || slopes.isZero(0)) return out;
    OrthogonalTriangular const decomposed(slopes);
    out.known = Eigen::VectorXd(decomposed.turned(out.known).bottomRows(left));
    out.terms = Eigen::MatrixXd(decomposed.turned(out.terms).bottomRows(left));
    return out;
  }

  EquationErrors errors(int equation, Eigen::VectorXd const& coefficients, int order) const override {
    Columns const& raw = columns(equation);
    std::vector<Run> const& runs = of(equation).runs;
    MovingAverage const noise = noise_of(equation, coefficients, order);
    MovingAverage::Errors const e = noise.errors(raw.known - raw.terms * coefficients, runs);
    EquationErrors out{e.in_runs, e.squares(), noise.log_determinant(runs), static_cast<int>(runs.size()), noise.coefficients, {}};
    if (order == 0) return out;
    Eigen::MatrixXd const triangle = OrthogonalTriangular(noise.turned(noise.slopes(e, runs), runs)).triangle();
    Eigen::MatrixXd const root = solve_upper(triangle, Eigen::MatrixXd::Identity(order, order));
    double const sd = std::sqrt(out.squares / static_cast<double>(e.in_runs.size()));
    for (Eigen::Index k = 0; k < order; ++k) out.average_sd.push_back(root.row(k).norm() * sd);
    return out;
  }

  std::optional<InputTrace> input_in(int equation, Eigen::VectorXd const& errors) const override {
    std::optional<InputTrace> found;
    double largest = far_from_independent;
    for (std::size_t input = 0; !experiments_.empty() && input < experiments_.front().inputs.size(); ++input)
      for (bool const square : {false, true}) {
        double mean = 0, count = 0;
        for (Experiment const& experiment : experiments_)
          for (std::size_t i = 0; i < experiment.time.size(); ++i)
            mean += experiment.inputs[input].sample(static_cast<int>(i)), ++count;
        mean /= count;
        auto const value = [&](Experiment const& experiment, int row) {
          double const off = experiment.inputs[input].sample(row) - mean;
          return square ? off * off : off;
        };
        for (int lag = 0; lag <= most_traced; ++lag) {
          double product = 0, own = 0, theirs = 0, sum = 0, n = 0;
          for (Eigen::Index k = 0; k < errors.size(); ++k) {
            Place const& place = of(equation).places[static_cast<std::size_t>(k)];
            if (place.row < lag) continue;
            sum += value(experiments_[place.experiment], place.row - lag);
            ++n;
          }
          for (Eigen::Index k = 0; k < errors.size(); ++k) {
            Place const& place = of(equation).places[static_cast<std::size_t>(k)];
            if (place.row < lag) continue;
            double const u = value(experiments_[place.experiment], place.row - lag) - sum / n;
            product += u * errors(k);
            own += errors(k) * errors(k);
            theirs += u * u;
          }
          double const size = own > 0 && theirs > 0 ? std::abs(product) / std::sqrt(own * theirs) * std::sqrt(n) : 0;
          if (!(size > largest)) continue;
          largest = size;
          found = InputTrace{static_cast<int>(input), lag, square, product / std::sqrt(own * theirs)};
        }
      }
    return found;
  }

 private:
  struct Place {
    std::size_t experiment;
    int row;
  };
  struct Projected {
    Columns columns;
    std::vector<Run> runs;
    std::vector<Place> places;  // of the rows
    Concerns concerns;
  };
  Projected const& of(int equation) const { return equations_[static_cast<std::size_t>(equation)]; }

  MovingAverage noise_of(int equation, Eigen::VectorXd const& coefficients, int order) const {
    MovingAverage best;
    if (order == 0) return best;
    Columns const& raw = columns(equation);
    Eigen::VectorXd const v = raw.known - raw.terms * coefficients;
    double least = std::numeric_limits<double>::infinity();
    for (MovingAverage const& start : starts(equation, coefficients, order)) {
      MovingAverage each = fitted_moving_average(v, of(equation).runs, start);
      double const squares = each.errors(v, of(equation).runs).squares();
      double const score = static_cast<double>(v.size()) * elementary::log(std::max(squares, std::numeric_limits<double>::min())) +
                           each.log_determinant(of(equation).runs);
      if (!best.coefficients.empty() && !(score < least)) continue;
      least = score;
      best = std::move(each);
    }
    return best;
  }

  /// White noise; and the polynomial of the equation's own past, which noise of its samples is divided by (as Steiglitz and McBride
  /// 1965 do): from white noise its zeros near the unit circle are seldom reached.
  std::vector<MovingAverage> starts(int equation, Eigen::VectorXd const& coefficients, int order) const {
    std::vector<MovingAverage> all = {{std::vector<double>(static_cast<std::size_t>(order), 0.0)}};
    MovingAverage own = all.front();
    bool any = false;
    Equation const& terms = dictionary_.equations[static_cast<std::size_t>(equation)];
    int const state = dictionary_.graph[terms.known].index;
    for (std::size_t j = 0; j < terms.terms.size(); ++j) {
      Symbol const* symbol = symbol_of(dictionary_, terms.terms[j].expression);
      if (symbol == nullptr || symbol->kind != Symbol::Kind::state || symbol->index != state || symbol->lag > order) continue;
      own.coefficients[static_cast<std::size_t>(symbol->lag - 1)] = -coefficients(static_cast<Eigen::Index>(j));
      any = any || coefficients(static_cast<Eigen::Index>(j)) != 0;
    }
    if (any) all.push_back(std::move(own));
    return all;
  }

  void project(Equation const& equation) {
    Projected& projected = equations_.emplace_back();
    std::vector<NodeId> roots = {equation.known};
    for (Term const& term : equation.terms) roots.push_back(term.expression);
    std::vector<Symbol> const symbols = symbols_below(dictionary_, roots);
    std::vector<int> channels;
    for (Symbol const& symbol : symbols)
      if (symbol.kind == Symbol::Kind::state) channels.push_back(channel_of(dictionary_, symbol.index, 0));
    std::sort(channels.begin(), channels.end());
    channels.erase(std::unique(channels.begin(), channels.end()), channels.end());
    projected.concerns = channel_concerns(dictionary_, experiments_, channels);
    if (any_fatal(projected.concerns)) return;

    std::vector<Eigen::MatrixXd> blocks;
    Eigen::Index count = 0;
    for (Experiment const& experiment : experiments_) {
      blocks.push_back(block(experiment, roots, symbols, count, projected));
      count += blocks.back().rows();
    }
    projected.columns = stacked(blocks, equation.terms.size());
  }

  /// Roots at the rows where every sample that is read is there: [rows x roots]. before: rows of other experiments.
  Eigen::MatrixXd block(Experiment const& experiment, std::vector<NodeId> const& roots, std::vector<Symbol> const& symbols,
                        Eigen::Index before, Projected& projected) const {
    int const count = static_cast<int>(experiment.time.size());
    std::map<NodeId, std::vector<double>> values;
    for (Symbol const& symbol : symbols) values[symbol.leaf] = samples_of(symbol, experiment);
    Eigen::MatrixXd const all = evaluate_columns(
        dictionary_.graph, roots, [&](NodeId leaf) -> std::span<double const> { return values.at(leaf); }, count);
    std::vector<int> rows;
    for (int i = 0; i < count; ++i) {
      bool const there = std::all_of(values.begin(), values.end(),
                                     [&](auto const& entry) { return std::isfinite(entry.second[static_cast<std::size_t>(i)]); });
      if (!there || !usable(experiment, {}, i)) continue;
      if (rows.empty() || rows.back() != i - 1) projected.runs.push_back({before + static_cast<Eigen::Index>(rows.size()), 0});
      ++projected.runs.back().count;
      projected.places.push_back({static_cast<std::size_t>(&experiment - experiments_.data()), i});
      rows.push_back(i);
    }
    return rows_at(all, rows);
  }

  std::vector<double> samples_of(Symbol const& symbol, Experiment const& experiment) const {
    std::size_t const count = experiment.time.size();
    std::vector<double> samples(count, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = static_cast<std::size_t>(symbol.lag); i < count; ++i) {
      std::size_t const past = i - static_cast<std::size_t>(symbol.lag);
      auto const index = static_cast<std::size_t>(symbol.index);
      switch (symbol.kind) {
        case Symbol::Kind::time:
          samples[i] = experiment.time[past];
          break;
        case Symbol::Kind::input:
          samples[i] = experiment.inputs[index].sample(static_cast<int>(past));
          break;
        case Symbol::Kind::state:
          samples[i] = experiment.measured[static_cast<std::size_t>(channel_of(dictionary_, symbol.index, 0))][past];
          break;
      }
    }
    return samples;
  }

  Dictionary dictionary_;
  std::vector<Experiment> experiments_;
  int order_;
  std::vector<double> noise_sd_;  // of no channel: an equation has its own
  std::vector<Projected> equations_;
};

}  // namespace

std::span<SettingRow const> settings() { return rows; }

std::unique_ptr<Projection> project(Dictionary const& dictionary, std::span<Experiment const> experiments,
                                    Settings const& settings) {
  return std::make_unique<DifferenceProjection>(dictionary, experiments, settings);
}

}  // namespace sysid::regression::difference
