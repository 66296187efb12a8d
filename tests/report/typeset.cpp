// Text of the user as HTML.
#include "report/typeset.hpp"

#include <doctest/doctest.h>

using sysid::escape;
using sysid::typeset;

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
