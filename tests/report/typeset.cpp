// Equations for the eye.
#include "report/typeset.hpp"

#include <doctest/doctest.h>

using namespace sysid;

TEST_CASE("an equation is typeset without touching the user's names") {
  CHECK(typeset("m*y'' + k3*y^3 = x") == "<i>m</i>\u2009<i>y</i>″ + <i>k3</i>\u2009<i>y</i><sup>3</sup> = <i>x</i>");
  CHECK(typeset("y''' - y'") == "<i>y</i>″′ − <i>y</i>′");
  CHECK(typeset("abs(z)^(n-1)") == "abs(<i>z</i>)<sup><i>n</i>−1</sup>");
  CHECK(typeset("a < b & c") == "<i>a</i> &lt; <i>b</i> &amp; <i>c</i>");
}

TEST_CASE("unfinished equations are typeset as far as they go") {
  CHECK(typeset("y^") == "<i>y</i>^");
  CHECK(typeset("y^(n").starts_with("<i>y</i><sup>"));
  CHECK(typeset("").empty());
}
