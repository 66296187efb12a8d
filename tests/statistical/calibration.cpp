// Simulation-based calibration of every back end on four models, by the verb that users have, and of samplers that are wrong.
// SYSID_REPLICATIONS sets how many records are made of each; with 500 and SYSID_TEST_SIZE=full all takes about eight minutes of two
// processors.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "calibrating.hpp"
#include "core/text/number.hpp"
#include "fits.hpp"
#include "linear_algebra/decompositions.hpp"
#include "replications.hpp"
#include "search/laplace.hpp"
#include "search/objective.hpp"

using namespace sysid;
using nlohmann::json;

namespace {

/// A model with its data block, and the record whose inputs, rows and missing samples are used.
struct CalibrationCase {
  char const* name;
  std::string text, csv;
};

std::string numbers(char const* header, int rows, std::function<std::string(int row, Stream& stream)> const& row) {
  Stream stream({31, Purpose::test, 0, 0});
  std::string csv = header;
  for (int i = 0; i < rows; ++i) csv += row(i, stream) + "\n";
  return csv;
}

// A differential equation that is linear in its parameters, with missing samples.
CalibrationCase drift() {
  return {"drift",
          "model m {\n  input x\n  state y\n  initial y = 0\n  parameter a ~ normal(0, sd = 2)\n  parameter b ~ normal(0, sd = 2)\n"
          "  parameter sigma ~ log_uniform(0.05, 1)\n  y' = a + b*x\n  observe level ~ normal(y, sd = sigma)\n}\n"
          "data d { file \"record.csv\"; time t [s]; input x = x hold zero_order; measure level = y }\n",
          numbers("t,x,y\n", 60, [](int i, Stream& stream) {
            return shortest(0.1 * i) + "," + shortest(stream.normal()) + "," + (i % 13 == 7 ? "" : "0");
          })};
}

// Nonlinear, of second order, with a prior that is cut off.
CalibrationCase oscillator() {
  return {
      "oscillator",
      "model m {\n  input x\n  state y\n  initial y = 0, y' = 0\n  parameter c ~ log_uniform(0.1, 2)\n"
      "  parameter k ~ log_normal(median = 20, log_sd = 0.3)\n  parameter k3 ~ normal(0, sd = 5, lower = 0)\n"
      "  parameter sigma ~ log_uniform(0.005, 0.1)\n  y'' + c*y' + k*y + k3*y^3 = 5*x\n"
      "  observe displacement ~ normal(y, sd = sigma)\n}\n"
      "data d { file \"record.csv\"; time t [s]; input x = x hold zero_order; measure displacement = y }\n",
      numbers("t,x,y\n", 120, [](int i, Stream& stream) { return shortest(0.05 * i) + "," + shortest(stream.normal()) + ",0"; })};
}

// Rows without dynamics, counts.
CalibrationCase counts() {
  return {
      "counts",
      "model m {\n  input x\n  parameter a ~ normal(1, sd = 1)\n  parameter b ~ normal(0, sd = 2)\n  observe n ~ poisson(exp(a + "
      "b*x))\n}\ndata d { file \"record.csv\"; input x = x; measure n = n }\n",
      numbers("x,n\n", 40, [](int i, Stream&) { return shortest(i / 39.0) + ",1"; })};
}

// Discrete time, predicted from measured past samples: made samples are read by those after them.
CalibrationCase autoregression() {
  return {"autoregression",
          "model m {\n  time discrete 1 [s]\n  input u\n  parameter a ~ uniform(-0.95, 0.95)\n  parameter b ~ normal(0, sd = 2)\n"
          "  parameter sigma ~ log_uniform(0.02, 1)\n  observe y ~ normal(a*lag(measured(y), 1) + b*lag(u, 1), sd = sigma)\n}\n"
          "data d { file \"record.csv\"; step 1 [s]; input u = u; measure y = y }\n",
          numbers("u,y\n", 150, [](int, Stream& stream) { return shortest(stream.normal()) + ",0"; })};
}

/// The summary of a calibration.
json calibrated(CalibrationCase const& of, std::string const& backend, int count, std::uint64_t seed,
                BackendRow const* planted = nullptr) {
  TemporaryFolder const folder;
  write_file(folder.path() / "record.csv", of.csv);
  RunOptions run;
  run.output = folder.path() / "results";
  run.seed = seed;
  run.execution.threads = 0;
  CalibrateOptions options;
  options.replications = count;
  options.backend = planted;
  CalibrateResult const result =
      calibrate_text(folder.path() / "case.sysid", of.text + "posterior = fit m to d with " + backend + "\n", run, options);
  json summary = json::parse(read_file(run.output / "posterior/summary.json"));
  summary["exit"] = result.exit;
  MESSAGE(std::string(of.name) << " by " << backend << ":\n" << result.out.substr(result.out.find("\ncalibration\n") + 1));
  return summary;
}

bool uniform(json const& summary) {
  for (auto const& [name, quantity] : summary.at("calibration").at("quantities").items())
    if (quantity.at("ranks_are") != "uniform") return false;
  return true;
}

/// A random walk by Metropolis from the mode, four chains in lanes. excess: how much more probable an acceptance is than it should
/// be.
FitResult random_walk(Target const& target, RunContext& context, double excess) {
  constexpr int chains = 4, burn_in = 500, kept = 250, thin = 12;
  Mode const& mode = context.modes.front();
  int const parameters = target.dimension();
  Eigen::MatrixXd const root = 2.38 / std::sqrt(parameters) * cholesky_or_diagonal(covariance_of(mode));
  LaneArray now(parameters, chains), next(parameters, chains), declared(parameters, chains);
  for (int p = 0; p < parameters; ++p)
    for (int c = 0; c < chains; ++c) now(p, c) = mode.theta[static_cast<std::size_t>(p)];
  auto const log_density = [&](ConstLanes theta, std::vector<double>& likelihood) {
    std::vector<double> density(chains);
    target.log_prior(theta, density, true);
    target.log_likelihood(theta, likelihood, context.ledger);
    for (std::size_t c = 0; c < chains; ++c) density[c] += likelihood[c];
    return density;
  };
  std::vector<double> likelihood(chains), proposed_likelihood(chains);
  std::vector<double> density = log_density(now, likelihood);
  FitResult result;
  for (ParameterInfo const& each : target.parameters()) {
    result.draws.names.push_back(each.name);
    result.draws.units.push_back(each.unit);
  }
  result.draws.parameter_count = parameters;
  result.draws.chains.resize(chains);
  result.modes = context.modes;
  for (int i = 0; i < burn_in + kept * thin; ++i) {
    std::vector<double> uniform;
    for (int c = 0; c < chains; ++c) {
      Stream stream({context.seed, Purpose::proposal, static_cast<std::uint64_t>(c), static_cast<std::uint64_t>(i)});
      Eigen::VectorXd z(parameters);
      for (double& each : z) each = stream.normal();
      Eigen::VectorXd const move = root * z;
      for (int p = 0; p < parameters; ++p) next(p, c) = now(p, c) + move(p);
      uniform.push_back(stream.uniform());
    }
    std::vector<double> const proposed = log_density(next, proposed_likelihood);
    for (int c = 0; c < chains; ++c) {
      auto const lane = static_cast<std::size_t>(c);
      if (!std::isfinite(proposed[lane]) || uniform[lane] >= std::exp(proposed[lane] - density[lane]) + excess) continue;
      for (int p = 0; p < parameters; ++p) now(p, c) = next(p, c);
      density[lane] = proposed[lane];
      likelihood[lane] = proposed_likelihood[lane];
    }
    if (i < burn_in || (i - burn_in) % thin != 0) continue;
    target.constrain(now, declared);
    for (int c = 0; c < chains; ++c) {
      auto const lane = static_cast<std::size_t>(c);
      Chain& chain = result.draws.chains[lane];
      chain.values.emplace_back();
      for (int p = 0; p < parameters; ++p) chain.values.back().push_back(declared(p, c));
      chain.log_prior.push_back(density[lane] - likelihood[lane]);
      chain.log_likelihood.push_back(likelihood[lane]);
      chain.log_density.push_back(density[lane]);
      chain.acceptance.push_back(1);
    }
  }
  return result;
}

template <int percent>
FitResult planted(Target const& target, Settings const&, RunContext& context) {
  return random_walk(target, context, percent / 100.0);
}

std::string refuse_nothing(Settings const&) { return {}; }

template <int percent>
constexpr BackendRow planted_row = {
    "mh", "", {.proper_prior = true}, ObjectiveKind::posterior, {}, &refuse_nothing, &planted<percent>};

}  // namespace

