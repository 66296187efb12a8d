// What simple terms and few terms are worth before the record.
#include "discovery/structure_prior.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "core/text/diagnostic.hpp"
#include "core/text/source.hpp"
#include "relative.hpp"
#include "syntax/parse.hpp"

using namespace sysid;

namespace {

double simplicity_of(std::string const& text) {
  Source const source("term", text);
  Diagnostics diagnostics;
  auto const tree = parse_expression(source, diagnostics);
  REQUIRE_MESSAGE(tree, text);
  return simplicity(*tree);
}

}  // namespace

TEST_CASE("a term is the less simple the more factors and functions it has") {
  for (char const* simple : {"1", "x", "u", "2*x", "x'", "-x"}) {
    CAPTURE(simple);
    CHECK(simplicity_of(simple) == 1);
  }
  for (char const* product : {"x*y", "x^2", "abs(x)", "u*x", "3*x*y"}) {
    CAPTURE(product);
    CHECK(simplicity_of(product) == 0.75);
  }
  CHECK(simplicity_of("x^2*y") == doctest::Approx(0.75 * 0.75));
  CHECK(simplicity_of("abs(x)*x") == doctest::Approx(0.75 * 0.75));
  for (char const* function : {"sin(x)", "exp(x)", "x/(1 + x)", "x^0.5", "1/x"}) {
    CAPTURE(function);
    CHECK(simplicity_of(function) == 0.125);
  }
  CHECK(simplicity_of("y*sin(x)") == relative(0.75 * 0.125, 1e-12));
  CHECK(simplicity_of("sin(x)/x") == relative(0.125 * 0.125, 1e-12));
}

TEST_CASE("an equation has half a term on average, and simple terms are the more probable ones") {
  std::vector<double> const odds = log_odds_of({1, 1, 0.75, 0, 0.25, 0.5});
  double expected = 0;
  for (std::size_t j = 0; j < odds.size(); ++j)
    if (j != 3) expected += 1 / (1 + std::exp(-odds[j]));
  CHECK(expected == doctest::Approx(0.5));
  CHECK(odds[3] == 0);
  CHECK(odds[0] == odds[1]);
  CHECK(odds[2] < odds[1]);
  CHECK(odds[4] < odds[5]);
  CHECK(log_odds_of({1}).front() == 0);  // as probable as not
}
