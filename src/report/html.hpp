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

}  // namespace sysid
