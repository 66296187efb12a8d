// `report`: the page of results, made anew from their folder without fitting again.
#pragma once
#include <filesystem>
#include <optional>
#include <vector>

#include "report/figure/figure_format.hpp"

namespace sysid {

/// Writes the page of a task's folder, or one page of all tasks of a run's, to `output`; by default report.html in the folder.
/// Returns where it stands. Figures are drawn where `pictures` are wanted. IoError where a file cannot be read or written;
/// UserError where there are no results, or they are damaged: the page of before stays as it is.
std::filesystem::path report_results(std::filesystem::path const& folder, std::optional<std::filesystem::path> const& output,
                                     bool pictures);

/// Draws the figures of a task's folder, or of all of a run's, anew: into figures/ of each, beside the scripts. Errors as above,
/// and UserError where gnuplot did not draw one, after all others are drawn.
void redraw_figures(std::filesystem::path const& folder, std::vector<FigureFormat> const& formats);

}  // namespace sysid
