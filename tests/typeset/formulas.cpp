// Statements that are given as texts.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "typeset/typeset.hpp"

TEST_CASE("an equation is displayed as a formula that keeps its text for those who cannot see it") {
  CHECK(sysid::formulas({std::string("k*y = x")}) ==
        std::vector<std::string>{"<math display=\"block\" alttext=\"k*y = x\"><mrow><mrow><mi>k</mi><mo lspace=\"0\" "
                                 "rspace=\"0.17em\">\u2062</mo><mi>y</mi></mrow>"
                                 "<mo>=</mo><mi>x</mi></mrow></math>"});
}

TEST_CASE("what is no statement has no formula") {
  CHECK(sysid::formulas({"y^ < & \"", "", "state y [m]"}) == std::vector<std::string>(3));
}

TEST_CASE("names of one model that would be printed alike are told apart, wherever they stand") {
  std::vector<std::string> const formulas = sysid::formulas({"k1*y = x", "no statement", "k_1 = 2"});
  CHECK(formulas[0].find("<mi>k1</mi>") != std::string::npos);
  CHECK(formulas[1].empty());
  CHECK(formulas[2].find("<mi>k_1</mi>") != std::string::npos);
}
