// Targets with known answers for the tests of back ends: priors over simple coordinates, likelihoods written out.
#pragma once
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/system/interrupt.hpp"
#include "inference/backend/backend.hpp"
#include "likelihood/target.hpp"

namespace sysid::testing {

/// A parameter with a normal prior on the line, or a uniform or log-uniform one between bounds.
struct Prior {
  enum Kind { normal, uniform, log_uniform } kind;
  double a, b;   // mean and sd, or lower and upper bound
  double width;  // of what is uniform
  double log_scale;

  Prior(Kind kind, double a, double b)
      : kind(kind), a(a), b(b), width(kind == log_uniform ? elementary::log(b / a) : b - a), log_scale(elementary::log(width)) {
    if (kind == normal) log_scale = 0.5 * elementary::log(2 * std::numbers::pi * b * b);
  }
  double constrain(double u) const {
    if (kind == normal) return u;
    double const share = 1 / (1 + elementary::exp(-u));
    if (kind == uniform) return a + width * share;
    return a * elementary::exp(width * share);
  }
  double unconstrain(double x) const {
    if (kind == normal) return x;
    double const share = kind == uniform ? (x - a) / width : elementary::log(x / a) / width;
    return elementary::log(share / (1 - share));
  }
  double log_density(double x) const {
    if (kind == normal) return -0.5 * (x - a) * (x - a) / (b * b) - log_scale;
    return kind == uniform ? -log_scale : -elementary::log(x) - log_scale;
  }
  double log_jacobian(double u) const {
    if (kind == normal) return 0;
    double const distance = std::fabs(u);  // share (1 - share) = exp(-distance) / (1 + exp(-distance))^2
    double const logistic = -distance - 2 * elementary::log1p(elementary::exp(-distance));
    return kind == uniform ? logistic + log_scale : logistic + log_scale + elementary::log(constrain(u));
  }
  double draw(Stream& stream) const {
    if (kind == normal) return a + b * stream.normal();
    double const share = stream.uniform();
    return elementary::log(share / (1 - share));
  }
};

class TestTarget : public Target {
 public:
  /// Writes the residual rows of one parameter vector (declared values): -log likelihood = 1/2 sum r^2 - constant.
  using Residuals = std::function<void(std::vector<double> const& declared, std::vector<double>& rows)>;

  TestTarget(std::vector<std::string> names, std::vector<Prior> priors, int rows, double constant, Residuals residuals)
      : priors_(std::move(priors)), rows_(rows), constant_(constant), residuals_(std::move(residuals)) {
    for (std::size_t p = 0; p < priors_.size(); ++p) {
      bool const bounded = priors_[p].kind != Prior::normal;
      infos_.push_back({names[p], "", bounded ? priors_[p].a : -infinity, bounded ? priors_[p].b : infinity});
    }
  }

  int dimension() const override { return static_cast<int>(priors_.size()); }
  std::span<ParameterInfo const> parameters() const override { return infos_; }
  void sample_prior(StreamKey key, Lanes theta) const override {
    for (int w = 0; w < theta.width(); ++w) {
      Stream stream(key.with_index(key.index + static_cast<std::uint64_t>(w)));
      for (int p = 0; p < theta.rows(); ++p) theta(p, w) = priors_[static_cast<std::size_t>(p)].draw(stream);
    }
  }
  void log_prior(ConstLanes theta, std::span<double> out, bool jacobian) const override {
    for (int w = 0; w < theta.width(); ++w) {
      double sum = 0;
      for (int p = 0; p < theta.rows(); ++p) {
        Prior const& prior = priors_[static_cast<std::size_t>(p)];
        sum += prior.log_density(prior.constrain(theta(p, w)));
        if (jacobian) sum += prior.log_jacobian(theta(p, w));
      }
      out[static_cast<std::size_t>(w)] = sum;
    }
  }
  void log_likelihood(ConstLanes theta, std::span<double> out, Ledger& ledger) const override {
    LaneArray rows(rows_, theta.width());
    residuals(theta, rows, ledger);
    std::vector<double> sums(out.size(), 0.0);  // row by row, as the lanes of a row lie beside each other
    for (int r = 0; r < rows_; ++r)
      for (int w = 0; w < theta.width(); ++w) sums[static_cast<std::size_t>(w)] += rows(r, w) * rows(r, w);
    for (std::size_t w = 0; w < sums.size(); ++w) out[w] = constant_ - 0.5 * sums[w];
  }
  int residual_count() const override { return rows_; }
  void residuals(ConstLanes theta, Lanes out, Ledger& ledger) const override {
    std::vector<double> declared(priors_.size());
    constexpr int together = 8;  // lanes, which are written row by row
    std::vector<std::vector<double>> rows(together, std::vector<double>(static_cast<std::size_t>(rows_)));
    ledger.add_solves(static_cast<std::uint64_t>(theta.width()));
    solves += static_cast<std::uint64_t>(theta.width());
    for (int first = 0; first < theta.width(); first += together) {
      int const count = std::min(together, theta.width() - first);
      for (int w = 0; w < count; ++w) {
        std::vector<double>& own = rows[static_cast<std::size_t>(w)];
        for (std::size_t p = 0; p < declared.size(); ++p) declared[p] = priors_[p].constrain(theta(static_cast<int>(p), first + w));
        residuals_(declared, own);
        if (std::all_of(own.begin(), own.end(), [](double r) { return std::isfinite(r); })) continue;
        ledger.add_failure(FailureClass::non_finite, "the test's residual", 0.25, declared);
        std::fill(own.begin(), own.end(), infinity);
      }
      for (int r = 0; r < rows_; ++r)
        for (int w = 0; w < count; ++w) out(r, first + w) = rows[static_cast<std::size_t>(w)][static_cast<std::size_t>(r)];
    }
  }
  void constrain(ConstLanes theta, Lanes declared) const override {
    for (int p = 0; p < theta.rows(); ++p)
      for (int w = 0; w < theta.width(); ++w) declared(p, w) = priors_[static_cast<std::size_t>(p)].constrain(theta(p, w));
  }
  void unconstrain(ConstLanes declared, Lanes theta) const override {
    for (int p = 0; p < theta.rows(); ++p)
      for (int w = 0; w < theta.width(); ++w) theta(p, w) = priors_[static_cast<std::size_t>(p)].unconstrain(declared(p, w));
  }

