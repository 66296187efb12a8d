// One function per kind of piece.
#include "regression/weak/integrals.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "regression/column/evaluation.hpp"
#include "regression/column/signals.hpp"
#include "regression/column/smoothing.hpp"

namespace sysid::regression {
namespace {

/// Gauss and Legendre's rule on [0, 1].
constexpr std::array<double, 5> gauss_at = {0.046910077030668004, 0.23076534494715846, 0.5, 0.7692346550528415, 0.953089922969332};
constexpr std::array<double, 5> gauss_weight = {0.11846344252809454, 0.23931433524968324, 0.28444444444444444, 0.23931433524968324,
                                                0.11846344252809454};

double signed_power(int moves) { return moves % 2 == 0 ? 1 : -1; }

}  // namespace

WeakIntegrals::WeakIntegrals(Dictionary& dictionary, Experiment const& experiment, TestFunction const& test, Windows windows)
    : dictionary_(dictionary),
      experiment_(experiment),
      test_(test),
      windows_(std::move(windows)),
      rows_(static_cast<int>(experiment.time.size())) {
  test_weights(0);
}

std::vector<double> const& WeakIntegrals::samples(int channel) const {
  return experiment_.measured[static_cast<std::size_t>(channel)];
}

std::vector<double> const& WeakIntegrals::test_weights(int order) {
  std::vector<double>& weights = weights_[order];
  if (weights.empty()) {
    weights = test_.samples(order, windows_.half);
    double scale = windows_.half;
    for (int k = 0; k < order; ++k) scale *= windows_.half * windows_.step;
    for (double& weight : weights) weight /= scale;
  }
  return weights;
}

void WeakIntegrals::integrate(int order, Eigen::VectorXd const& values, Eigen::VectorXd& rows) {
  std::vector<double> const& weights = test_weights(order);
  for (std::size_t k = 0; k < windows_.centres.size(); ++k) {
    int const first = windows_.centres[k] - windows_.half;
    double sum = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) sum += weights[i] * values(first + static_cast<int>(i));
    rows(static_cast<Eigen::Index>(k)) += sum;
  }
}

std::vector<double> WeakIntegrals::smoother(int channel, int derivative) const {
  return savitzky_golay_weights(windows_.smoother_half, windows_.smoother_degree.at({channel, derivative}), derivative);
}

std::vector<double> const& WeakIntegrals::smoothed(int channel, int derivative) {
  std::vector<double>& values = smoothed_[{channel, derivative}];
  if (values.empty()) {
    double scale = 1;
    for (int k = 0; k < derivative; ++k) scale *= windows_.step;
    values = filtered(samples(channel), smoother(channel, derivative), scale);
  }
  return values;
}

Eigen::MatrixXd WeakIntegrals::at_samples(std::span<NodeId const> roots, bool after) {
  auto const leaf = [&](NodeId id) -> std::span<double const> {
    Symbol const& symbol = *symbol_of(dictionary_, id);
    if (symbol.kind == Symbol::Kind::time) return experiment_.time;
    if (symbol.kind == Symbol::Kind::input) {
      std::vector<double>& side = side_[{symbol.index, symbol.order, after}];
      if (side.empty()) {
        InputSides sides = input_sides(experiment_.inputs[static_cast<std::size_t>(symbol.index)], symbol.order);
        side = after ? std::move(sides.after) : std::move(sides.before);
      }
      return side;
    }
    int const channel = base_channel(dictionary_, symbol.index, symbol.order);
    int const derivative = symbol.order - dictionary_.channels[static_cast<std::size_t>(channel)].order;
    return derivative == 0 ? samples(channel) : smoothed(channel, derivative);
  };
  return evaluate_columns(dictionary_.graph, roots, leaf, rows_);
}

