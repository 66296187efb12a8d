// Whether a record tells a found form from the true one, without any code of sysid: `judge RECORD.csv FORMS` prints Schwarz's
// criterion of the found form minus that of the true one, each fitted to the record by simulation.
//
// FORMS: `times` or `plus`; the names of the states; of inputs with their rules; then for each state the true equation as
// `COEFFICIENT TERM ; COEFFICIENT TERM`, then for each the found one. Both begin at these coefficients; the found one also at those
// of the true one, with new terms at zero, and the better fit counts. Records are cut into eight segments with starts of their own,
// which are joined two by two as long as the true form follows; both forms are compared with as many starts. The noise of each
// channel has a standard deviation of its own, constant (`plus`) or in proportion to the sample, not below a fiftieth of its root
// mean square.
#include <boost/numeric/odeint.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <limits>
#include <sstream>

#include "expression.hpp"

namespace {

using Row = std::vector<double>;
constexpr double infinite = std::numeric_limits<double>::infinity();

struct Data {
  std::size_t states = 0;
  std::vector<bool> held;
  std::vector<Row> rows;  // time, inputs, states
  bool proportional = false;
};

struct Term {
  std::size_t equation;
  Expression value;
  std::string text;
};

/// A form with its fitted coefficients and starts.
struct Fit {
  std::vector<Term> terms;
  Row coefficients;
  std::vector<Row> starts;  // of segments
  double criterion = infinite;
  double residual = infinite;  // of the channel that is followed worst, as a share of its noise-free size
};

class Shooting {
 public:
  Shooting(Data const& data, std::vector<Term> const& terms, std::size_t segments)
      : data_(data), terms_(terms), segments_(segments), inputs_(data.held.size()), rms_(data.states) {
    for (Row const& row : data.rows)
      for (std::size_t i = 0; i < data.states; ++i) rms_[i] += std::pow(measured(row, i), 2) / data.rows.size();
    for (double& each : rms_) each = std::sqrt(each);
  }
  std::size_t first(std::size_t segment) const { return segment * data_.rows.size() / segments_; }
  double measured(Row const& row, std::size_t state) const { return row[1 + inputs_ + state]; }

  /// The states at the rows of a segment; empty where they do not stay finite.
  std::vector<Row> states(Row const& coefficients, Row const& start, std::size_t segment) const {
    namespace odeint = boost::numeric::odeint;
    std::vector<Row> all{start};
    Row state = start, values(data_.states + inputs_);
    long calls = 0;
    for (std::size_t n = first(segment) + 1; n < first(segment + 1); ++n) {
      Row const &before = data_.rows[n - 1], &after = data_.rows[n];
      auto const rate = [&](Row const& x, Row& slope, double t) {
        if (++calls > 30000) throw std::runtime_error("too many steps");
        std::copy(x.begin(), x.end(), values.begin());
        for (std::size_t i = 0; i < inputs_; ++i)
          values[data_.states + i] =
              data_.held[i] ? before[1 + i]
                            : before[1 + i] + (after[1 + i] - before[1 + i]) * (t - before[0]) / (after[0] - before[0]);
        std::fill(slope.begin(), slope.end(), 0);
        for (std::size_t j = 0; j < terms_.size(); ++j) slope[terms_[j].equation] += coefficients[j] * terms_[j].value(values);
        for (double const each : slope)
          if (!(std::abs(each) < 1e8)) throw std::runtime_error("not finite");
      };
      try {
        odeint::integrate_adaptive(odeint::make_controlled(1e-10, 1e-10, odeint::runge_kutta_dopri5<Row>()), rate, state, before[0],
                                   after[0], (after[0] - before[0]) / 4);
      } catch (std::exception const&) {
        return {};
      }
      all.push_back(state);
    }
    return all;
  }

  /// Residuals of a segment, row by row, over the sds of their channels; empty where the simulation fails.
  Row residuals(Fit const& fit, std::size_t segment, std::vector<Row> const& weights) const {
    std::vector<Row> const run = states(fit.coefficients, fit.starts[segment], segment);
    Row out;
    for (std::size_t n = 0; n < run.size(); ++n)
      for (std::size_t i = 0; i < data_.states; ++i)
        out.push_back((measured(data_.rows[first(segment) + n], i) - run[n][i]) * weights[first(segment) + n][i]);
    return out;
  }

  double noise_shape(double value, std::size_t state) const {
    return data_.proportional ? std::hypot(value, 0.02 * rms_[state]) : 1;
  }

  /// Squares of residuals over the shape of the noise, per channel, and the sum of the logarithms of the shape; false: not finite.
  bool score(Fit const& fit, Row& squares, double& shapes, std::vector<Row>& weights) const {
    squares.assign(data_.states, 0);
    shapes = 0;
    weights.assign(data_.rows.size(), Row(data_.states));
    for (std::size_t s = 0; s < segments_; ++s) {
      std::vector<Row> const run = states(fit.coefficients, fit.starts[s], s);
      if (run.empty()) return false;
      for (std::size_t n = 0; n < run.size(); ++n)
        for (std::size_t i = 0; i < data_.states; ++i) {
          double const shape = noise_shape(run[n][i], i);
          squares[i] += std::pow((measured(data_.rows[first(s) + n], i) - run[n][i]) / shape, 2);
          shapes += std::log(shape);
          weights[first(s) + n][i] = 1 / shape;
        }
    }
    return true;
  }

