// An oscillator under a broad-band force whose stiffness may drop on the way, and a tracker of it.
#pragma once
#include <doctest/doctest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/numeric/random.hpp"
#include "load/load.hpp"
#include "tracking/tracker.hpp"

namespace sysid {

inline Model model_of(std::string const& text) {
  Source source("case.sysid", text);
  Diagnostics diagnostics;
  auto file = load(source, diagnostics);
  REQUIRE_MESSAGE(file, render(diagnostics, source));
  return file->models.front();
}

inline char const* const oscillator_text = R"(
model oscillator {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter m [kg] ~ log_uniform(0.1, 10)
  parameter c [N s/m] ~ log_uniform(0.01, 100)
  parameter k [N/m] ~ log_uniform(10, 1000)
  parameter sigma [m] ~ log_uniform(1e-5, 1)
  m*y'' + c*y' + k*y = x
  observe displacement ~ normal(y, sd = sigma)
}
)";

/// Natural frequency 10 rad/s, 5 % of critical damping, 21 samples in a period; noise of 5 % of the response.
struct MadeOscillator {
  double m = 1, c = 1, k = 100, sigma = 0.0055;
  double step = 0.03;
  int rows = 1000;
  int change_after = 0;  // row from which on the stiffness is multiplied by `factor`; 0: never
  double factor = 0.9;
  std::uint64_t seed = 1;

  /// The force is held from sample to sample; the response has an sd near 0.11 m.
  Experiment experiment() const {
    Stream force(StreamKey{seed, Purpose::test, 1, 0}), noise(StreamKey{seed, Purpose::test, 2, 0});
    Experiment made;
    std::vector<double> x;
    std::vector<double> measured;
    double y = 0, v = 0;
    for (int i = 0; i < rows; ++i) {
      made.time.push_back(i * step);
      x.push_back(9 * force.normal());
      measured.push_back(y + sigma * noise.normal());
      double const stiffness = change_after > 0 && i + 1 >= change_after ? factor * k : k;
      for (int s = 0; s < 2; ++s) advance(y, v, x.back(), stiffness, step / 2);
    }
    made.name = "made";
    made.inputs.emplace_back(InputRule::zero_order, made.time, x);
    made.measured = {measured};
    made.scored.assign(static_cast<std::size_t>(rows), 1);
    return made;
  }

 private:
  void advance(double& y, double& v, double x, double stiffness, double h) const {
    auto const a = [&](double at_y, double at_v) { return (x - c * at_v - stiffness * at_y) / m; };
    double const v1 = v, a1 = a(y, v);
    double const v2 = v + h / 2 * a1, a2 = a(y + h / 2 * v1, v2);
    double const v3 = v + h / 2 * a2, a3 = a(y + h / 2 * v2, v3);
    double const v4 = v + h * a3, a4 = a(y + h * v3, v4);
    y += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
};

/// m, c and k, known to 0.5 % each, with the drift that is the default of the program.
inline Tracker oscillator_tracker(TrackedProgram const& program, MadeOscillator const& believed, double drift = 0.01) {
  TrackedPrior prior{Eigen::Vector3d(std::log(believed.m), std::log(believed.c), std::log(believed.k)),
                     0.005 * 0.005 * Eigen::Matrix3d::Identity()};
  StatePrior const rest{Eigen::Vector2d::Zero(), Eigen::Matrix2d::Zero(), false};
  TrackingOptions options;
  options.intensities.assign(3, drift * drift / (1000 * believed.step));
  options.scales.assign(3, 1.0);
  return {program, SolverSettings{}, ExecutionOptions{}, prior, rest, options};
}

inline TrackedProgram oscillator_program(Model const& model, double sigma, MomentRule rule = MomentRule::linearised) {
  std::vector<double> const values = {1, 1, 100, sigma};
  std::vector<TrackedParameter> const tracked = {{0, 0.0, {}, false}, {1, 0.0, {}, false}, {2, 0.0, {}, false}};
  return compile_tracking(model, values, tracked, "rk4", rule);
}

}  // namespace sysid