void WeakIntegrals::add_inputs(Piece const& piece, Integrals& integrals) {
  // f at Gauss points of every interval; the input's polynomial holds there whatever its rule.
  int const intervals = rows_ - 1, points = static_cast<int>(gauss_at.size());
  std::map<NodeId, std::vector<double>> columns;
  auto const leaf = [&](NodeId id) -> std::span<double const> {
    std::vector<double>& column = columns[id];
    if (!column.empty()) return column;
    Symbol const& symbol = *symbol_of(dictionary_, id);
    for (int i = 0; i < intervals; ++i)
      for (double const s : gauss_at) {
        if (symbol.kind == Symbol::Kind::time) {
          column.push_back(experiment_.time[static_cast<std::size_t>(i)] + s * windows_.step);
        } else {
          InputSignal const& signal = experiment_.inputs[static_cast<std::size_t>(symbol.index)];
          column.push_back(symbol.order == 0 ? signal.value(i, s) : signal.rate(i, s));
        }
      }
    return column;
  };
  Eigen::VectorXd const values = evaluate_columns(dictionary_.graph, {&piece.expression, 1}, leaf, intervals * points);
  std::vector<double> weights;
  for (int j = -windows_.half; j < windows_.half; ++j)
    for (std::size_t g = 0; g < gauss_at.size(); ++g)
      weights.push_back(gauss_weight[g] * test_.derivative(0, (j + gauss_at[g]) / windows_.half) / windows_.half);
  for (std::size_t k = 0; k < windows_.centres.size(); ++k) {
    int const first = (windows_.centres[k] - windows_.half) * points;
    double sum = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) sum += weights[i] * values(first + static_cast<int>(i));
    integrals.rows(static_cast<Eigen::Index>(k)) += piece.factor * sum;
  }
}

void WeakIntegrals::add_samples(Piece const& piece, Integrals& integrals) {
  std::vector<NodeId> roots = {piece.expression};
  std::vector<SensitivityKey> keys;
  bool jumps = false;
  for (Symbol const& symbol : symbols_below(dictionary_, {&piece.expression, 1})) {
    jumps = jumps || symbol.kind == Symbol::Kind::input;
    if (symbol.kind != Symbol::Kind::state) continue;
    int const channel = base_channel(dictionary_, symbol.index, symbol.order);
    keys.push_back({channel, 0, symbol.order - dictionary_.channels[static_cast<std::size_t>(channel)].order});
    roots.push_back(dictionary_.graph.differentiate(piece.expression, symbol.leaf));
  }
  Eigen::MatrixXd values = at_samples(roots, true);
  // An input may jump at a sample; the trapezoidal rule then wants the mean of both sides.
  if (jumps) values = 0.5 * (values + at_samples(roots, false));
  integrate(0, piece.factor * values.col(0), integrals.rows);
  for (std::size_t k = 0; k < keys.size(); ++k) {
    Eigen::VectorXd& sum = integrals.sensitivities.try_emplace(keys[k], Eigen::VectorXd::Zero(rows_)).first->second;
    sum += piece.factor * values.col(static_cast<Eigen::Index>(k) + 1);
  }
}

void WeakIntegrals::add_moved(Piece const& piece, Integrals& integrals) {
  double const factor = piece.factor * signed_power(piece.moves);
  std::vector<double> const& z = samples(piece.channel);
  integrate(piece.moves, factor * Eigen::Map<Eigen::VectorXd const>(z.data(), rows_), integrals.rows);
  Eigen::VectorXd& sum =
      integrals.sensitivities.try_emplace({piece.channel, piece.moves, 0}, Eigen::VectorXd::Zero(rows_)).first->second;
  sum.array() += factor;
}

