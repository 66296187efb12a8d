// A term that a difference equation lacks, where there is room for all that could be tried, for some of it, and for none.
#include "regression/outside_term.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "regression/problems.hpp"

using namespace sysid;
using namespace sysid::regression;

namespace {

/// y against 0.6 lag(y, 1) + 0.5 lag(u, 1); made with 0.4 lag(u, 1)^3 besides, or with 0.4 lag(u, 1)*lag(y, 1), and little noise.
struct Lacking {
  Dictionary dictionary;
  std::vector<Experiment> experiments;
  FoundEquation found;
  Method samples = method("spike_slab", "samples");

  explicit Lacking(bool product) {
    dictionary.discrete = true;
    dictionary.states = {"y"};
    dictionary.channels = {{.name = "y", .state = 0}};
    NodeId const known = leaf(dictionary, Symbol::Kind::state, 0, 0).id;
    NodeId const y = leaf(dictionary, Symbol::Kind::state, 0, 0).id;
    dictionary.symbols.back().lag = 1;
    NodeId const u = leaf(dictionary, Symbol::Kind::input, 0, 0).id;
    dictionary.symbols.back().lag = 1;
    dictionary.equations.push_back({.name = "y", .known = known, .terms = {{"lag(y, 1)", y}, {"lag(u, 1)", u}}});

    Stream force({1, Purpose::input, 0, 0}), error({1, Purpose::noise, 0, 0});
    std::vector<double> time, input, measured = {0};
    for (int i = 0; i < rows + 1; ++i) {
      time.push_back(i);
      input.push_back(force.normal());
      double const before = measured.back(), extra = 0.4 * input.back() * (product ? before : input.back() * input.back());
      measured.push_back(0.6 * before + 0.5 * input.back() + extra + 0.02 * error.normal());
    }
    measured.pop_back();
    Experiment experiment;
    experiment.name = "made";
    experiment.time = time;
    experiment.inputs = {InputSignal(InputRule::zero_order, time, input)};
    experiment.measured = {measured};
    experiment.scored.assign(time.size(), 1);
    experiments.push_back(std::move(experiment));

    found.found = true;
    found.rows = rows;
    found.terms.resize(2);
    for (FoundTerm& each : found.terms) each.kept = true;
    found.chosen.terms = {0, 1};
    found.chosen.coefficient = Eigen::Vector2d(0.6, 0.5);
  }

  std::string concern(double columns) const {
    auto const outside = outside_term(dictionary, experiments, samples, 0, found, columns * rows);
    return outside ? outside->clause : "";
  }

  static constexpr int rows = 200;
};

bool names(std::string const& clause, std::string const& term) { return clause.starts_with("with `" + term + "`"); }

}  // namespace

TEST_CASE("where products have no room single samples are tried without them") {
  // Two terms that are kept, seven of each of two samples, eight of their pair.
  Lacking const cube(false), product(true);
  for (int const columns : {24, 23, 16}) {
    CHECK(names(cube.concern(columns), "lag(u, 1)^3"));
    CHECK(names(product.concern(columns), "lag(y, 1)*lag(u, 1)") == (columns == 24));
  }
  CHECK(cube.concern(15).empty());
}

TEST_CASE("what is interrupted tries nothing more") {
  Lacking cube(false);
  cube.samples.interrupted = [] { return true; };
  CHECK(cube.concern(24).empty());
}