// An ordinary run has each back end on two models and each model by two back ends, and finds draws that are far too narrow or
// beside the truth.
TEST_CASE("ranks of true values by every back end are uniform, on four models") {
  int const count = replications(12, 30);
  std::vector<CalibrationCase> const cases = {drift(), oscillator(), counts(), autoregression()};
  std::vector<char const*> const backends = {"mh(samples = 4000, burn_in = 1000, thin = 4)", "nuts(samples = 800, burn_in = 300)",
                                             "tempering(samples = 2500, burn_in = 500, temperatures = 5)", "auto"};
  for (std::size_t c = 0; c < cases.size(); ++c)
    for (std::size_t b = 0; b < backends.size(); ++b) {
      if (!full_size() && (b + c) % cases.size() > 1) continue;
      CAPTURE(cases[c].name);
      CAPTURE(backends[b]);
      json const summary = calibrated(cases[c], backends[b], count, 11);
      CHECK(uniform(summary));
      CHECK(summary.at("exit") == 0);
      CHECK(summary.at("calibration").at("failed") == 0);
    }
}

// By 5 % in a full run, by 15 % in an ordinary one.
TEST_CASE("a sampler whose acceptance is a little wrong is caught, and the same sampler without the error is not") {
  int const count = replications(50, 150);
  std::string const mh = "mh(samples = 4000, burn_in = 1000, thin = 4)";
  json const right = calibrated(autoregression(), mh, count, 12, &planted_row<0>);
  CHECK(uniform(right));
  json const wrong = calibrated(autoregression(), mh, count, 12, full_size() ? &planted_row<5> : &planted_row<15>);
  CHECK_FALSE(uniform(wrong));
  CHECK(wrong.at("exit") == 1);
}
