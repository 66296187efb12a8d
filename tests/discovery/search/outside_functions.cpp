// What is offered beside a dictionary.
#include "discovery/search/outside_functions.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace sysid;

namespace {

StateValues moving_states(double lowest) {
  StateValues out{{"x", "v"}, {1, 1}, Eigen::MatrixXd(60, 2)};
  for (int i = 0; i < 60; ++i) out.values.row(i) << lowest + 0.05 * i, std::cos(0.3 * i);
  return out;
}

bool is_among(std::vector<OutsideFunction> const& all, std::string const& text) {
  return std::any_of(all.begin(), all.end(), [&](OutsideFunction const& each) { return each.text == text; });
}

}  // namespace

TEST_CASE("functions that a dictionary lacks are offered, each once, where they are finite") {
  StateValues const positive = moving_states(0.1);
  auto const all = outside_functions(positive, Eigen::MatrixXd(60, 0));
  for (char const* text : {"x", "x^5", "exp(-2*x)", "x^2/(1 + x^2)", "x*log(x)", "v*cos(x)", "x^2*v^2", "abs(v)*v", "sin(2*v)"}) {
    CAPTURE(text);
    CHECK(is_among(all, text));
  }
  CHECK_FALSE(is_among(all, "log(v)"));
  CHECK_FALSE(is_among(all, "abs(x)*x"));  // x^2
  CHECK_FALSE(is_among(outside_functions(moving_states(-1), Eigen::MatrixXd(60, 0)), "sqrt(x)"));
  Eigen::MatrixXd known(60, 2);
  known.col(0) = -3 * positive.values.col(0);
  known.col(1) = positive.values.col(0).array().exp() * 2;
  auto const others = outside_functions(positive, known);
  CHECK_FALSE(is_among(others, "x"));
  CHECK_FALSE(is_among(others, "exp(x)"));
  CHECK(is_among(others, "exp(-x)"));
}

TEST_CASE("no function is taken of a state with a unit, but powers and products are") {
  StateValues with_units = moving_states(0.1);
  with_units.plain = {0, 0};
  auto const all = outside_functions(with_units, Eigen::MatrixXd(60, 0));
  CHECK(is_among(all, "x^4"));
  CHECK(is_among(all, "x^3*v"));
  CHECK_FALSE(std::any_of(all.begin(), all.end(), [](OutsideFunction const& each) {
    return each.text.find("exp") != std::string::npos || each.text.find("sin") != std::string::npos;
  }));
}
