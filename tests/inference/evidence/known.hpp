// Posteriors with known evidence and independent draws: what estimates of the evidence are measured against.
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "core/numeric/random.hpp"
#include "inference/targets.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid::testing {

/// Draws of a posterior, independent of each other: writes one, declared.
using Sampler = std::function<std::vector<double>(Stream&)>;

struct Known {
  TestTarget target;
  double log_evidence;
  Sampler draw;
};

/// A posterior whose density, times the evidence, is exp(log_density) over the line: prior and likelihood share it between them.
/// ceiling: above the log density less that of the prior, N(0, prior_sd) for each parameter.
inline TestTarget target_of(int dimension, double prior_sd, double ceiling,
                            std::function<double(std::vector<double> const&)> log_density) {
  std::vector<std::string> names;
  std::vector<Prior> priors;
  for (int p = 0; p < dimension; ++p) {
    names.push_back("u" + std::to_string(p));
    priors.push_back({Prior::normal, 0, prior_sd});
  }
  return TestTarget(names, priors, 1, ceiling, [=](std::vector<double> const& u, std::vector<double>& rows) {
    double prior = 0;
    for (std::size_t p = 0; p < u.size(); ++p) prior += priors[p].log_density(u[p]);
    rows[0] = as_residual(log_density(u) - prior, ceiling);
  });
}

/// `chains` chains of `length` draws; each stays for `repeats` iterations, as a chain that rejects does.
inline Draws draws_of(Known const& known, int chains, int length, int repeats, std::uint64_t seed) {
  Draws draws;
  draws.parameter_count = known.target.dimension();
  for (ParameterInfo const& each : known.target.parameters()) draws.names.push_back(each.name), draws.units.push_back("");
  for (int c = 0; c < chains; ++c) {
    Stream stream({seed, Purpose::test, static_cast<std::uint64_t>(c), 7});
    Chain chain;
    while (static_cast<int>(chain.values.size()) < length) {
      std::vector<double> const value = known.draw(stream);
      for (int r = 0; r < repeats; ++r) chain.values.push_back(value);
    }
    LaneArray declared(draws.parameter_count, static_cast<int>(chain.values.size())), theta(declared.rows(), declared.width());
    for (int w = 0; w < declared.width(); ++w)
      for (int p = 0; p < declared.rows(); ++p)
        declared(p, w) = chain.values[static_cast<std::size_t>(w)][static_cast<std::size_t>(p)];
    known.target.unconstrain(declared, theta);
    std::vector<double> prior(chain.values.size()), likelihood(chain.values.size());
    Ledger ledger;
    known.target.log_prior(theta, prior, true);
    known.target.log_likelihood(theta, likelihood, ledger);
    for (std::size_t i = 0; i < prior.size(); ++i) chain.log_density.push_back(prior[i] + likelihood[i]);
    draws.chains.push_back(std::move(chain));
  }
  return draws;
}

/// In two dimensions by the midpoint rule over a box of the declared values; draws are those of the cells.
inline Known by_quadrature(TestTarget target, std::array<double, 2> low, std::array<double, 2> high, int steps = 500) {
  double const h0 = (high[0] - low[0]) / steps, h1 = (high[1] - low[1]) / steps;
  LaneArray declared(2, steps), theta(2, steps);
  std::vector<double> prior(static_cast<std::size_t>(steps)), likelihood(prior), all;
  Ledger ledger;
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < steps; ++j) declared(0, j) = low[0] + (i + 0.5) * h0, declared(1, j) = low[1] + (j + 0.5) * h1;
    target.unconstrain(declared, theta);
    target.log_prior(theta, prior, false);
    target.log_likelihood(theta, likelihood, ledger);
    for (std::size_t j = 0; j < prior.size(); ++j) all.push_back(prior[j] + likelihood[j]);
  }
  double const highest = *std::max_element(all.begin(), all.end());
  std::vector<double> cumulative;
  double sum = 0;
  for (double const each : all) cumulative.push_back(sum += std::exp(each - highest));
  double const log_evidence = highest + std::log(sum * h0 * h1);
  auto const draw = [=](Stream& stream) {
    auto const cell = std::lower_bound(cumulative.begin(), cumulative.end(), stream.uniform() * sum) - cumulative.begin();
    return std::vector<double>{low[0] + (static_cast<double>(cell / steps) + stream.uniform()) * h0,
                               low[1] + (static_cast<double>(cell % steps) + stream.uniform()) * h1};
  };
  return {std::move(target), log_evidence, draw};
}