  /// Fits coefficients and starts by Levenberg and Marquardt, weights anew in each round; sets the criterion.
  void fit(Fit& fit) const {
    Row squares;
    double shapes = 0, damping = 1e-3;
    std::vector<Row> weights;
    double const rows = static_cast<double>(data_.rows.size());
    auto const objective = [&](Fit const& at, std::vector<Row>& w) {
      if (!score(at, squares, shapes, w)) return infinite;
      double sum = 2 * shapes;
      for (double const each : squares) sum += rows * std::log(std::max(each / rows, 1e-32));
      return sum;
    };
    double best = objective(fit, weights);
    for (int round = 0; round < 40 && std::isfinite(best); ++round) {
      for (std::size_t n = 0; n < weights.size(); ++n)
        for (std::size_t i = 0; i < data_.states; ++i) weights[n][i] /= std::sqrt(std::max(squares[i] / rows, 1e-32));
      std::vector<Row> matrix;
      Row gradient;
      if (!normal_equations(fit, weights, matrix, gradient)) break;
      bool better = false;
      double gain = 0;
      for (int attempt = 0; attempt < 12 && !better; ++attempt) {
        Fit moved = fit;
        move(moved, solve(matrix, gradient, damping));
        std::vector<Row> new_weights;
        Row const kept = squares;
        double const value = objective(moved, new_weights);
        if (value < best) {
          better = true, gain = best - value, best = value;
          fit.coefficients = moved.coefficients, fit.starts = moved.starts, weights = new_weights;
          damping = std::max(damping / 10, 1e-12);
        } else {
          squares = kept;
          damping *= 10;
        }
      }
      if (!better || gain < 1e-4) break;
    }
    fit.criterion = best + static_cast<double>(fit.coefficients.size()) * std::log(rows * data_.states);
    fit.residual = 0;
    if (!std::isfinite(best)) return void(fit.residual = infinite);
    objective(fit, weights);
    for (double const each : squares) fit.residual = std::max(fit.residual, std::sqrt(each / rows));
  }

 private:
  static void move(Fit& fit, Row const& step) {
    std::size_t at = 0;
    for (double& each : fit.coefficients) each += step[at++];
    for (Row& start : fit.starts)
      for (double& each : start) each += step[at++];
  }

  bool normal_equations(Fit const& fit, std::vector<Row> const& weights, std::vector<Row>& matrix, Row& gradient) const {
    std::size_t const own = fit.coefficients.size(), all = own + segments_ * data_.states;
    matrix.assign(all, Row(all));
    gradient.assign(all, 0);
    for (std::size_t s = 0; s < segments_; ++s) {
      Row const residual = residuals(fit, s, weights);
      std::vector<std::size_t> places;
      std::vector<Row> slopes;
      auto const differ = [&](std::size_t place, auto const& moved_by, double scale) {
        double step = 1e-6 * scale;
        Fit plus = fit, minus = fit;
        moved_by(plus, step), moved_by(minus, -step);
        Row const up = residuals(plus, s, weights), down = residuals(minus, s, weights);
        if (up.size() != residual.size() || down.size() != residual.size()) return false;
        Row slope(residual.size());
        for (std::size_t n = 0; n < slope.size(); ++n) slope[n] = -(up[n] - down[n]) / (2 * step);
        places.push_back(place);
        slopes.push_back(std::move(slope));
        return true;
      };
      if (residual.empty()) return false;
      for (std::size_t j = 0; j < own; ++j)
        if (!differ(
                j, [j](Fit& f, double by) { f.coefficients[j] += by; }, std::max(std::abs(fit.coefficients[j]), 1e-3)))
          return false;
      for (std::size_t i = 0; i < data_.states; ++i)
        if (!differ(
                own + s * data_.states + i, [s, i](Fit& f, double by) { f.starts[s][i] += by; }, rms_[i]))
          return false;
      for (std::size_t a = 0; a < places.size(); ++a) {
        for (std::size_t n = 0; n < residual.size(); ++n) gradient[places[a]] += slopes[a][n] * residual[n];
        for (std::size_t b = 0; b < places.size(); ++b)
          for (std::size_t n = 0; n < residual.size(); ++n) matrix[places[a]][places[b]] += slopes[a][n] * slopes[b][n];
      }
    }
    return true;
  }

