// What is no change of a parameter: noise, lost rows, a gap in time; and a change while the states settle.
#include <doctest/doctest.h>

#include "made_oscillator.hpp"
#include "tracking/noise_watch.hpp"
#include "tracking/tracking_steps.hpp"

using namespace sysid;

namespace {

struct Followed {
  std::vector<Alarm> alarms;
  std::vector<NoiseAlarm> noises;
  std::vector<Restart> restarts;
  int rows = 0;
  double stiffness = 0, stiffness_sd = 0;
};

/// A tracker that may begin again, of rows that begin at rest.
Tracker tracker_of(TrackedProgram const& program, Experiment const& experiment, bool at_rest, double usual_step = 0) {
  TrackedPrior const prior{Eigen::Vector3d(0, 0, std::log(100.0)), 0.005 * 0.005 * Eigen::Matrix3d::Identity()};
  StatePrior const rest{Eigen::Vector2d::Zero(), Eigen::Matrix2d::Zero(), false};
  StatePrior const anywhere = states_along(program, SolverSettings{}, ExecutionOptions{}, experiment, rest, prior, false);
  TrackingOptions options;
  options.intensities.assign(3, 0.01 * 0.01 / (1000 * 0.03));
  options.scales.assign(3, 1.0);
  options.anywhere = anywhere;
  options.usual_step = usual_step;
  return {program, SolverSettings{}, ExecutionOptions{}, prior, at_rest ? rest : anywhere, options};
}

Followed follow_rows(Tracker& tracker, Experiment const& experiment) {
  Followed all;
  tracker.take(experiment, 0, [&](TrackedRow const& row) {
    ++all.rows;
    if (row.alarm != nullptr) all.alarms.push_back(*row.alarm);
    if (row.noise != nullptr) all.noises.push_back(*row.noise);
    if (row.restart != nullptr) all.restarts.push_back(*row.restart);
    all.stiffness = row.mean[4], all.stiffness_sd = row.sd[4];
  });
  return all;
}

/// Without seven rows from index `from` on; the times show it or are those of rows without a gap.
Experiment without_rows(Experiment const& whole, int from, bool times_show) {
  constexpr int lost = 7;
  Experiment part;
  part.name = whole.name;
  part.measured.emplace_back();
  std::vector<double> x;
  for (int i = 0; i < static_cast<int>(whole.time.size()); ++i) {
    if (i >= from && i < from + lost) continue;
    auto const at = static_cast<std::size_t>(i);
    part.time.push_back(times_show ? whole.time[at] : whole.time[part.time.size()]);
    part.measured[0].push_back(whole.measured[0][at]);
    x.push_back(whole.inputs[0].sample(i));
  }
  part.inputs.emplace_back(InputRule::zero_order, part.time, x);
  part.scored.assign(part.time.size(), 1);
  return part;
}

}  // namespace

TEST_CASE("noise of 3.2 times its sd is a change of the noise, and of no parameter") {
  MadeOscillator made;
  made.rows = 1500;
  Model const model = model_of(oscillator_text);
  TrackedProgram const program = oscillator_program(model, made.sigma);
  Experiment experiment = made.experiment();
  MadeOscillator noisy = made;
  noisy.sigma *= 3.2;
  std::vector<double> const later = noisy.experiment().measured[0];
  std::copy(later.begin() + 500, later.end(), experiment.measured[0].begin() + 500);
  Tracker tracker = tracker_of(program, experiment, true);
  Followed const all = follow_rows(tracker, experiment);
  CHECK(all.rows == made.rows);
  CHECK(all.alarms.empty());
  CHECK(all.restarts.empty());
  REQUIRE(!all.noises.empty());
  CHECK(all.noises.front().row > 500);
  CHECK(all.noises.front().row <= 560);
  CHECK(std::abs(all.noises.front().onset_row - 500) <= 24);
  CHECK(!all.noises.front().correlated);
  CHECK(all.noises.front().ratio > 1.8);
  CHECK(all.noises.back().now > 2.4);
  CHECK(all.noises.back().now < 4.2);
  CHECK(std::abs(all.stiffness - 100) < 4 * all.stiffness_sd);
}

