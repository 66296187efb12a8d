// `dy/dt` as a derivative, and quotients of names that only look like one.
#include <doctest/doctest.h>

#include "check/checking.hpp"

using namespace sysid;

namespace {

std::string with_term(std::string const& term, std::string const& declared = {}) {
  return test::messages("model m {\ninput x\nstate y\ninitial y = 0\n" + declared + "y' + y + " + term +
                        " = x\nobserve d ~ normal(y, sd = 1)\n}\n");
}

}  // namespace

TEST_CASE("a quotient of Leibniz is answered with primes where its letters stand for a quantity") {
  CHECK(with_term("dy/dt").find("write `y'` in place") != std::string::npos);
  CHECK(with_term("dv/dt").find("write `v'` in place of the quotient, and declare `state v`") != std::string::npos);
  CHECK(with_term("dv_1/dt").find("write `v_1'`") != std::string::npos);
  CHECK(with_term("domega/dt").find("write `omega'`") != std::string::npos);
  CHECK(with_term("d2head/dt^2").find("write `head''`") != std::string::npos);
}

TEST_CASE("a word that begins with d is no derivative of the rest") {
  for (auto const& [term, declared] : {std::pair("drag/dt", ""), std::pair("dista/dt", "parameter dist = 1\n")}) {
    CAPTURE(term);
    std::string const said = with_term(term, declared);
    CHECK(said.find("is not declared in this model") != std::string::npos);
    CHECK(said.find("in place of the quotient") == std::string::npos);
  }
}
