// Alarms of tracking: how many are false in rows without a change, and how soon a tenth less stiffness is found.
#include <doctest/doctest.h>

#include "../tracking/made_oscillator.hpp"
#include "core/numeric/statistics.hpp"

using namespace sysid;

namespace {

/// With parameters as a fit knows them: the truth is a draw from what is believed.
MadeOscillator drawn(std::uint64_t seed) {
  Stream stream(StreamKey{seed, Purpose::test, 3, 0});
  MadeOscillator made;
  made.seed = seed;
  made.m *= std::exp(0.005 * stream.normal());
  made.c *= std::exp(0.005 * stream.normal());
  made.k *= std::exp(0.005 * stream.normal());
  return made;
}

}  // namespace

TEST_CASE("in 400,000 rows without a change there are at most four alarms, and innovations are of the size expected") {
  Model const model = model_of(oscillator_text);
  MadeOscillator const believed;
  TrackedProgram const program = oscillator_program(model, believed.sigma);
  for (double const drift : {0.0, 0.01}) {
    int alarms = 0, rows = 0;
    double squared = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      MadeOscillator made = drawn(seed);
      made.rows = 10000;
      Tracker tracker = oscillator_tracker(program, believed, drift);
      tracker.take(made.experiment(), 0, [&](TrackedRow const& row) {
        alarms += row.alarm != nullptr;
        squared += row.squared;
        ++rows;
      });
    }
    MESSAGE("drift ", drift, ": ", alarms, " alarms in ", rows, " rows; mean squared innovation ", squared / rows);
    CHECK(rows == 200000);
    CHECK(alarms <= 2);
    CHECK(squared / rows == doctest::Approx(1).epsilon(0.02));
  }
}

TEST_CASE("a tenth less stiffness is found within 200 rows in each of 50 records, and is called what it is") {
  Model const model = model_of(oscillator_text);
  MadeOscillator const believed;
  TrackedProgram const program = oscillator_program(model, believed.sigma);
  int found = 0, named = 0, before = 0, inside = 0;
  std::vector<double> delays, onsets, z;
  for (std::uint64_t seed = 1001; seed <= 1050; ++seed) {
    MadeOscillator made = drawn(seed);
    made.rows = 3200;
    made.change_after = 2000 + static_cast<int>(seed % 50) * 7;
    Tracker tracker = oscillator_tracker(program, believed);
    std::optional<Alarm> first;
    double last = 0, last_sd = 0;
    tracker.take(made.experiment(), 0, [&](TrackedRow const& row) {
      if (row.alarm != nullptr && row.row <= made.change_after) ++before;
      if (row.alarm != nullptr && row.row > made.change_after && !first) first = *row.alarm;
      last = row.mean[4], last_sd = row.sd[4];
    });
    if (!first) continue;
    delays.push_back(first->row - made.change_after);
    onsets.push_back(std::abs(first->onset_row - made.change_after));
    found += delays.back() <= 200;
    named += first->parameter == 2;
    if (first->parameter == 2) z.push_back((first->after - 0.9 * made.k) / first->after_sd);
    inside += std::abs(last - 0.9 * made.k) < 1.96 * last_sd;
  }
  REQUIRE(delays.size() == 50);
  MESSAGE("found within 200 rows: ", found, " of 50, median delay ", median(delays), ", largest ",
          *std::max_element(delays.begin(), delays.end()), "; the stiffness named: ", named, "; onset off by ", median(onsets),
          "; z of the value stated, rms ", std::sqrt(squared_deviations(z, 0) / static_cast<double>(z.size())),
          "; at the end inside 95 %: ", inside);
  CHECK(found == 50);
  CHECK(named >= 46);
  CHECK(before == 0);
  CHECK(std::sqrt(squared_deviations(z, 0) / static_cast<double>(z.size())) < 1.5);
  CHECK(inside >= 43);
}
