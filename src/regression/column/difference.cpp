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
     "order of the moving average that the noise is; 0: white; -1: chosen by the record, at most 6"},
};

constexpr int most_chosen = 6;
constexpr int whitenings = 10;

class DifferenceProjection : public Projection {
 public:
  DifferenceProjection(Dictionary dictionary, std::span<Experiment const> experiments, Settings const& settings)
      : dictionary_(std::move(dictionary)),
        experiments_(experiments.begin(), experiments.end()),
        order_(static_cast<int>(settings.integer("moving_average"))) {
    for (Equation const& equation : dictionary_.equations) project(equation);
  }

  Columns const& columns(int equation) const override { return of(equation).columns; }
  Columns whitened(int equation, Eigen::VectorXd const& coefficients, double) const override {
    Columns const& raw = columns(equation);
    MovingAverage const noise = noise_of(equation, coefficients);
    if (noise.coefficients.empty()) return raw;
    Columns divided{noise.divided(raw.known, of(equation).runs), noise.divided(raw.terms, of(equation).runs)};
    Eigen::VectorXd const e = divided.known - divided.terms * coefficients;
    Eigen::MatrixXd const basis = OrthogonalTriangular(noise.slopes(e, of(equation).runs)).basis();
    if (!basis.allFinite()) return divided;
    divided.known -= basis * (basis.transpose() * divided.known);
    divided.terms -= basis * (basis.transpose() * divided.terms);
    return divided;
  }
  std::vector<double> moving_average(int equation, Eigen::VectorXd const& coefficients) const override {
    return noise_of(equation, coefficients).coefficients;
  }
  double own_noise(int, Eigen::VectorXd const&) const override { return 0; }
  int reweightings() const override { return order_ == 0 ? 0 : whitenings; }
  ResidualSize residual_size() const override { return ResidualSize::unknown; }
  std::vector<double> const& noise_sd() const override { return noise_sd_; }
  int half_width() const override { return 0; }
  Concerns const& concerns(int equation) const override { return of(equation).concerns; }

 private:
  struct Projected {
    Columns columns;
    std::vector<Run> runs;
    Concerns concerns;
  };
  Projected const& of(int equation) const { return equations_[static_cast<std::size_t>(equation)]; }

  /// Of the order that is given, else of that with the least n log(sum of squares) + q log(n).                     Schwarz 1978
  MovingAverage noise_of(int equation, Eigen::VectorXd const& coefficients) const {
    Columns const& raw = columns(equation);
    Eigen::VectorXd const v = raw.known - raw.terms * coefficients;
    auto const rows = static_cast<double>(v.size());
    MovingAverage chosen;
    double least = std::numeric_limits<double>::infinity();
    for (int order = std::max(order_, 0); order <= (order_ < 0 ? most_chosen : order_); ++order) {
      if (order_ < 0 && 10 * order > v.size()) break;
      for (MovingAverage const& start : starts(equation, coefficients, order)) {
        MovingAverage each = fitted_moving_average(v, of(equation).runs, start);
        double const squares = each.divided(v, of(equation).runs).squaredNorm();
        double const score = squares > 0 ? rows * elementary::log(squares) + order * elementary::log(rows) : -least;
        if (!(score < least)) continue;
        least = score;
        chosen = std::move(each);
      }
    }
    return chosen;
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
      blocks.push_back(block(experiment, roots, symbols, count, projected.runs));
      count += blocks.back().rows();
    }
    projected.columns.known.resize(count);
    projected.columns.terms.resize(count, static_cast<Eigen::Index>(equation.terms.size()));
    Eigen::Index first = 0;
    for (Eigen::MatrixXd const& part : blocks) {
      projected.columns.known.segment(first, part.rows()) = part.col(0);
      projected.columns.terms.middleRows(first, part.rows()) = part.rightCols(part.cols() - 1);
      first += part.rows();
    }
  }

  /// Roots at the rows where every sample that is read is there: [rows x roots]. before: rows of other experiments.
  Eigen::MatrixXd block(Experiment const& experiment, std::vector<NodeId> const& roots, std::vector<Symbol> const& symbols,
                        Eigen::Index before, std::vector<Run>& runs) const {
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
      if (rows.empty() || rows.back() != i - 1) runs.push_back({before + static_cast<Eigen::Index>(rows.size()), 0});
      ++runs.back().count;
      rows.push_back(i);
    }
    Eigen::MatrixXd kept(static_cast<Eigen::Index>(rows.size()), all.cols());
    for (std::size_t r = 0; r < rows.size(); ++r) kept.row(static_cast<Eigen::Index>(r)) = all.row(rows[r]);
    return kept;
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
