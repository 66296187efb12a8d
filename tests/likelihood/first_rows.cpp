// Experiments cut to their first rows.
#include "likelihood/first_rows.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "relative.hpp"

using namespace sysid;

namespace {

/// One channel, an input that counts rows; scored from `from` on.
Experiment counting(int rows, int from) {
  Experiment experiment;
  experiment.name = "bench";
  std::vector<double> input;
  experiment.measured.emplace_back();
  for (int i = 0; i < rows; ++i) {
    experiment.time.push_back(0.1 * i);
    input.push_back(i);
    experiment.measured[0].push_back(2.0 * i);
    experiment.scored.push_back(i >= from ? 1 : 0);
    experiment.corrects.push_back(1);
  }
  experiment.inputs.emplace_back(InputRule::cubic, experiment.time, input);
  return experiment;
}

}  // namespace

TEST_CASE("all experiments are cut to the same share of their scored rows, with what comes before them") {
  std::vector<Experiment> const whole = {counting(1000, 200), counting(400, 0)};
  FirstRows const part = first_rows(whole, 0.1, 10);
  REQUIRE(part.experiments.size() == 2);
  CHECK(part.experiments[0].time.size() == 280);
  CHECK(part.experiments[1].time.size() == 40);
  CHECK(part.share == relative(320.0 / 1400, 1e-12));
  for (Experiment const& each : part.experiments) {
    CHECK(each.measured[0].size() == each.time.size());
    CHECK(each.scored.size() == each.time.size());
    CHECK(each.corrects.size() == each.time.size());
    CHECK(each.inputs[0].rows() == static_cast<int>(each.time.size()));
  }
  // The curve of an input is that of the whole record.
  CHECK(part.experiments[1].inputs[0].rate(38, 1) == whole[1].inputs[0].rate(38, 1));
}

TEST_CASE("no experiment is cut below the least, and a short one stays whole") {
  std::vector<Experiment> const whole = {counting(1000, 0), counting(20, 0)};
  FirstRows const part = first_rows(whole, 0.01, 50);
  CHECK(part.experiments[0].time.size() == 50);
  CHECK(part.experiments[1].time.size() == 20);
  CHECK(first_rows(whole, 1, 1).share == 1);
}

TEST_CASE("rows without a sample do not count") {
  Experiment experiment = counting(100, 0);
  for (std::size_t i = 0; i < 100; ++i)
    if (i % 5 != 0) experiment.measured[0][i] = std::nan("");
  std::vector<Experiment> const whole = {experiment};
  CHECK(most_scored_rows(whole) == 20);
  CHECK(first_rows(whole, 0.5, 1).experiments[0].time.size() == 46);
}