/// y = a + b x + e, e ~ N(0, v), with (a, b) ~ N(0, 4 v I) and v ~ inverse gamma(2, 0.5), over (a, b, log v): a t distribution.
inline Known regression(int rows, std::uint64_t record) {
  Stream stream({record, Purpose::test, 0, 3});
  Eigen::MatrixXd x(rows, 2);
  Eigen::VectorXd y(rows);
  for (int i = 0; i < rows; ++i) {
    x(i, 0) = 1, x(i, 1) = stream.normal();
    y(i) = 0.7 - 0.4 * x(i, 1) + 0.5 * stream.normal();
  }
  double const shape = 2, scale = 0.5, spread = 4, log_2pi = std::log(2 * std::numbers::pi);
  Eigen::MatrixXd const precision = x.transpose() * x + Eigen::MatrixXd::Identity(2, 2) / spread;
  Eigen::VectorXd const mean = solve_symmetric(precision, x.transpose() * y);
  double const of_shape = shape + 0.5 * rows, of_scale = scale + 0.5 * (y.squaredNorm() - mean.dot(precision * mean));
  double const log_evidence = -0.5 * rows * log_2pi - std::log(spread) - 0.5 * log_absolute_determinant(precision) +
                              shape * std::log(scale) - of_shape * std::log(of_scale) + std::lgamma(of_shape) - std::lgamma(shape);
  auto const log_density = [=](std::vector<double> const& u) {
    double const v = std::exp(u[2]);
    Eigen::VectorXd const w = Eigen::Map<Eigen::VectorXd const>(u.data(), 2);
    double const rest = (y - x * w).squaredNorm() + w.squaredNorm() / spread + 2 * scale;
    return -0.5 * (rows + 2) * (log_2pi + u[2]) - std::log(spread) - 0.5 * rest / v + shape * std::log(scale) - std::lgamma(shape) -
           shape * u[2];
  };
  Eigen::MatrixXd const root = *cholesky(inverse(precision));
  auto const draw = [=](Stream& s) {
    double gamma = 0;  // of a half-integer shape: half a chi-square
    for (int i = 0; i < rows + 4; ++i) {
      double const z = s.normal();
      gamma += 0.5 * z * z;
    }
    double const v = of_scale / gamma;
    Eigen::VectorXd z(2);
    for (double& each : z) each = s.normal();
    Eigen::VectorXd const w = mean + std::sqrt(v) * (root * z);
    return std::vector<double>{w(0), w(1), std::log(v)};
  };
  return {target_of(3, 5, 60.0 + 3 * rows, log_density), log_evidence, draw};
}

