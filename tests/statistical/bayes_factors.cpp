// Log Bayes factors of fits of the 5 % Duffing record, against evidences by another method: stepping stones from a normal
// distribution at the mode to the posterior.                                                     Fan, Wu, Chen, Kuo and Lewis 2011
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "core/numeric/random.hpp"
#include "core/numeric/statistics.hpp"
#include "experiment/experiments.hpp"
#include "fits.hpp"
#include "inference/evidence/component.hpp"
#include "likelihood/model_target.hpp"
#include "load/load.hpp"
#include "replications.hpp"
#include "search/global/search.hpp"
#include "search/laplace.hpp"

using namespace sysid;

namespace {

struct LogEvidence {
  double value, error;
};

/// The posterior of a fit over the coordinates of the sampler.
std::unique_ptr<ModelTarget> target_of(CheckedFile const& file, std::string const& task) {
  auto const& found = *std::ranges::find(file.tasks, task, &Task::name);
  auto const& fit = std::get<FitTask>(found.what);
  Model const& model = file.models[static_cast<std::size_t>(fit.model)];
  std::vector<Experiment> experiments;
  for (ExperimentUse const& use : fit.experiments) {
    DataBlock const& block = file.data[static_cast<std::size_t>(use.data)];
    experiments.push_back(cut(load_record(block, model, std::filesystem::path(SYSID_SOURCE_DIR) / "models/duffing"), block, model,
                              use.part, fit.start));
  }
  TargetOptions options;
  options.solver = fit.solver;
  return std::make_unique<ModelTarget>(compile(model, false, fit.solver.method), parameter_space(model, fit.experiments),
                                       std::move(experiments), options);
}

/// Random walks in as many chains as lanes, at each power of the way from the normal distribution to the posterior.
class SteppingStones {
 public:
  static constexpr int stones = 12, chains = 64;

  SteppingStones(Target const& target, Mode const& mode, int steps)
      : target_(target), start_(theta_of(mode), 1.7 * covariance_of(mode)), steps_(steps), theta_(target.dimension(), chains) {
    for (int c = 0; c < chains; ++c) {
      Stream stream({1, Purpose::test, static_cast<std::uint64_t>(c), 0});
      Eigen::VectorXd const u = start_.centre + start_.move(stream, false);
      for (int p = 0; p < theta_.rows(); ++p) theta_(p, c) = u(p);
    }
    log_ratio_ = log_ratios(theta_, log_start_);
  }

  LogEvidence log_evidence() {
    double value = 0, variance = 0;
    for (int stone = 0; stone < stones; ++stone) {
      double const power = static_cast<double>(stone) / stones, step = 1.0 / stones;
      std::vector<double> means(chains, 0);  // of exp(step log_ratio), over the largest
      double const offset = step * *std::ranges::max_element(log_ratio_);
      int const settling = steps_ / 4;
      for (int i = 0; i < steps_; ++i) {
        move(power, static_cast<std::uint64_t>(1 + stone * steps_ + i));
        if (i < settling) continue;
        for (std::size_t c = 0; c < chains; ++c) means[c] += std::exp(step * log_ratio_[c] - offset) / (steps_ - settling);
      }
      double const all = mean(means);
      value += offset + std::log(all);
      variance += sample_variance(means) / chains / (all * all);
    }
    return {value, std::sqrt(variance)};
  }

 private:
  /// log of posterior over start, and the start's.
  std::vector<double> log_ratios(ConstLanes theta, std::vector<double>& log_start) const {
    std::vector<double> prior(chains), likelihood(chains);
    Ledger ledger;
    target_.log_prior(theta, prior);
    target_.log_likelihood(theta, likelihood, ledger);
    log_start.assign(chains, 0);
    for (int c = 0; c < chains; ++c) {
      auto const at = static_cast<std::size_t>(c);
      Eigen::VectorXd u(theta.rows());
      for (int p = 0; p < theta.rows(); ++p) u(p) = theta(p, c);
      log_start[at] = start_.log_density(u).normal;
      prior[at] += likelihood[at] - log_start[at];
    }
    return prior;
  }

  void move(double power, std::uint64_t step) {
    LaneArray to(theta_.rows(), chains);
    std::vector<double> chance;
    for (int c = 0; c < chains; ++c) {
      Stream stream({1, Purpose::test, static_cast<std::uint64_t>(c), step});
      Eigen::VectorXd z(theta_.rows());
      for (double& each : z) each = stream.normal();
      Eigen::VectorXd const by = 1.7 / std::sqrt(theta_.rows()) * (start_.root * z);
      for (int p = 0; p < theta_.rows(); ++p) to(p, c) = theta_(p, c) + by(p);
      chance.push_back(std::log(stream.uniform()));
    }
    std::vector<double> log_start;
    std::vector<double> const ratio = log_ratios(to, log_start);
    for (int c = 0; c < chains; ++c) {
      auto const at = static_cast<std::size_t>(c);
      double const gain = log_start[at] - log_start_[at] + power * (ratio[at] - log_ratio_[at]);
      if (!std::isfinite(ratio[at]) || !(chance[at] < gain)) continue;
      for (int p = 0; p < theta_.rows(); ++p) theta_(p, c) = to(p, c);
      log_start_[at] = log_start[at];
      log_ratio_[at] = ratio[at];
    }
  }