  mutable std::uint64_t solves = 0;

 private:
  std::vector<Prior> priors_;
  std::vector<ParameterInfo> infos_;
  int rows_;
  double constant_;
  Residuals residuals_;
};

/// A target whose batch number `last` is given up, as where simulations are asked to stop (ExecutionOptions::throws).
class GivenUp : public TestTarget {
 public:
  GivenUp(TestTarget target, int last) : TestTarget(std::move(target)), last_(last) {}
  void log_likelihood(ConstLanes theta, std::span<double> out, Ledger& ledger) const override {
    if (++batches == last_) throw Interrupted();
    widths.push_back(theta.width());
    TestTarget::log_likelihood(theta, out, ledger);
  }
  mutable int batches = 0;
  mutable std::vector<int> widths;

 private:
  int last_;
};

/// A row that carries a log likelihood as it is: 1/2 r^2 = ceiling - log likelihood, for any ceiling above it.
inline double as_residual(double log_likelihood, double ceiling) { return std::sqrt(2 * (ceiling - log_likelihood)); }

/// What a run needs, with nobody watching.
struct Bench {
  explicit Bench(std::uint64_t seed = 1) : context{.seed = seed, .progress = progress, .ledger = ledger} {}
  SilentProgress progress;
  Ledger ledger;
  RunContext context;
};

/// Duffing's oscillator as in the tutorial's Sec. 8.4: 500 samples at 1000 Hz, held white force of sd 10, 1 % noise, parameters m,
/// c, k, k3 and noise precision, log-uniform a decade (the precision two) either side of the truth.
inline TestTarget duffing(std::uint64_t record) {
  constexpr int samples = 500;
  constexpr double dt = 1e-3;
  std::vector<double> force(samples);
  Stream input({record, Purpose::input, 0, 0});
  for (double& f : force) f = 10 * input.normal();
  auto const simulate = [force](double m, double c, double k, double k3, std::vector<double>& y) {
    double x = 0, v = 0;
    double const over_m = 1 / m;
    for (int i = 0; i < samples; ++i) {
      y[static_cast<std::size_t>(i)] = x;
      double const f = force[static_cast<std::size_t>(i)];
      auto const a = [&](double p, double q) { return (f - c * q - k * p - k3 * p * p * p) * over_m; };
      double const a1 = a(x, v), v2 = v + dt / 2 * a1, a2 = a(x + dt / 2 * v, v2);
      double const v3 = v + dt / 2 * a2, a3 = a(x + dt / 2 * v2, v3), v4 = v + dt * a3, a4 = a(x + dt * v3, v4);
      x += dt / 6 * (v + 2 * v2 + 2 * v3 + v4);
      v += dt / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
  };
  std::vector<double> clean(samples);
  simulate(1, 20, 1e4, 5e9, clean);
  double mean = 0, square = 0;
  for (double const y : clean) mean += y / samples;
  for (double const y : clean) square += (y - mean) * (y - mean) / samples;
  double const sigma = 0.01 * std::sqrt(square);
  std::vector<double> measured = clean;
  Stream noise({record, Purpose::noise, 0, 0});
  for (double& y : measured) y += sigma * noise.normal();

  double const beta = 1 / (sigma * sigma);
  // 1/2 (ceiling row)^2 = ceiling - 1/2 N log(beta / 2 pi): the Gaussian constant, which only beta moves.
  double const ceiling = 0.5 * samples * elementary::log(1000 * beta / (2 * std::numbers::pi));
  auto const residuals = [=](std::vector<double> const& w, std::vector<double>& rows) {
    std::vector<double> y(samples);
    simulate(w[0], w[1], w[2], w[3], y);
    double const weight = std::sqrt(w[4]);
    for (std::size_t i = 0; i < samples; ++i) rows[i] = weight * (measured[i] - y[i]);
    rows[samples] = as_residual(0.5 * samples * elementary::log(w[4] / (2 * std::numbers::pi)), ceiling);
  };
  return TestTarget({"m", "c", "k", "k3", "beta"},
                    {{Prior::log_uniform, 0.1, 10},
                     {Prior::log_uniform, 2, 200},
                     {Prior::log_uniform, 1e3, 1e5},
                     {Prior::log_uniform, 5e8, 5e10},
                     {Prior::log_uniform, beta / 100, beta * 100}},
                    samples + 1, ceiling, residuals);
}

}  // namespace sysid::testing
