// Along which rows a look ahead is made: sensors that are switched on late, and such as have few samples.
#include "app/preflight/rows_ahead.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using namespace sysid;

namespace {

/// A channel with a sample at every `step`-th row from `from` on.
struct Sensor {
  int from, step = 1;
};

int ahead(int rows, std::vector<Sensor> const& sensors, int scored_from = 0) {
  Experiment experiment;
  for (int i = 0; i < rows; ++i) {
    experiment.time.push_back(i);
    experiment.scored.push_back(i >= scored_from ? 1 : 0);
  }
  for (Sensor const& each : sensors) {
    experiment.measured.emplace_back(rows, std::nan(""));
    for (int i = each.from; i < rows; i += each.step) experiment.measured.back()[static_cast<std::size_t>(i)] = 1;
  }
  return rows_ahead(experiment, 100);
}

}  // namespace

TEST_CASE("a look ahead goes on until every channel has samples, wherever they begin") {
  CHECK(ahead(50, {{0}}) == 50);
  CHECK(ahead(5000, {{0}}) == 100);
  CHECK(ahead(5000, {{0}}, 1000) == 1100);
  CHECK(ahead(5000, {{2000}}) == 2100);
  CHECK(ahead(5000, {{0}, {0}}) == 100);
  CHECK(ahead(5000, {{0}, {0, 20}}) == 100);      // five of the second are what it has in a hundred rows
  CHECK(ahead(5000, {{0}, {2000}}) == 2010);      // ten of the second
  CHECK(ahead(5000, {{0}, {2000, 20}}) == 2100);  // what it has in a hundred rows
  CHECK(ahead(5000, {{0}, {5000}}) == 100);       // none in this record
  CHECK(ahead(5000, {{0, 500}}) == 1000);         // ten times as many rows as samples are wanted
  CHECK(ahead(5000, {{0, 500}, {3000, 500}}) == 4000);
  CHECK(ahead(50, {{50}}) == 50);
}
