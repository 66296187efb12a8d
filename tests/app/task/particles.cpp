// Fits by particles as a user runs them, beside what can be computed: the Kalman filter of a linear model, and a state that is
// integrated by quadrature under noise with heavy tails.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "app/running.hpp"
#include "core/numeric/random.hpp"
#include "relative.hpp"

using namespace sysid;
using json = nlohmann::json;

namespace {

/// x' = -a x + w, white noise of intensity q, with a fine step of its own.
std::string relaxation(double a, double q, std::uint64_t seed, int samples, bool heavy) {
  Stream stream({seed, Purpose::test});
  constexpr int fine = 100;
  double const step = 0.25 / fine;
  double x = stream.normal();
  std::string text = "t,m\n";
  for (int i = 0; i < samples; ++i) {
    double noise = 0.3 * stream.normal();
    if (heavy) noise /= std::sqrt((std::pow(stream.normal(), 2) + std::pow(stream.normal(), 2) + std::pow(stream.normal(), 2)) / 3);
    text += fmt::format("{},{}\n", 0.25 * i, x + noise);
    for (int k = 0; k < fine; ++k) x += -a * x * step + std::sqrt(q * step) * stream.normal();
  }
  return text;
}

std::string const relaxing = R"(
model relaxing {
  state x
  initial x ~ normal(0, sd = 1)
  parameter a [1/s] ~ log_uniform(0.05, 20)
  parameter q [1/s] ~ log_uniform(0.005, 50)
  disturbance w [1/s] ~ white(intensity = q)
  x' = -a*x + w
  observe m ~ normal(x, sd = 0.3)
}
data d { file "d.csv"; time t [s]; measure m = m }
)";

std::string const short_chain = "mh(samples = 2500, burn_in = 500, thin = 2, chains = 4)";

double posterior_of(json const& summary, std::string const& name, std::string const& key) {
  return parameter(summary, name).at(key).get<double>();
}

bool among_findings(json const& summary, std::string const& code) {
  for (json const& each : summary.at("findings"))
    if (each.at("code") == code) return true;
  return false;
}

/// Draws of all chains, as they are stored.
std::string stored_draws_of(std::filesystem::path const& results, std::string const& task) {
  std::string all;
  for (int c = 1; c <= 4; ++c) all += read_file(results / task / fmt::format("draws_{}.csv", c));
  return all;
}

}  // namespace

TEST_CASE("particles sample the posterior that the Kalman filter computes") {
  std::string const text = relaxing + "exact = fit relaxing to d with " + short_chain +
                           ", filter = kalman, solver = exponential, seed = 1\ncloud = fit relaxing to d with " + short_chain +
                           ", filter = particle, solver = exponential, seed = 1\n";
  CaseRun const run(text, {{"d.csv", relaxation(1, 0.5, 3, 40, false)}});
  json const exact = run.summary("exact"), cloud = run.summary("cloud");
  for (char const* name : {"a", "q"}) {
    CAPTURE(name);
    double const sd = posterior_of(exact, name, "sd");
    double const error = std::hypot(posterior_of(exact, name, "mcse_mean"), posterior_of(cloud, name, "mcse_mean"));
    MESSAGE(name << ": " << posterior_of(exact, name, "mean") << " +- " << sd << ", by particles "
                 << posterior_of(cloud, name, "mean") << " +- " << posterior_of(cloud, name, "sd") << ", mcse of the difference "
                 << error);
    CHECK(std::abs(posterior_of(cloud, name, "mean") - posterior_of(exact, name, "mean")) < 4 * error);
    CHECK(posterior_of(cloud, name, "sd") == relative(sd, 0.2));
  }
  CHECK(cloud.at("settings").at("filter") == "particle");
  CHECK(cloud.at("settings").at("particles").get<int>() >= 64);
  CHECK(cloud.at("settings").at("log_likelihood_sd").get<double>() <= 1.2);
  CHECK_FALSE(among_findings(cloud, "likelihood_too_noisy"));
  CHECK_FALSE(among_findings(cloud, "residuals_not_white"));
  CHECK_FALSE(among_findings(cloud, "noise_size"));
  // One estimate per parameter vector has an evidence, too.
  double const difference =
      cloud.at("evidence").at("log_evidence").get<double>() - exact.at("evidence").at("log_evidence").get<double>();
  MESSAGE("log evidence differs by " << difference);
  CHECK(std::abs(difference) < 0.3);
}

TEST_CASE("a fit by particles is the same for any threads and lanes, and when it was interrupted") {
  std::string const text =
      relaxing +
      "cloud = fit relaxing to d with mh(samples = 200, burn_in = 100, thin = 2, chains = 4), filter = particle, "
      "particles = 40, seed = 1\n";
  TemporaryFolder folder;
  write_file(folder.path() / "d.csv", relaxation(1, 0.5, 3, 20, false));
  RunOptions options;
  options.output = folder.path() / "whole";
  run_text(folder.path() / "case.sysid", text, options);
  std::string const whole = stored_draws_of(options.output, "cloud");
  options.output = folder.path() / "other";
  options.execution.threads = 2;
  options.execution.lanes = 8;
  run_text(folder.path() / "case.sysid", text, options);
  CHECK(stored_draws_of(options.output, "cloud") == whole);
  CHECK(read_file(options.output / "cloud/states.csv") == read_file(folder.path() / "whole/cloud/states.csv"));
  for (std::uint64_t const poll : {20, 60}) {
    CAPTURE(poll);
    options = {};
    options.output = folder.path() / std::to_string(poll);
    options.checkpoint_interval = 0;
    options.interrupt_after = poll;
    RunResult const broken = run_text(folder.path() / "case.sysid", text, options);
    clear_interrupt();
    REQUIRE(broken.exit == 75);
    options.interrupt_after = 0;
    options.resume = true;
    options.checkpoint_interval = RunOptions().checkpoint_interval;  // it has its checkpoint, and needs no more of them
    run_text(folder.path() / "case.sysid", text, options);
    CHECK(stored_draws_of(options.output, "cloud") == whole);
  }
}

