// Draws figures by gnuplot, when it is installed.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "report/figure/figure_format.hpp"
#include "report/figure/plot.hpp"

namespace sysid {

bool gnuplot_installed();

/// The figure as a file's content; nothing when gnuplot is missing or refuses. SVG and text are the same bytes for the same script.
/// columns: characters that text is wide, of any number from 20 on.
std::optional<std::string> draw(plot::Figure const& figure, FigureFormat format = FigureFormat::svg, int columns = 80);
/// The same bytes of all as SVG, by one process: gnuplot takes longer to start than to draw.
std::vector<std::optional<std::string>> draw_all(std::vector<plot::Figure> const& figures);

}  // namespace sysid
