// Draws: a normal with the covariance of the tutorial's posterior, AR(1) along each chain. Response: the oscillator itself, by RK4.
#include "report/example.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numeric/random.hpp"
#include "diagnostics/convergence.hpp"
#include "diagnostics/scores.hpp"
#include "typeset/typeset.hpp"

namespace sysid::example {

namespace {

constexpr int samples = 500;
constexpr double step = 1e-3;

std::vector<double> force() {
  Stream stream({1, Purpose::test, 0, 0});
  std::vector<double> out;
  for (int i = 0; i < samples; ++i) out.push_back(10 * stream.normal());
  return out;
}

/// Displacement in mm and velocity in m/s under a held force.
std::pair<std::vector<double>, std::vector<double>> simulate(std::vector<double> const& p, std::vector<double> const& x) {
  double y = 0, v = 0;
  std::pair<std::vector<double>, std::vector<double>> out;
  auto const acceleration = [&](double yy, double vv, double f) {
    return (f - p[1] * vv - p[2] * yy - p[3] * yy * yy * yy) / p[0];
  };
  for (double const f : x) {
    out.first.push_back(1000 * y);
    out.second.push_back(v);
    double const a1 = acceleration(y, v, f), v2 = v + step / 2 * a1;
    double const a2 = acceleration(y + step / 2 * v, v2, f), v3 = v + step / 2 * a2;
    double const a3 = acceleration(y + step / 2 * v2, v3, f), v4 = v + step * a3;
    double const a4 = acceleration(y + step * v3, v4, f);
    y += step / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += step / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  return out;
}

std::vector<std::vector<double>> noisy(std::vector<std::vector<double>> trajectories, double sd, std::uint64_t seed) {
  for (std::size_t d = 0; d < trajectories.size(); ++d) {
    Stream stream({seed, Purpose::noise, d, 0});
    for (double& value : trajectories[d]) value += sd * stream.normal();
  }
  return trajectories;
}

}  // namespace

Report duffing(int draws) {
  std::vector<double> const truth = {1, 20, 1e4, 5e9, 2.5e11};
  std::vector<double> const sd = {6.3e-4, 0.0175, 10, 3.3e7, 1.6e10};
  Report report;
  report.version = "0.1.0";
  report.task = "posterior";
  report.what = "fit duffing to bench.train with mh";
  report.verb = "fit";
  report.model_name = "duffing";
  report.model_title = "Duffing's oscillator";
  report.equations = {"m*y'' + c*y' + k*y + k3*y^3 = x", "displacement ~ normal(y, precision = beta)"};
  report.formulas = formulas(report.equations);
  report.model_text = "model duffing \"Duffing's oscillator\" {\n  m*y'' + c*y' + k*y + k3*y^3 = x   # <as printed>\n}\n";
  report.resolved_text = report.model_text + "posterior = fit duffing to bench.train with mh(samples = 25000)\n";
  report.resolved_files = {{"resolved.sysid", report.resolved_text}};
  report.seed = 1;
  report.draws.names = {"m", "c", "k", "k3", "beta"};
  report.draws.units = {"kg", "N s/m", "N/m", "N/m^3", "1/m^2"};
  report.draws.parameter_count = 5;
  double const bounds[][2] = {{0.1, 10}, {2, 200}, {1e3, 1e5}, {5e8, 5e10}, {1e8, 1e12}};
  for (std::size_t i = 0; i < 5; ++i)
    report.priors.push_back(
        {report.draws.names[i], report.draws.units[i], "log_uniform(...)",
         [low = bounds[i][0], high = bounds[i][1]](double v) { return v < low || v > high ? 0 : 1 / (v * std::log(high / low)); }});
  for (std::uint64_t c = 0; c < 4; ++c) {
    Chain chain;
    std::vector<double> z(5, 0);
    for (int d = 0; d < draws; ++d) {
      Stream stream({7, Purpose::test, c, static_cast<std::uint64_t>(d)});
      for (double& each : z) each = 0.6 * each + 0.8 * stream.normal();
      // m and k go together, k and k3 against each other.
      std::vector<double> const w = {0.7 * z[0] + 0.714 * z[2], z[1], z[2], -0.55 * z[2] + 0.835 * z[3], z[4]};
      chain.values.emplace_back();
      for (std::size_t i = 0; i < 5; ++i) chain.values.back().push_back(truth[i] + sd[i] * w[i]);
      chain.log_prior.push_back(-40.5);
      chain.log_likelihood.push_back(4000 - 0.5 * z[0] * z[0]);
      chain.log_density.push_back(3960 - 0.5 * z[0] * z[0]);
      chain.acceptance.push_back(stream.uniform());
    }
    report.draws.chains.push_back(std::move(chain));
  }
  for (std::size_t i = 0; i < 5; ++i) {
    ChainValues values;
    for (Chain const& chain : report.draws.chains) {
      values.emplace_back();
      for (auto const& row : chain.values) values.back().push_back(row[i]);
    }
    report.summary.push_back(summarise(report.draws.names[i], report.draws.units[i], values));
  }

  std::vector<double> const x = force();
  std::vector<std::vector<double>> displacement, velocity;
  for (int d = 0; d < std::min(draws, 100); ++d) {
    // Twelve times the spread of the draws, so that the bands can be seen.
    std::vector<double> wide = report.draws.chains[static_cast<std::size_t>(d % 4)].values[static_cast<std::size_t>(d)];
    for (std::size_t i = 0; i < 4; ++i) wide[i] = truth[i] + 12 * (wide[i] - truth[i]);
    auto [y, v] = simulate(wide, x);
    displacement.push_back(std::move(y));
    velocity.push_back(std::move(v));
  }
  double const noise = 0.02;
  Prediction fit;
  fit.experiment = "bench.train";
  for (int i = 0; i < samples; ++i) fit.time.push_back(i * step);
  fit.scored.assign(samples, 1);
  std::vector<double> const measured = noisy({simulate(truth, x).first}, noise, 3)[0];
  fit.quantities.push_back({"displacement", "mm", band(displacement), band(noisy(displacement, noise, 2)), measured});
  fit.quantities.push_back({"y'", "m/s", band(velocity), {}, {}});
  report.predictions.push_back(std::move(fit));

  report.data.push_back(
      {"bench.train",
       "duffing.csv",
       "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08",
       1500,
       500,
       "1..500",
       "5994471abb01112afcc18159f6cc74b4f511b99806da59b3caf5a9c173cacfc5",
       "2c26b46b68ffc68ff99b453c1d30413413422d706483bfa0f98a5e886266e7ae",
       {"rows 1..500 of 1500", "input x = force [N], held between samples (zero_order)", "measure displacement = y_noisy [mm]"}});
  report.findings.push_back(
      {FindingCode::selection_ended, Severity::note, {}, "no posterior mean moves by more than 0.01 sd at half the step", ""});
  report.fit = {{"bench.train", "displacement", "mm", {{{ScoreKind::nmse}, 0.0104}, {{ScoreKind::chi_squared}, 1.01}}}};
  Mode mode;
  mode.declared = truth;
  mode.sd = sd;
  mode.log_density = 3960.2;
  mode.log_mass = 3921.7;
  mode.share = 0.9993;
  report.modes.push_back(mode);
  report.sampled_names = report.draws.names;
  report.ledger.add_solves(100000);
  report.ledger.add_failure(FailureClass::non_finite, "k3*y^3 at duffing.sysid:12", 0.0125, truth, 3);
  report.settings = {{"samples", std::int64_t{25000}}, {"burn_in", std::int64_t{5000}},       {"thin", std::int64_t{10}},
                     {"chains", std::int64_t{4}},      {"proposal", std::string("adaptive")}, {"target", 0.234}};
  report.versions = {{"sysid", std::string("0.1.0")}, {"random", std::string("Philox 4x64, Random123")}};
  report.timing = {{"wall_s", 1.25}, {"threads", std::int64_t{2}}};
  return report;
}

}  // namespace sysid::example
