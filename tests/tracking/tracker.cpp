// Tracking against closed forms, and against itself however the rows come.
#include "tracking/tracker.hpp"

#include <doctest/doctest.h>

#include "linear_algebra/decompositions.hpp"
#include "made_oscillator.hpp"
#include "relative.hpp"
#include "tracking/tracking_steps.hpp"

using namespace sysid;

namespace {

struct Estimates {
  std::vector<std::vector<double>> mean, sd;
  std::vector<double> innovation, expected;
  std::vector<Alarm> alarms;
};

void keep(Estimates& all, TrackedRow const& row) {
  all.mean.push_back(row.mean);
  all.sd.push_back(row.sd);
  all.innovation.push_back(row.innovation.front());
  all.expected.push_back(row.expected.front());
  if (row.alarm != nullptr) all.alarms.push_back(*row.alarm);
}

Estimates tracked_along(Tracker& tracker, Experiment const& experiment) {
  Estimates all;
  tracker.take(experiment, 0, [&](TrackedRow const& row) { keep(all, row); });
  return all;
}

}  // namespace

TEST_CASE("without drift, the parameters of a regression are those of Bayes' rule") {
  Model const model = model_of(R"(
model line {
  input x
  parameter a ~ normal(0, sd = 10)
  parameter b ~ normal(0, sd = 10)
  observe y ~ normal(a + b*x, sd = 0.3)
}
)");
  std::vector<TrackedParameter> const tracked = {{0, {}, {}, false}, {1, {}, {}, false}};
  TrackedProgram const program = compile_tracking(model, std::vector{0.0, 0.0}, tracked, "rk4", MomentRule::linearised);
  TrackedPrior prior{Eigen::Vector2d(0.5, -1), Eigen::Matrix2d{{4, 1}, {1, 2}}};
  TrackingOptions options;
  options.intensities = {0, 0};
  options.scales = {1, 1};
  Experiment experiment;
  std::vector<double> x;
  experiment.measured.emplace_back();
  Eigen::Matrix2d precision = inverse(prior.covariance);
  Eigen::Vector2d weighted = precision * prior.mean;
  for (int i = 0; i < 50; ++i) {
    experiment.time.push_back(i + 1);
    x.push_back(std::sin(1.3 * i));
    double const y = i == 20 ? std::nan("") : 1 + 2 * x.back() + 0.3 * std::cos(7.0 * i);
    experiment.measured[0].push_back(y);
    if (std::isnan(y)) continue;
    Eigen::Vector2d const row(1, x.back());
    precision += row * row.transpose() / 0.09;
    weighted += row * y / 0.09;
  }
  experiment.inputs.emplace_back(InputRule::zero_order, experiment.time, x);
  experiment.scored.assign(50, 1);
  Tracker tracker(program, SolverSettings{}, ExecutionOptions{}, prior, {Eigen::VectorXd(0), Eigen::MatrixXd(0, 0), false},
                  options);
  Estimates const all = tracked_along(tracker, experiment);
  Eigen::Matrix2d const covariance = inverse(precision);
  Eigen::Vector2d const mean = covariance * weighted;
  for (std::size_t j = 0; j < 2; ++j) {
    auto const at = static_cast<Eigen::Index>(j);
    CHECK(all.mean.back()[j] == doctest::Approx(mean(at)).epsilon(1e-10));
    CHECK(all.sd.back()[j] == relative(std::sqrt(covariance(at, at)), 1e-10));
  }
  CHECK(std::isnan(all.innovation[20]));
  CHECK(all.mean[20] == all.mean[19]);
}

TEST_CASE("however rows are gathered, the estimates are the same") {
  MadeOscillator made;
  made.rows = 2500;
  made.change_after = 900;
  Model const model = model_of(oscillator_text);
  TrackedProgram const program = oscillator_program(model, made.sigma);
  Experiment const experiment = made.experiment();
  Tracker at_once = oscillator_tracker(program, made);
  Estimates const whole = tracked_along(at_once, experiment);
  REQUIRE(whole.mean.size() == 2500);
  Tracker by_pieces = oscillator_tracker(program, made);
  Estimates pieces;
  auto const sink = [&](TrackedRow const& row) { keep(pieces, row); };
  by_pieces.take(slice(experiment, 0, 2, 0), 0, sink);
  for (int from = 2, size = 1; from < made.rows; from += size, size = size % 97 + 3)
    by_pieces.take(slice(experiment, from - 1, std::min(made.rows, from + size), 1), 1, sink);
  REQUIRE(pieces.mean.size() == 2500);
  CHECK(pieces.mean.back() == whole.mean.back());
  CHECK(pieces.sd.back() == whole.sd.back());
  REQUIRE(pieces.alarms.size() == whole.alarms.size());
  REQUIRE(!whole.alarms.empty());
  CHECK(pieces.alarms.front().row == whole.alarms.front().row);
  CHECK(pieces.alarms.front().onset_row == whole.alarms.front().onset_row);
}

