// report.html: one page that needs nothing else, light or dark, on screen or paper.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "report/plot.hpp"
#include "report/report.hpp"

namespace sysid {

/// A figure with its picture; none: gnuplot was not there.
struct DrawnFigure {
  plot::Figure figure;
  std::optional<std::string> svg;
};

std::string report_html(Report const& report, std::vector<DrawnFigure> const& figures);

/// An equation of the language for the eye: names slanted, powers raised, primes as primes, the user's names untouched. HTML.
std::string typeset(std::string_view equation);

}  // namespace sysid