TEST_CASE("noise with heavy tails: the posterior by particles is that by quadrature over the state") {
  std::string const heavy = without(with(relaxing, "normal(x, sd = 0.3)", "student_t(x, 3, scale = 0.3)"),
                                    "  parameter q [1/s] ~ log_uniform(0.005, 50)\n");
  std::string const text =
      with(heavy, "intensity = q", "intensity = 0.5") + "post = fit relaxing to d with " + short_chain +
      ", solver = exponential, seed = 1\nahead = predict post on d with draws(50), prediction = one_step, seed = 1\n";
  std::string const data = relaxation(1, 0.5, 5, 40, true);
  CaseRun const run(text, {{"d.csv", data}});
  CHECK(run.result.notices.find("filter = particle, because no other filter supports the noise of `m`, which is `student_t`") !=
        std::string::npos);
  std::vector<double> measured;
  std::istringstream lines(data);
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) measured.push_back(std::stod(line.substr(line.find(',') + 1)));
  // log a on a grid; the state on another.
  constexpr int places = 240, states = 241;
  double const low = std::log(0.05), high = std::log(20), width = (high - low) / places, reach = 6, h = 2 * reach / (states - 1);
  std::vector<double> log_density;
  for (int k = 0; k < places; ++k) {
    double const a = std::exp(low + (k + 0.5) * width), keeps = std::exp(-a * 0.25);
    double const variance = 0.5 * (1 - keeps * keeps) / (2 * a);
    std::vector<double> p(states), next(states), kernel(states * states);
    for (int i = 0; i < states; ++i) {
      double const x = -reach + i * h;
      p[static_cast<std::size_t>(i)] = std::exp(-0.5 * x * x) / std::sqrt(2 * std::numbers::pi);
      for (int j = 0; j < states; ++j) {
        double const to = -reach + j * h - keeps * x;
        kernel[static_cast<std::size_t>(j * states + i)] =
            std::exp(-0.5 * to * to / variance) / std::sqrt(2 * std::numbers::pi * variance);
      }
    }
    double sum = 0;
    for (std::size_t n = 0; n < measured.size(); ++n) {
      if (n > 0) {
        for (std::size_t j = 0; j < p.size(); ++j) {
          double moved = 0;
          for (std::size_t i = 0; i < p.size(); ++i) moved += kernel[j * p.size() + i] * p[i];
          next[j] = h * moved;
        }
        p = next;
      }
      double mass = 0;
      for (int i = 0; i < states; ++i) {
        double const z = (measured[n] - (-reach + i * h)) / 0.3;
        mass += h * (p[static_cast<std::size_t>(i)] *= std::pow(1 + z * z / 3, -2));
      }
      for (double& each : p) each /= mass;
      sum += std::log(mass);
    }
    log_density.push_back(sum);
  }
  double const most = *std::max_element(log_density.begin(), log_density.end());
  double mass = 0, mean = 0, square = 0;
  for (int k = 0; k < places; ++k) {
    double const a = std::exp(low + (k + 0.5) * width), weight = std::exp(log_density[static_cast<std::size_t>(k)] - most);
    mass += weight;
    mean += weight * a;
    square += weight * a * a;
  }
  mean /= mass;
  double const sd = std::sqrt(square / mass - mean * mean);
  json const summary = run.summary("post");
  MESSAGE("a: " << mean << " +- " << sd << " by quadrature, " << posterior_of(summary, "a", "mean") << " +- "
                << posterior_of(summary, "a", "sd") << " by particles, mcse " << posterior_of(summary, "a", "mcse_mean"));
  CHECK(std::abs(posterior_of(summary, "a", "mean") - mean) < 4 * posterior_of(summary, "a", "mcse_mean"));
  CHECK(posterior_of(summary, "a", "sd") == doctest::Approx(sd).epsilon(0.15));
  CHECK_FALSE(among_findings(summary, "noise_size"));
  double const covered = run.summary("ahead").at("fit").at("coverage_95").get<double>();
  CHECK(covered > 0.85);
}

TEST_CASE("too few particles are a finding, and the states of a random walk lie within their bands") {
  std::string const text = relaxing +
                           "few = fit relaxing to d with mh(samples = 100, burn_in = 50, thin = 2), filter = particle, "
                           "particles = 16, seed = 1\n";
  CaseRun const run(with(text, "sd = 0.3)", "sd = 0.01)"), {{"d.csv", relaxation(1, 0.5, 3, 30, false)}});
  json const summary = run.summary("few");
  CHECK(among_findings(summary, "likelihood_too_noisy"));
  CHECK(among_findings(summary, "particles_degenerate"));
}

TEST_CASE("a solver that does not draw white noise anew in its steps says so") {
  std::string const fit = " = fit relaxing to d with mh(samples = 40, burn_in = 20), filter = particle, particles = 64, seed = 1";
  CaseRun const run(relaxing + "steps" + fit + ", substeps = 2\nlines" + fit + ", solver = exponential\n",
                    {{"d.csv", relaxation(1, 0.5, 3, 20, false)}});
  CHECK_FALSE(among_findings(run.summary("steps"), "noise_in_lines"));
  CHECK(among_findings(run.summary("lines"), "noise_in_lines"));
}