/// y = a + b x + c z + e with priors much wider than the posterior, and e ~ N(0, s^2) with s log-uniform over four decades: on the
/// way from the prior to the posterior the coefficients are as wide as s, a funnel. The evidence by quadrature over log s.
inline Known wide_regression(int rows, std::uint64_t record) {
  Stream stream({record, Purpose::test, 0, 11});
  Eigen::MatrixXd x(rows, 3);
  Eigen::VectorXd y(rows);
  for (int i = 0; i < rows; ++i) {
    x(i, 0) = 1, x(i, 1) = 8 * stream.normal(), x(i, 2) = stream.uniform();
    y(i) = 12 - 0.6 * x(i, 1) + 3 * x(i, 2) + 0.8 * stream.normal();
  }
  Eigen::Vector3d const widths(100, 10, 50);
  double const low = 0.01, high = 100, log_2pi = std::log(2 * std::numbers::pi);
  Eigen::MatrixXd const squares = x.transpose() * x;
  Eigen::VectorXd const products = x.transpose() * y;
  double const size = y.squaredNorm();
  // log N(y | 0, s^2 I + x V x')
  auto const given = [=](double s) {
    Eigen::MatrixXd precision = squares / (s * s);
    precision.diagonal() += widths.cwiseAbs2().cwiseInverse();
    Eigen::VectorXd const mean = solve_symmetric(precision, Eigen::VectorXd(products / (s * s)));
    return -0.5 * rows * (log_2pi + 2 * std::log(s)) - widths.array().log().sum() - 0.5 * log_absolute_determinant(precision) -
           0.5 * (size / (s * s) - mean.dot(precision * mean));
  };
  constexpr int steps = 4000;
  double highest = -infinity, sum = 0;
  std::vector<double> values;
  for (int i = 0; i < steps; ++i) {
    values.push_back(given(low * std::exp((i + 0.5) / steps * std::log(high / low))));
    highest = std::max(highest, values.back());
  }
  for (double const each : values) sum += std::exp(each - highest) / steps;
  double const ceiling = rows * 5.0;
  TestTarget target({"a", "b", "c", "s"},
                    {{Prior::normal, 0, widths(0)},
                     {Prior::normal, 0, widths(1)},
                     {Prior::normal, 0, widths(2)},
                     {Prior::log_uniform, low, high}},
                    1, ceiling, [=](std::vector<double> const& w, std::vector<double>& out) {
                      Eigen::Vector3d const b(w[0], w[1], w[2]);
                      double const rest = size - 2 * b.dot(products) + b.dot(squares * b);
                      out[0] = as_residual(-0.5 * rows * (log_2pi + 2 * std::log(w[3])) - 0.5 * rest / (w[3] * w[3]), ceiling);
                    });
  return {std::move(target), highest + std::log(sum), {}};
}

/// Up to five normal distributions of any shapes, with an evidence of its own.
inline Known mixture_of_normals(int dimension, std::uint64_t record) {
  Stream stream({record, Purpose::test, static_cast<std::uint64_t>(dimension), 4});
  struct Part {
    double share, log_volume;
    Eigen::VectorXd mean;
    Eigen::MatrixXd root, inverse_root;
  };
  std::vector<Part> parts(1 + stream.below(5));
  double sum = 0;
  for (Part& part : parts) {
    sum += part.share = 0.2 + stream.uniform();
    part.mean = Eigen::VectorXd(dimension);
    for (double& each : part.mean) each = 3 * stream.normal() / std::sqrt(dimension);
    part.root = Eigen::MatrixXd::Zero(dimension, dimension);
    part.log_volume = 0;
    for (int i = 0; i < dimension; ++i) {
      for (int j = 0; j < i; ++j) part.root(i, j) = 0.3 * stream.normal() / std::sqrt(dimension);
      part.root(i, i) = 0.3 * std::exp(0.4 * stream.normal());
      part.log_volume += std::log(part.root(i, i));
    }
    part.inverse_root = inverse(part.root);
  }
  double const log_evidence = -20 + 10 * stream.normal();
  auto const log_density = [=](std::vector<double> const& u) {
    double highest = -infinity;
    std::vector<double> logs;
    for (Part const& part : parts) {
      Eigen::VectorXd const off = Eigen::Map<Eigen::VectorXd const>(u.data(), dimension) - part.mean;
      logs.push_back(std::log(part.share / sum) - part.log_volume - 0.5 * dimension * std::log(2 * std::numbers::pi) -
                     0.5 * (part.inverse_root * off).squaredNorm());
      highest = std::max(highest, logs.back());
    }
    double density = 0;
    for (double const each : logs) density += std::exp(each - highest);
    return log_evidence + highest + std::log(density);
  };
  auto const draw = [=](Stream& s) {
    double rest = s.uniform() * sum;
    std::size_t k = 0;
    while (k + 1 < parts.size() && (rest -= parts[k].share) > 0) ++k;
    Eigen::VectorXd z(dimension);
    for (double& each : z) each = s.normal();
    Eigen::VectorXd const u = parts[k].mean + parts[k].root * z;
    return std::vector<double>(u.data(), u.data() + dimension);
  };
  return {target_of(dimension, 5, 200, log_density), log_evidence, draw};
}

