// Records for the study `run` beside this file, made without any code of sysid: `record duffing SEED LEVEL INPUT_ERROR [HOLD]` or
// `record chain SEED SAMPLES NOISE`, to the standard output, with the true values in comments. Compiled by `run`.
//
// duffing: models/duffing from rest, 500 samples at 1 kHz, force normal with sd 10 N and held for a sample, displacement with 1 %
//   normal noise. An unmeasured force with an rms of LEVEL times that of the measured one in means over a sample: redrawn at each
//   substep, sd larger by the root of their number, which is as white as the integration can have it; or, with HOLD, once a sample.
//   The force is recorded with normal errors of INPUT_ERROR times its rms. Runge-Kutta's fourth order, 20 substeps a sample.
// chain: five masses between springs and dashpots, the first one tied to the ground, white forces on all, none recorded; SAMPLES
//   velocities of all masses at 50 Hz once the start is forgotten, with normal noise of NOISE times the rms of each. 40 substeps.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <vector>

namespace {

std::mt19937_64 generator;

double normal() {
  static std::normal_distribution<double> distribution(0, 1);
  return distribution(generator);
}

double rms(std::vector<double> const& values) {
  double mean = 0, squares = 0;
  for (double value : values) mean += value / values.size();
  for (double value : values) squares += (value - mean) * (value - mean) / values.size();
  return std::sqrt(squares);
}

/// One step of Runge and Kutta of fourth order, the derivative being rate(state).
template <std::size_t n, class Rate>
std::array<double, n> runge_kutta(std::array<double, n> const& state, double step, Rate const& rate) {
  auto const moved = [&](std::array<double, n> const& slope, double by) {
    std::array<double, n> result = state;
    for (std::size_t i = 0; i < n; ++i) result[i] += by * slope[i];
    return result;
  };
  auto const first = rate(state);
  auto const second = rate(moved(first, step / 2));
  auto const third = rate(moved(second, step / 2));
  auto const fourth = rate(moved(third, step));
  std::array<double, n> result = state;
  for (std::size_t i = 0; i < n; ++i) result[i] += step / 6 * (first[i] + 2 * second[i] + 2 * third[i] + fourth[i]);
  return result;
}

void duffing(double level, double input_error, bool held) {
  constexpr double m = 1, c = 20, k = 1e4, k3 = 5e9, force_sd = 10, interval = 1e-3;
  constexpr int samples = 500, substeps = 20;
  std::vector<double> force, displacement;
  std::array<double, 2> state{0, 0};
  double const sd = level * force_sd * (held ? 1 : std::sqrt(double(substeps)));
  for (int n = 0; n < samples; ++n) {
    force.push_back(force_sd * normal());
    displacement.push_back(state[0]);
    double unmeasured = 0;
    for (int substep = 0; substep < substeps; ++substep) {
      if (substep == 0 || !held) unmeasured = sd * normal();
      double const acting = force[n] + unmeasured;
      state = runge_kutta(state, interval / substeps, [&](std::array<double, 2> const& s) {
        return std::array<double, 2>{s[1], (acting - c * s[1] - k * s[0] - k3 * s[0] * s[0] * s[0]) / m};
      });
    }
  }
  double const sigma = 0.01 * rms(displacement);
  std::printf("# m = %g\n# c = %g\n# k = %g\n# k3 = %g\n# s = %.17g\n# sigma = %.17g\nt,x,displacement\n", m, c, k, k3,
              level * force_sd, sigma);
  for (int n = 0; n < samples; ++n)
    std::printf("%.17g,%.17g,%.17g\n", n * interval, force[n] + input_error * force_sd * normal(),
                displacement[n] + sigma * normal());
}

void chain(int samples, double noise) {
  constexpr std::size_t masses = 5;
  constexpr double m = 1000, intensity = 100, interval = 0.02;
  constexpr std::array<double, masses> k{1.6e6, 1.4e6, 1.2e6, 1.0e6, 0.8e6}, c{1600, 1400, 1200, 1000, 800};
  constexpr int substeps = 40, forgotten = 3000;
  double const sd = std::sqrt(intensity / (interval / substeps));
  std::array<double, 2 * masses> state{};
  std::array<std::vector<double>, masses> velocity;
  for (int n = -forgotten; n < samples; ++n) {
    if (n >= 0)
      for (std::size_t i = 0; i < masses; ++i) velocity[i].push_back(state[masses + i]);
    for (int substep = 0; substep < substeps; ++substep) {
      std::array<double, masses> force;
      for (double& value : force) value = sd * normal();
      state = runge_kutta(state, interval / substeps, [&](std::array<double, 2 * masses> const& s) {
        std::array<double, 2 * masses> rate;
        std::array<double, masses + 1> pull{};  // of the spring and the dashpot below each mass
        for (std::size_t i = 0; i < masses; ++i)
          pull[i] = k[i] * (s[i] - (i ? s[i - 1] : 0)) + c[i] * (s[masses + i] - (i ? s[masses + i - 1] : 0));
        for (std::size_t i = 0; i < masses; ++i) {
          rate[i] = s[masses + i];
          rate[masses + i] = (force[i] - pull[i] + pull[i + 1]) / m;
        }
        return rate;
      });
    }
  }
  std::printf("# q = %g\n", intensity);
  for (std::size_t i = 0; i < masses; ++i) std::printf("# k[%zu] = %g\n# c[%zu] = %g\n", i + 1, k[i], i + 1, c[i]);
  std::printf("t,v1,v2,v3,v4,v5\n");
  std::array<double, masses> sigma;
  for (std::size_t i = 0; i < masses; ++i) sigma[i] = noise * rms(velocity[i]);
  for (int n = 0; n < samples; ++n) {
    std::printf("%.17g", n * interval);
    for (std::size_t i = 0; i < masses; ++i) std::printf(",%.17g", velocity[i][n] + sigma[i] * normal());
    std::printf("\n");
  }
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 5) return std::fprintf(stderr, "record duffing SEED LEVEL INPUT_ERROR [HOLD]\nrecord chain SEED SAMPLES NOISE\n"), 2;
  generator.seed(std::strtoull(arguments[2], nullptr, 10));
  if (!std::strcmp(arguments[1], "duffing"))
    duffing(std::atof(arguments[3]), std::atof(arguments[4]), count > 5);
  else
    chain(std::atoi(arguments[3]), std::atof(arguments[4]));
}