TEST_CASE("rows that are lost without a trace begin the states again, and change no parameter") {
  MadeOscillator made;
  made.rows = 1200;
  Model const model = model_of(oscillator_text);
  TrackedProgram const program = oscillator_program(model, made.sigma);
  Experiment const whole = made.experiment(), experiment = without_rows(whole, 600, false);
  Tracker tracker = tracker_of(program, whole, true);
  Followed const all = follow_rows(tracker, experiment);
  CHECK(all.rows == made.rows - 7);
  CHECK(all.alarms.empty());
  REQUIRE(all.restarts.size() == 1);
  CHECK(all.restarts[0].cause == Restart::Cause::jump);
  CHECK(all.restarts[0].row > 600);
  CHECK(all.restarts[0].row <= 640);
  CHECK(std::abs(all.stiffness - 100) < 4 * all.stiffness_sd);
}

TEST_CASE("behind a gap in time the states begin again, at that row and however the rows come") {
  MadeOscillator made;
  made.rows = 1200;
  Model const model = model_of(oscillator_text);
  TrackedProgram const program = oscillator_program(model, made.sigma);
  Experiment const whole = made.experiment(), experiment = without_rows(whole, 600, true);
  Tracker tracker = tracker_of(program, whole, true, made.step);
  Followed const all = follow_rows(tracker, experiment);
  CHECK(all.alarms.empty());
  REQUIRE(all.restarts.size() == 1);
  CHECK(all.restarts[0].cause == Restart::Cause::gap);
  CHECK(all.restarts[0].row == experiment.first_row + 600);
  CHECK(all.restarts[0].step == doctest::Approx(8 * made.step));
  CHECK(std::abs(all.stiffness - 100) < 4 * all.stiffness_sd);
  Tracker by_pieces = tracker_of(program, whole, true, made.step);
  std::vector<Restart> restarts;
  double last = 0;
  int const rows = static_cast<int>(experiment.time.size());
  auto const sink = [&](TrackedRow const& row) {
    if (row.restart != nullptr) restarts.push_back(*row.restart);
    last = row.mean[4];
  };
  by_pieces.take(slice(experiment, 0, 600, 0), 0, sink);
  for (int from = 600, size = 1; from < rows; from += size, size = size % 97 + 3)
    by_pieces.take(slice(experiment, from - 1, std::min(rows, from + size), 1), 1, sink);
  REQUIRE(restarts.size() == 1);
  CHECK(restarts[0].row == all.restarts[0].row);
  CHECK(last == all.stiffness);
}

TEST_CASE("a change while the states settle is found behind these rows, and called what it is") {
  MadeOscillator made;
  made.rows = 1200;
  made.change_after = 520;
  Model const model = model_of(oscillator_text);
  TrackedProgram const program = oscillator_program(model, made.sigma);
  Experiment const whole = made.experiment();
  Tracker tracker = tracker_of(program, whole, false);
  Followed const all = follow_rows(tracker, slice(whole, 500, made.rows, 0));
  REQUIRE(!all.alarms.empty());
  CHECK(all.alarms.front().row > 550);
  CHECK(all.alarms.front().parameter == 2);
  CHECK(all.alarms.front().after < 95);
  CHECK(all.alarms.front().after > 80);
  CHECK(all.stiffness == doctest::Approx(90).epsilon(0.03));
}

TEST_CASE("rows that are lost soon after a change begin again with the parameters as they are since then") {
  MadeOscillator made;
  made.rows = 1200;
  made.change_after = 500;
  Model const model = model_of(oscillator_text);
  TrackedProgram const program = oscillator_program(model, made.sigma);
  Experiment const whole = made.experiment();
  Tracker without_loss = tracker_of(program, whole, true);
  Followed const before = follow_rows(without_loss, slice(whole, 0, 800, 0));
  REQUIRE(before.alarms.size() == 1);
  int const lost_at = static_cast<int>(before.alarms[0].row - whole.first_row) + 20;
  Tracker tracker = tracker_of(program, whole, true);
  Followed const all = follow_rows(tracker, without_rows(whole, lost_at, false));
  REQUIRE(all.restarts.size() == 1);
  CHECK(all.restarts[0].cause == Restart::Cause::jump);
  CHECK(all.restarts[0].row <= lost_at + 40);
  CHECK(all.alarms.size() == 1);
  CHECK(std::abs(all.stiffness - 90) < 4 * all.stiffness_sd);
}