/// Decay of an oscillator released from rest, frequency and damping unknown, noise known: 40 samples over four periods.
inline Known linear_oscillator(std::uint64_t record) {
  constexpr int samples = 40;
  auto const motion = [](double k, double c, double t) {
    double const w = std::sqrt(k - 0.25 * c * c);
    return std::exp(-0.5 * c * t) * (std::cos(w * t) + 0.5 * c / w * std::sin(w * t));
  };
  std::vector<double> y;
  Stream stream({record, Purpose::test, 0, 5});
  for (int i = 0; i < samples; ++i) y.push_back(motion(4, 0.3, 0.3 * i) + 0.15 * stream.normal());
  TestTarget target({"k", "c"}, {{Prior::log_uniform, 1, 16}, {Prior::log_uniform, 0.03, 1.5}}, samples,
                    -samples * std::log(0.15 * std::sqrt(2 * std::numbers::pi)),
                    [=](std::vector<double> const& w, std::vector<double>& rows) {
                      for (int i = 0; i < samples; ++i) {
                        auto const at = static_cast<std::size_t>(i);
                        rows[at] = (y[at] - motion(w[0], w[1], 0.3 * i)) / 0.15;
                      }
                    });
  return by_quadrature(std::move(target), {3.3, 0.03}, {4.7, 0.9});
}

/// Values pressed against one bound and, less, against another.
inline Known at_bounds(std::uint64_t record) {
  Stream stream({record, Purpose::test, 0, 6});
  double const first = -0.3 + 0.1 * stream.normal(), second = 0.95 + 0.1 * stream.normal();
  TestTarget target({"a", "b"}, {{Prior::uniform, 0, 1}, {Prior::uniform, 0, 1}}, 3, 0,
                    [=](std::vector<double> const& w, std::vector<double>& rows) {
                      rows[0] = (w[0] - first) / 0.3, rows[1] = (w[1] - second) / 0.1, rows[2] = (w[0] + w[1] - 1) / 0.5;
                    });
  return by_quadrature(std::move(target), {0, 0}, {1, 1});
}

/// Only the product of two values is known.
inline Known ridge(std::uint64_t record) {
  Stream stream({record, Purpose::test, 0, 8});
  double const product = 1 + 0.2 * stream.normal();
  TestTarget target({"a", "b"}, {{Prior::uniform, 0, 3}, {Prior::uniform, 0, 3}}, 1, 0,
                    [=](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = (w[0] * w[1] - product) / 0.1; });
  return by_quadrature(std::move(target), {0, 0}, {3, 3}, 1200);
}

/// Two modes of other shapes and shares.
inline Known two_modes(std::uint64_t record) {
  Stream stream({record, Purpose::test, 0, 9});
  double const apart = 3 + stream.normal() * 0.5, share = 0.2 + 0.6 * stream.uniform();
  auto const log_density = [=](std::vector<double> const& u) {
    auto const bump = [](double x, double y, double sx, double sy) {
      return std::exp(-0.5 * (x * x / (sx * sx) + y * y / (sy * sy))) / (2 * std::numbers::pi * sx * sy);
    };
    double const bent = u[1] - 0.3 * u[0] * u[0];
    return std::log(share * bump(u[0] + apart, u[1], 0.4, 0.8) + (1 - share) * bump(u[0] - apart, bent + 2, 0.7, 0.3) + 1e-300) + 5;
  };
  return by_quadrature(target_of(2, 6, 60, log_density), {-8, -8}, {8, 14}, 1000);
}

/// Neal's: the width of one value is the exponential of the other.
inline Known funnel(std::uint64_t record) {
  Stream stream({record, Purpose::test, 0, 10});
  double const spread = 1 + 0.3 * stream.normal();
  auto const log_density = [=](std::vector<double> const& u) {
    double const width = std::exp(0.5 * u[1]);
    return -0.5 * u[1] * u[1] / (spread * spread) - 0.5 * u[0] * u[0] / (width * width) - std::log(width * spread) -
           std::log(2 * std::numbers::pi);
  };
  auto const draw = [=](Stream& s) {
    double const second = spread * s.normal();
    return std::vector<double>{std::exp(0.5 * second) * s.normal(), second};
  };
  return {target_of(2, 6, 60, log_density), 0, draw};
}

}  // namespace sysid::testing
