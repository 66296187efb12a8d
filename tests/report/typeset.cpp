// Statements of the user as HTML.
#include "report/page/typeset.hpp"

#include <doctest/doctest.h>

namespace {

std::string typeset(std::string const& statement) { return sysid::typeset(std::vector{statement}).front(); }

}  // namespace

TEST_CASE("an equation is displayed as a formula that keeps its text for those who cannot see it") {
  CHECK(typeset("k*y = x") ==
        "<math display=\"block\" alttext=\"k*y = x\"><mrow><mrow><mi>k</mi><mo lspace=\"0\" "
        "rspace=\"0.17em\">\u2062</mo><mi>y</mi></mrow>"
        "<mo>=</mo><mi>x</mi></mrow></math>");
}

TEST_CASE("what is no statement stays the text it is, escaped") {
  CHECK(typeset("y^ < & \"") == "<code>y^ &lt; &amp; &quot;</code>");
  CHECK(typeset("").find("<math") == std::string::npos);
}

TEST_CASE("names of one model that would be printed alike are told apart, wherever they stand") {
  std::vector<std::string> const formulas = sysid::typeset({"k1*y = x", "no statement", "k_1 = 2"});
  CHECK(formulas[0].find("<mi>k1</mi>") != std::string::npos);
  CHECK(formulas[1] == "<code>no statement</code>");
  CHECK(formulas[2].find("<mi>k_1</mi>") != std::string::npos);
}