  /// (A + damping*diagonal(A)) x = b by Cholesky's factor of the scaled matrix.
  static Row solve(std::vector<Row> a, Row b, double damping) {
    std::size_t const n = b.size();
    Row scale(n);
    for (std::size_t i = 0; i < n; ++i) scale[i] = a[i][i] > 0 ? 1 / std::sqrt(a[i][i]) : 1;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) a[i][j] *= scale[i] * scale[j];
      a[i][i] = (a[i][i] > 0 ? a[i][i] : 1) + damping;
      b[i] *= scale[i];
    }
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k];
      a[j][j] = std::sqrt(std::max(a[j][j], 1e-30));
      for (std::size_t i = j + 1; i < n; ++i) {
        for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
        a[i][j] /= a[j][j];
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
      b[i] /= a[i][i];
    }
    for (std::size_t i = n; i-- > 0;) {
      for (std::size_t k = i + 1; k < n; ++k) b[i] -= a[k][i] * b[k];
      b[i] /= a[i][i];
    }
    for (std::size_t i = 0; i < n; ++i) b[i] *= scale[i];
    return b;
  }

  Data const& data_;
  std::vector<Term> const& terms_;
  std::size_t segments_, inputs_;
  Row rms_;
};

constexpr std::size_t first_segments = 8;
constexpr double grown = 1.3;  // of the residual from one length to the next

/// Fits at eight, four, two segments and one; down to `least`, or, where it is 0, as long as the form follows.
std::size_t fit_joining(Data const& data, Fit& best, std::size_t least) {
  std::size_t reached = first_segments;
  Fit fit = best;
  for (std::size_t segments = first_segments; segments >= std::max<std::size_t>(least, 1); segments /= 2) {
    Shooting const shooting(data, fit.terms, segments);
    if (segments == first_segments)
      for (std::size_t s = 0; s < segments; ++s) {
        Row const& row = data.rows[shooting.first(s)];
        fit.starts.emplace_back(row.end() - static_cast<std::ptrdiff_t>(data.states), row.end());
      }
    else
      for (std::size_t s = segments * 2; s-- > 0;)
        if (s % 2) fit.starts.erase(fit.starts.begin() + static_cast<std::ptrdiff_t>(s));
    shooting.fit(fit);
    if (least == 0 && segments < first_segments && !(fit.residual < grown * best.residual)) break;
    best = fit;
    reached = segments;
  }
  return reached;
}

std::vector<std::string> words_of(std::string const& line) {
  std::istringstream stream(line);
  std::vector<std::string> out;
  for (std::string word; stream >> word;) out.push_back(word);
  return out;
}

}  // namespace

int main(int count, char** arguments) try {
  if (count < 3) return std::fprintf(stderr, "judge RECORD.csv FORMS\n"), 2;
  std::ifstream record(arguments[1]), forms(arguments[2]);
  std::string line, cell;
  Data data;
  std::getline(record, line);
  while (std::getline(record, line)) {
    data.rows.emplace_back();
    for (std::istringstream cells(line); std::getline(cells, cell, ',');) data.rows.back().push_back(std::atof(cell.c_str()));
  }
  std::getline(forms, line);
  data.proportional = line == "times";
  std::getline(forms, line);
  std::map<std::string, std::size_t> places;
  for (std::string const& name : words_of(line)) places[name] = data.states++;
  std::getline(forms, line);
  std::vector<std::string> const inputs = words_of(line);
  for (std::size_t i = 0; i + 1 < inputs.size(); i += 2) {
    places[inputs[i]] = data.states + i / 2;
    data.held.push_back(inputs[i + 1] == "zero_order");
  }
  Fit form[2];
  for (Fit& fit : form)
    for (std::size_t e = 0; e < data.states; ++e) {
      std::getline(forms, line);
      for (std::istringstream terms(line); std::getline(terms, cell, ';');) {
        std::istringstream parts(cell);
        double value = 0;
        std::string text;
        parts >> value >> text;
        fit.terms.push_back({e, parse_expression(text, places), text});
        fit.coefficients.push_back(value);
      }
    }
  Fit& truth = form[0];
  Fit found = form[1], other = form[1];
  std::size_t const segments = fit_joining(data, truth, 0);
  for (std::size_t j = 0; j < other.terms.size(); ++j) {
    other.coefficients[j] = 0;
    for (std::size_t i = 0; i < truth.terms.size(); ++i)
      if (truth.terms[i].equation == other.terms[j].equation && truth.terms[i].text == other.terms[j].text)
        other.coefficients[j] = truth.coefficients[i];
  }
  fit_joining(data, found, segments);
  fit_joining(data, other, segments);
  double const difference = std::min(found.criterion, other.criterion) - truth.criterion;
  if (std::isnan(difference) || !std::isfinite(truth.criterion)) return 1;
  std::printf("%.3f\n", std::isfinite(difference) ? difference : 1e6);
  if (count > 3)
    std::fprintf(stderr, "%zu segments; residuals true %.4g, found %.4g\n", segments, truth.residual,
                 std::min(found.residual, other.residual));
} catch (std::exception const& error) {
  return std::fprintf(stderr, "judge: %s\n", error.what()), 1;
}
