// Colours that stand for different things are told apart by readers who do not see red or green.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "report/figure/plot.hpp"

using namespace sysid;

namespace {

using Triple = std::array<double, 3>;
using Matrix = std::array<Triple, 3>;

/// Linear RGB of "#1f2933".
Triple linear(std::string_view colour) {
  Triple out;
  for (std::size_t c = 0; c < 3; ++c) {
    double const value = std::stoi(std::string(colour.substr(1 + 2 * c, 2)), nullptr, 16) / 255.0;
    out[c] = value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
  }
  return out;
}

Triple times(Matrix const& m, Triple const& v) {
  Triple out;
  for (std::size_t r = 0; r < 3; ++r) out[r] = std::clamp(m[r][0] * v[0] + m[r][1] * v[1] + m[r][2] * v[2], 0.0, 1.0);
  return out;
}

/// CIE 1976 L*a*b* under D65.
Triple lab(Triple const& rgb) {
  auto const f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; };
  double const x = f((0.4124564 * rgb[0] + 0.3575761 * rgb[1] + 0.1804375 * rgb[2]) / 0.95047);
  double const y = f(0.2126729 * rgb[0] + 0.7151522 * rgb[1] + 0.0721750 * rgb[2]);
  double const z = f((0.0193339 * rgb[0] + 0.1191920 * rgb[1] + 0.9503041 * rgb[2]) / 1.08883);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

/// Dichromats by Machado, Oliveira and Fernandes 2009, severity 1.
constexpr Matrix normal{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
constexpr Matrix protanopia{{{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}}};
constexpr Matrix deuteranopia{{{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}}};

double least_distance(std::vector<std::string_view> const& colours, Matrix const& eye) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < colours.size(); ++a)
    for (std::size_t b = a + 1; b < colours.size(); ++b) {
      Triple const p = lab(times(eye, linear(colours[a]))), q = lab(times(eye, linear(colours[b])));
      least = std::min(least, std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
    }
  return least;
}

}  // namespace

TEST_CASE("chains, and what a figure sets against each other, differ for every eye") {
  // Sharma 2003: 2.3 is just noticeable side by side; lines that are apart, thin and explained by a legend need several times that.
  std::vector<std::string_view> const chains(std::begin(plot::chains), std::end(plot::chains));
  std::vector<std::string_view> const areas = {plot::response_band, plot::noise_band, plot::paper};
  for (Matrix const* eye : {&normal, &protanopia, &deuteranopia}) {
    CHECK(least_distance(chains, *eye) > 18);
    CHECK(least_distance({chains.begin(), chains.begin() + 4}, *eye) > 24);
    CHECK(least_distance({plot::model, plot::data, plot::contrast}, *eye) > 24);
    CHECK(least_distance(areas, *eye) > 7);
  }
}

TEST_CASE("the measure of the palette finds red and green alike where they are") {
  CHECK(least_distance({"#2d8a6b", "#a63d57"}, normal) > 60);
  CHECK(least_distance({"#2d8a6b", "#a63d57"}, deuteranopia) < 12);
}

TEST_CASE("lines stand out from the paper") {
  // WCAG 2.1, contrast of graphics.
  auto const luminance = [](std::string_view colour) {
    Triple const rgb = linear(colour);
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
  };
  for (std::string_view const colour : plot::chains) CHECK_MESSAGE(1.05 / (luminance(colour) + 0.05) > 2.2, colour);
}

TEST_CASE("behind the last colour the series are dashed") {
  CHECK(plot::series_colour(0) == "lc rgb '#1b5f9c' dt 1");
  CHECK(plot::series_colour(8) == "lc rgb '#1b5f9c' dt 2");
  CHECK(plot::series_colour(19) == plot::series_colour(3).substr(0, plot::series_colour(3).size() - 1) + "3");
}