void WeakIntegrals::add_potential(Piece const& piece, Integrals& integrals) {
  // G by Gauss panels over the channel's range, with an edge at 0, where abs and sign have their kinks.
  std::vector<double> const& z = samples(piece.channel);
  double low = 0, high = 0;
  bool any = false;
  for (double const value : z)
    if (std::isfinite(value)) {
      low = any ? std::min(low, value) : value;
      high = any ? std::max(high, value) : value;
      any = true;
    }
  constexpr int panels = 64;
  std::vector<double> edges;
  for (int p = 0; p <= panels; ++p) edges.push_back(low + (high - low) * p / panels);
  edges.back() = high;
  if (low < 0 && high > 0) edges.insert(std::lower_bound(edges.begin(), edges.end(), 0.0), 0.0);

  auto const points = gauss_at.size();
  auto const integrand = [&](std::vector<double> const& at) {
    auto const leaf = [&](NodeId) -> std::span<double const> { return at; };
    return Eigen::VectorXd(evaluate_columns(dictionary_.graph, {&piece.expression, 1}, leaf, static_cast<int>(at.size())));
  };
  auto const segment = [&](Eigen::VectorXd const& values, std::size_t index, double width) {
    double sum = 0;
    for (std::size_t g = 0; g < points; ++g) sum += gauss_weight[g] * values(static_cast<Eigen::Index>(index * points + g));
    return sum * width;
  };
  std::vector<double> at;
  for (std::size_t p = 0; p + 1 < edges.size(); ++p)
    for (double const s : gauss_at) at.push_back(edges[p] + s * (edges[p + 1] - edges[p]));
  Eigen::VectorXd const whole = integrand(at);
  std::vector<double> before = {0};
  for (std::size_t p = 0; p + 1 < edges.size(); ++p) before.push_back(before.back() + segment(whole, p, edges[p + 1] - edges[p]));

  at.clear();
  std::vector<std::size_t> panel;
  for (double const value : z) {
    auto const above = std::upper_bound(edges.begin() + 1, edges.end() - 1, value);
    panel.push_back(static_cast<std::size_t>(above - edges.begin()) - 1);
    for (double const s : gauss_at) at.push_back(edges[panel.back()] + s * (value - edges[panel.back()]));
  }
  Eigen::VectorXd const part = integrand(at);
  Eigen::VectorXd potential(rows_);
  for (int i = 0; i < rows_; ++i) {
    auto const row = static_cast<std::size_t>(i);
    potential(i) = before[panel[row]] + segment(part, row, z[row] - edges[panel[row]]);
  }
  integrate(1, -piece.factor * potential, integrals.rows);
  Eigen::VectorXd& sum = integrals.sensitivities.try_emplace({piece.channel, 1, 0}, Eigen::VectorXd::Zero(rows_)).first->second;
  sum -= piece.factor * integrand(z);
}

Integrals WeakIntegrals::of(std::vector<Piece> const& pieces) {
  Integrals integrals;
  integrals.rows = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(windows_.centres.size()));
  for (Piece const& piece : pieces) switch (piece.kind) {
      case Piece::Kind::inputs:
        add_inputs(piece, integrals);
        break;
      case Piece::Kind::samples:
        add_samples(piece, integrals);
        break;
      case Piece::Kind::moved:
        add_moved(piece, integrals);
        break;
      case Piece::Kind::potential:
        add_potential(piece, integrals);
        break;
    }
  return integrals;
}

Eigen::MatrixXd WeakIntegrals::known_gradient() const {
  std::vector<double> const& weights = weights_.at(0);
  Eigen::VectorXd column = Eigen::VectorXd::Zero(2 * reach() + 1);
  for (int i = -windows_.half; i <= windows_.half; ++i) column(i + reach()) = weights[static_cast<std::size_t>(i + windows_.half)];
  return column.replicate(1, static_cast<Eigen::Index>(windows_.centres.size()));
}

Eigen::MatrixXd WeakIntegrals::gradient(Sensitivities const& sensitivities, int channel) const {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(2 * reach() + 1, static_cast<Eigen::Index>(windows_.centres.size()));
  for (auto const& [key, values] : sensitivities) {
    if (key.channel != channel) continue;
    std::vector<double> const& weights = weights_.at(key.order);
    std::vector<double> filter = {1.0};
    if (key.smoothed > 0) {
      filter = smoother(channel, key.smoothed);
      for (int k = 0; k < key.smoothed; ++k)
        for (double& weight : filter) weight /= windows_.step;
    }
    int const filter_half = static_cast<int>(filter.size() / 2);
    for (std::size_t k = 0; k < windows_.centres.size(); ++k)
      for (int i = -windows_.half; i <= windows_.half; ++i) {
        double const outer = weights[static_cast<std::size_t>(i + windows_.half)] * values(windows_.centres[k] + i);
        for (int l = -filter_half; l <= filter_half; ++l)
          columns(i + l + reach(), static_cast<Eigen::Index>(k)) += outer * filter[static_cast<std::size_t>(l + filter_half)];
      }
  }
  return columns;
}

}  // namespace sysid::regression
