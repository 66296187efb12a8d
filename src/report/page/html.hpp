// report.html: one page that needs nothing else, light or dark, on screen or paper.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "report/figure/plot.hpp"
#include "result/report.hpp"

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

/// What the page of a run says of its tasks together.
struct RunReport {
  std::vector<ReportedTask> tasks;
  std::vector<ReportTable> comparisons;  // of models and predictions of the same samples
  std::string apart;                     // why some fits are not compared; empty: all are
  std::vector<std::string> unfinished;   // tasks that were interrupted before they had a result
};

/// Of all tasks of a run, in order: contents first, what they say together, then each as `report_html` has it. There is a task, or
/// one that is unfinished.
std::string run_html(RunReport const& run);

}  // namespace sysid