TEST_CASE("rows of a record without an end are numbered on beyond 32 bits") {
  MadeOscillator made;
  made.rows = 2500;
  made.change_after = 900;
  Model const model = model_of(oscillator_text);
  TrackedProgram const program = oscillator_program(model, made.sigma);
  Experiment const experiment = made.experiment();
  Tracker near = oscillator_tracker(program, made), far = oscillator_tracker(program, made);
  Estimates const whole = tracked_along(near, experiment);
  std::int64_t const before = 3'000'000'000;
  Estimates later;
  std::int64_t last = 0;
  far.take(
      experiment, 0,
      [&](TrackedRow const& row) {
        keep(later, row);
        last = row.row;
      },
      before);
  CHECK(last == before + experiment.first_row + made.rows - 1);
  CHECK(later.mean == whole.mean);
  REQUIRE(!whole.alarms.empty());
  REQUIRE(later.alarms.size() == whole.alarms.size());
  CHECK(later.alarms.front().row == before + whole.alarms.front().row);
  CHECK(later.alarms.front().onset_row == before + whole.alarms.front().onset_row);
}

TEST_CASE("a tenth less stiffness is found and followed, and the alarm says what was and what is") {
  for (MomentRule const rule : {MomentRule::linearised, MomentRule::sigma_points}) {
    MadeOscillator made;
    made.rows = 3000;
    made.change_after = 1500;
    Model const model = model_of(oscillator_text);
    Tracker tracker = oscillator_tracker(oscillator_program(model, made.sigma, rule), made);
    Estimates const all = tracked_along(tracker, made.experiment());
    REQUIRE(all.alarms.size() >= 1);
    Alarm const& alarm = all.alarms.front();
    CHECK(alarm.parameter == 2);
    CHECK(alarm.row > 1500);
    CHECK(alarm.row <= 1700);
    CHECK(std::abs(alarm.onset_row - 1500) <= 40);
    CHECK(std::abs(alarm.before - 100) < 4 * alarm.before_sd);
    CHECK(std::abs(alarm.after - 90) < 4 * alarm.after_sd);
    CHECK(alarm.after_sd < 6);
    CHECK(all.mean.back()[4] == doctest::Approx(90).epsilon(0.02));
    CHECK(std::abs(all.mean.back()[4] - 90) < 4 * all.sd.back()[4]);
  }
}

TEST_CASE("rows of an unknown beginning tell of the states and leave the parameters") {
  MadeOscillator made;
  made.rows = 1500;
  Model const model = model_of(oscillator_text);
  TrackedProgram const program = oscillator_program(model, made.sigma);
  Experiment const whole = made.experiment();
  TrackedPrior const prior{Eigen::Vector3d(0, 0, std::log(100.0)), 0.005 * 0.005 * Eigen::Matrix3d::Identity()};
  StatePrior const rest{Eigen::Vector2d::Zero(), Eigen::Matrix2d::Zero(), false};
  StatePrior const anywhere = states_along(program, SolverSettings{}, ExecutionOptions{}, whole, rest, prior, false);
  CHECK(anywhere.settles);
  CHECK(std::sqrt(anywhere.covariance(0, 0)) == relative(0.22, 0.3));
  TrackingOptions options;
  options.intensities.assign(3, 1e-10);
  options.scales.assign(3, 1.0);
  Tracker tracker(program, SolverSettings{}, ExecutionOptions{}, prior, anywhere, options);
  Estimates all;
  Experiment const later = slice(whole, 700, 1500, 0);
  double squared = 0;
  int count = 0;
  tracker.take(later, 0, [&](TrackedRow const& row) {
    if (!row.settling) squared += row.squared, ++count;
    if (count == 1) {
      CHECK(row.mean[4] == doctest::Approx(100).epsilon(0.002));
      CHECK(row.sd[4] == doctest::Approx(0.5).epsilon(0.05));
      CHECK(row.sd[0] < made.sigma);
    }
    keep(all, row);
  });
  CHECK(count == 750);
  CHECK(squared / count == doctest::Approx(1).epsilon(0.2));
  CHECK(all.alarms.empty());
}

TEST_CASE("the threshold keeps to the union bound") {
  ChangeDetector const detector(2, 3, 1e-5, 2048);
  int const pairs = 3 * most_candidates(2048);
  CHECK(pairs == 87);
  CHECK(pairs * std::erfc(detector.threshold() / std::sqrt(2.0)) == relative(1e-5, 1e-6));
}
