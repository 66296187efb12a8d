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

/// Of one task. Well-formed XML as well as HTML, without a script and without a reference to anything outside.
std::string report_html(Report const& report, std::vector<DrawnFigure> const& figures);

struct ReportedTask {
  Report const& report;
  std::vector<DrawnFigure> figures;
};

/// Of all tasks of a run, in order: contents first, then each as `report_html` has it. `tasks` is not empty.
std::string run_html(std::vector<ReportedTask> const& tasks);

}  // namespace sysid
