// The table of input rules: every rule has a complete row, and its polynomials are what the row says.
#include "data/input_rule.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "data/experiment.hpp"

using namespace sysid;

TEST_CASE("every input rule has a complete row of its own, in the order of the rules") {
  CHECK(input_rules().size() == static_cast<std::size_t>(InputRule::band_limited) + 1);
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < input_rules().size(); ++i) {
    InputRuleRow const& row = input_rules()[i];
    CAPTURE(row.name);
    CHECK(static_cast<std::size_t>(row.rule) == i);
    CHECK(&row_of(row.rule) == &row);
    CHECK(names.insert(row.name).second);
    CHECK(find_input_rule(row.name) == row.rule);
    CHECK(rule_name(row.rule) == row.name);
    CHECK(row.usage == "hold " + std::string(row.name));
    CHECK(!row.summary.empty());
    CHECK((row.coefficients != nullptr));
  }
  CHECK(!find_input_rule("zoh"));
}

TEST_CASE("a sample changes no interval that is farther away than the reach of its rule") {
  std::vector<double> time, samples;
  for (int i = 0; i < 120; ++i) {
    time.push_back(i);
    samples.push_back(std::sin(0.7 * i));
  }
  constexpr std::size_t changed = 60;
  std::vector<double> other = samples;
  other[changed] += 1;
  for (InputRuleRow const& row : input_rules()) {
    CAPTURE(row.name);
    std::vector<double> const one = row.coefficients(time, samples), two = row.coefficients(time, other);
    std::size_t const each = static_cast<std::size_t>(row.degree) + 1, reach = static_cast<std::size_t>(row.reach);
    double inside = 0, outside = 0;
    for (std::size_t i = 0; i < one.size(); ++i) {
      std::size_t const interval = i / each;
      bool const near = interval <= changed + reach && interval + 1 + reach >= changed;
      double& largest = near ? inside : outside;
      largest = std::max(largest, std::abs(one[i] - two[i]));
    }
    CHECK(inside > 0.1);
    CHECK(outside < 1e-10);
  }
}

TEST_CASE("degree, jumps and kinks of a rule are those of its polynomials") {
  std::vector<double> const time = {0, 1, 2, 3, 4, 5}, samples = {1, -2, 3, 0.5, 4, -1};
  for (InputRuleRow const& row : input_rules()) {
    CAPTURE(row.name);
    InputSignal const signal(row.rule, time, samples);
    CHECK(signal.degree() == row.degree);
    CHECK(row.coefficients(time, samples).size() == (samples.size() - 1) * static_cast<std::size_t>(row.degree + 1));
    CHECK((signal.value(1, 1) != signal.value(2, 0)) == row.jumps);
    // The band-limited curve is smooth only to its accuracy: see tests/data/input_signal.cpp.
    if (row.band == 0) CHECK((std::abs(signal.rate(1, 1) - signal.rate(2, 0)) > 1e-12) == row.kinks);
    CHECK((row.degree > 0) == row.has_rate);
  }
}
