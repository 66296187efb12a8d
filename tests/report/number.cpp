// Numbers as text: exact for files, cut at the Monte Carlo error for people.
#include "core/text/number.hpp"
#include "report/text/summary_text.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "core/numeric/random.hpp"

using namespace sysid;

namespace {

Summary summary(double mean, double sd, double mcse) {
  return {"k", "N/m", mean, mean, sd, sd, mean - 1.645 * sd, mean + 1.645 * sd, 1.0004, 812.3, 700.8, mcse};
}

}  // namespace

TEST_CASE("the shortest decimal reads back as the same double") {
  Stream stream({1, Purpose::test, 0, 0});
  for (int i = 0; i < 10000; ++i) {
    std::uint64_t const bits = stream.bits();
    double value;
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value)) continue;
    CHECK(std::strtod(shortest(value).c_str(), nullptr) == value);
  }
  CHECK(shortest(0.1) == "0.1");
  CHECK(shortest(1e4) == "10000");
}

TEST_CASE("what is not finite is written as R and Python read it, whatever its sign bit") {
  double const nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(shortest(nan) == "NaN");
  CHECK(shortest(-nan) == "NaN");
  CHECK(shortest(INFINITY) == "Inf");
  CHECK(shortest(-INFINITY) == "-Inf");
}

TEST_CASE("significant digits survive rounding into the next decade") {
  CHECK(significant(9.9996, 4) == "10.00");
  CHECK(significant(0.0104, 4) == "0.01040");
  CHECK(significant(123456, 3) == "123000");
  CHECK(significant(4.986e9, 4) == "4.986e9");
  CHECK(significant(9.9999e5, 3) == "1.00e6");
  CHECK(significant(-2.5e-7, 2) == "-2.5e-7");
  CHECK(significant(0, 3) == "0");
  CHECK(significant(std::nan(""), 3) == "-");
}

TEST_CASE("a mean ends at the leading digit of its Monte Carlo error, a spread has two digits") {
  SummaryText const t = format_summary(summary(1.0004512, 0.000632, 0.0000234));
  CHECK(t.mean == "1.00045");
  CHECK(t.sd == "0.00063");
  CHECK(t.rhat == "1.000");
  CHECK(t.ess_bulk == "812");
}

TEST_CASE("the numbers of a row share one power of ten") {
  SummaryText const t = format_summary(summary(4.986e9, 3.27e7, 1.1e6));
  CHECK(t.mean == "4.986e9");
  CHECK(t.sd == "0.033e9");
  CHECK(t.q5 == "4.932e9");
  CHECK(format_summary(summary(2.5e-6, 1e-7, 1e-9)).mean == "2.500e-6");
}

TEST_CASE("a spread of quite another size than its mean has a power of ten of its own") {
  SummaryText const wide = format_summary(summary(1.087e-6, 20, std::nan("")));
  CHECK(wide.sd == "20");
  Summary optimum = summary(1.087e-6, 20, std::nan(""));
  optimum.q5 = optimum.q95 = std::nan("");
  CHECK(format_summary(optimum).mean == "1e-6");
  CHECK(format_summary(optimum).sd == "20");
  optimum.mean = optimum.median = -2.155e-6;
  optimum.sd = 1.000007;
  CHECK(format_summary(optimum).mean == "-2e-6");
  CHECK(format_summary(optimum).sd == "1.0");
  CHECK(format_summary(summary(-0.030096, 4.8e-5, 5e-6)).sd == "0.000048");
  optimum.mean = optimum.median = 4.986e9;
  optimum.sd = 0.004;
  CHECK(format_summary(optimum).sd == "0.0040");
}

TEST_CASE("a parameter that never moved still has a readable row") {
  Summary s = summary(3.0, 0, 0);
  s.rhat = s.ess_bulk = s.ess_tail = s.mcse_mean = std::nan("");
  SummaryText const t = format_summary(s);
  CHECK(t.mean == "3.000");
  CHECK(t.sd == "0");
  CHECK(t.rhat == "-");
}

TEST_CASE("mean and sd are rounded alike") {
  CHECK(mean_and_sd(summary(19.99992, 0.0175, 1e-4)) == "20.000 ± 0.018");
  CHECK(mean_and_sd(summary(4.986e9, 3.27e7, 1e6)) == "(4.986 ± 0.033)·10⁹");
  CHECK(mean_and_sd(summary(-0.31, 0.12, 0.01)) == "−0.31 ± 0.12");
}

TEST_CASE("units are shown with dots and raised powers, and what is no whole number stays as written") {
  CHECK(pretty_unit("N s/m") == "N·s/m");
  CHECK(pretty_unit("N/m^3") == "N/m³");
  CHECK(pretty_unit("m^-2") == "m⁻²");
  CHECK(pretty_unit("N^(1-n)/m") == "N^(1-n)/m");
  CHECK(pretty_unit("m^1.5") == "m^1.5");
  CHECK(pretty_unit("m^") == "m^");
  CHECK(pretty_unit("m^-") == "m^-");
  CHECK(pretty_powers("sigma 0.472 m/s^2, n 2 m^1.5") == "sigma 0.472 m/s², n 2 m^1.5");
  CHECK(pretty_units("input x = a [N s/m^2], y[1] = y^2 [m^-1") == "input x = a [N·s/m²], y[1] = y^2 [m^-1");
  CHECK(pretty_number("-4.9e9") == "−4.9·10⁹");
  CHECK(pretty_number("-") == "-");
}

TEST_CASE("columns align by characters, not bytes, and lines have no trailing blanks") {
  CHECK(align_columns({{"a", "µm", "1"}, {"long", "m", "22.5"}, {"b"}}, 2) == "a     µm     1\nlong  m   22.5\nb\n");
}
