// Terms that a zero takes out.
#include "syntax/inserted.hpp"

#include <doctest/doctest.h>

#include "syntax/parsing.hpp"

using namespace sysid;

namespace {

std::string cleaned(std::string const& text) { return unparse(without_idle_terms(test::statements(text).front())); }

/// As it is written out.
std::string written_anew(std::string const& text) { return unparse(test::statements(text).front()); }

}  // namespace

TEST_CASE("a term with a factor of zero is gone, a factor of one too") {
  CHECK(cleaned("m*y'' + c*y' + k*y + 0*k2*y^2 + 1*k3*y^3 + 0*cd*abs(y')*y' = x") ==
        written_anew("m*y'' + c*y' + k*y + k3*y^3 = x"));
  CHECK(cleaned("0*a - b = x") == written_anew("(-b) = x"));
  CHECK(cleaned("a - (1 - 1*b)*0 = 0/c + x") == written_anew("a = x"));
  CHECK(cleaned("let f = a^1*max(0*b + c, d)/1") == written_anew("let f = a*max(c, d)"));
  CHECK(cleaned("abs(z)^(2 - 1)*z + a^(3 + 1) = x") == written_anew("abs(z)*z + a^4 = x"));
  CHECK(cleaned("observe y ~ normal(1*z + 0*w, sd = s)") == written_anew("observe y ~ normal(z, sd = s)"));
}

TEST_CASE("what changes the value stays") {
  for (char const* text : {"m*y'' + 2*k*y^2 = x", "a*1 [m] + b = x", "a^0 + 1/b = x", "a + 1 = b - 1"})
    CHECK(cleaned(text) == written_anew(text));
}