  Target const& target_;
  Component start_;
  int steps_;
  LaneArray theta_;
  std::vector<double> log_start_, log_ratio_;  // log_ratio_: log p - log start
};

std::string const competitors = R"(
model linear {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter m [kg] ~ log_uniform(0.1, 10)
  parameter c [N s/m] ~ log_uniform(2, 200)
  parameter k [N/m] ~ log_uniform(1e3, 1e5)
  parameter beta [1/m^2] ~ log_uniform(1e8, 1e13)
  m*y'' + c*y' + k*y = x
  observe displacement ~ normal(y, precision = beta)
}
model quadratic {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter m [kg] ~ log_uniform(0.1, 10)
  parameter c [N s/m] ~ log_uniform(2, 200)
  parameter k [N/m] ~ log_uniform(1e3, 1e5)
  parameter k2 [N/m^2] ~ normal(0, sd = 1e7)
  parameter k3 [N/m^3] ~ log_uniform(5e8, 5e10)
  parameter beta [1/m^2] ~ log_uniform(1e8, 1e13)
  m*y'' + c*y' + k*y + k2*y^2 + k3*y^3 = x
  observe displacement ~ normal(y, precision = beta)
}
without_cubic = fit linear to bench.train with mh(samples = 25000, burn_in = 5000, thin = 10, chains = 4), seed = 1
with_quadratic = fit quadratic to bench.train with mh(samples = 25000, burn_in = 5000, thin = 10, chains = 4), seed = 1
)";

}  // namespace

// A full run takes walks twenty times as long.
TEST_CASE("log Bayes factors of the 5 % Duffing record equal those by stepping stones within 0.2, and within their errors") {
  int const steps = 100 * replications(1, 20);
  auto const folder = std::filesystem::path(SYSID_SOURCE_DIR) / "models/duffing";
  std::string text = read_file(folder / "duffing_5pct.sysid");
  for (char const* each : {"truth = ", "forecast = ", "redrawn  = "}) text = with(text, each, "# " + std::string(each));
  text = with(text, "    noise = 5 [percent], samples", "#    noise = 5 [percent], samples") + competitors;
  Fitted const fitted = run_file(text, {}, {{"duffing_5pct.csv", read_file(folder / "duffing_5pct.csv")}});
  CAPTURE(fitted.notices);
  REQUIRE(fitted.summary.size() == 3);
  Source source("case.sysid", text);
  Diagnostics diagnostics;
  auto const file = load(source, diagnostics);
  REQUIRE(file);
  std::map<std::string, LogEvidence> stated, reference;
  for (char const* task : {"posterior", "without_cubic", "with_quadratic"}) {
    auto const& evidence = fitted.summary.at(task).at("evidence");
    CHECK_FALSE(evidence.contains("not_confirmed"));
    stated[task] = {evidence.at("log_evidence"), evidence.at("standard_error")};
    auto const target = target_of(*file, task);
    SilentProgress progress;
    Ledger ledger;
    RunContext context{.seed = 1, .progress = progress, .ledger = ledger};
    SearchResult const found = search(*target, ObjectiveKind::posterior, context);
    REQUIRE(!found.modes.empty());
    reference[task] = SteppingStones(*target, found.modes.front(), steps).log_evidence();
    MESSAGE(task, ": ", stated[task].value, " ± ", stated[task].error, ", by stepping stones ", reference[task].value, " ± ",
            reference[task].error);
  }
  for (char const* other : {"without_cubic", "with_quadratic"}) {
    double const by_fits = stated[other].value - stated["posterior"].value;
    double const by_stones = reference[other].value - reference["posterior"].value;
    double error = 0;
    for (auto const* each : {&stated, &reference})
      for (std::string const& task : {std::string("posterior"), std::string(other)})
        error = std::hypot(error, each->at(task).error);
    CAPTURE(other);
    CHECK(error < 0.1);
    CHECK(std::fabs(by_fits - by_stones) < 0.2);
    CHECK(std::fabs(by_fits - by_stones) < 3 * error);
  }
  CHECK(stated["without_cubic"].value < stated["posterior"].value - 100);
}