TEST_CASE("where the filter has no finite values the states begin again at that row") {
  MadeOscillator made;
  made.rows = 900;
  Model const model = model_of(oscillator_text);
  TrackedProgram const program = oscillator_program(model, made.sigma);
  Experiment const whole = made.experiment();
  Experiment experiment = whole;
  std::vector<double> x;
  for (int i = 0; i < made.rows; ++i) x.push_back(i == 600 ? 1e308 : whole.inputs[0].sample(i));
  experiment.inputs.clear();
  experiment.inputs.emplace_back(InputRule::zero_order, experiment.time, x);
  Tracker tracker = tracker_of(program, whole, true);
  Followed const all = follow_rows(tracker, experiment);
  CHECK(all.rows == made.rows);
  CHECK(all.alarms.empty());
  REQUIRE(all.restarts.size() == 1);
  CHECK(all.restarts[0].cause == Restart::Cause::divergence);
  CHECK(all.restarts[0].row == experiment.first_row + 601);
  CHECK(std::abs(all.stiffness - 100) < 4 * all.stiffness_sd);
}

TEST_CASE("single samples that are far off are no noise, and no lost states") {
  FarOffRun run;
  for (int i = 0; i < 40; ++i) {
    run.add(i % 13 == 0 ? 100 : 0.5);
    CHECK(!run.is_smooth());
  }
  FarOffRun lost;
  for (int i = 0; i < 12; ++i) lost.add(30 * std::cos(0.3 * i));
  CHECK(lost.is_smooth());
  // Of 16 values without an order the correlation has an sd of 1/4.
  Stream stream(StreamKey{3, Purpose::test, 2, 0});
  int smooth = 0;
  for (int i = 0; i < 1000; ++i) {
    FarOffRun noise;
    for (int k = 0; k < 16; ++k) noise.add(20 * stream.normal());
    smooth += noise.is_smooth();
  }
  CHECK(smooth < 50);
  NoiseWatch watch(1, 1e-5, 2048);
  for (int i = 1; i <= 64; ++i) {
    watch.keep(i - 1);
    watch.observe(0, i % 30 == 0 ? 100 : (i % 2 == 0 ? 1 : -1) * (i % 4 < 2 ? 0.9 : 1.1), 0);
  }
  CHECK(!watch.detect(0));
}

TEST_CASE("a change of the noise goes before one of a parameter only where it explains more") {
  Stream stream(StreamKey{3, Purpose::test, 1, 0});
  NoiseWatch watch(2, 1e-5, 2048);
  for (int i = 0; i < 400; ++i) {
    watch.keep(i);
    watch.observe(0, stream.normal(), 0.2);
    watch.observe(1, (i < 200 ? 1 : 2) * stream.normal(), 0.2);
  }
  auto const change = watch.detect(0);
  REQUIRE(change);
  CHECK(change->channel == 1);
  CHECK(std::abs(change->row - 200) <= 24);
  // The variance is 4 times what is expected, of which 0.8 is noise: (4 - 0.2)/0.8.
  CHECK(change->factor == doctest::Approx(4.75).epsilon(0.35));
  CHECK(!change->correlated);
  CHECK(!watch.detect(2 * change->statistic));
}

TEST_CASE("a channel whose innovations are related hides no louder noise of another") {
  Stream stream(StreamKey{3, Purpose::test, 3, 0});
  NoiseWatch watch(2, 1e-5, 2048);
  for (int i = 0; i < 48; ++i) {
    watch.keep(i);
    watch.observe(0, 3.9 * std::cos(0.1 * i), 0);
    watch.observe(1, 2.5 * stream.normal(), 0);
  }
  auto const change = watch.detect(0);
  REQUIRE(change);
  CHECK(change->channel == 1);
  CHECK(!change->correlated);
}

TEST_CASE("a change of the noise that is too small to matter hides no larger one of another channel") {
  Stream stream(StreamKey{3, Purpose::test, 4, 0});
  NoiseWatch watch(2, 1e-5, 2048);
  for (int i = 0; i < 2000; ++i) {
    watch.keep(i);
    watch.observe(0, 1.15 * stream.normal(), 0);
    watch.observe(1, (i < 1950 ? 1 : 2) * stream.normal(), 0);
  }
  auto const change = watch.detect(0);
  REQUIRE(change);
  CHECK(change->channel == 1);
}
