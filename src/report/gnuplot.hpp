// Draws figures by gnuplot, when it is installed.
#pragma once
#include <optional>
#include <string>

#include "report/plot.hpp"

namespace sysid {

bool gnuplot_installed();

/// The figure as a standalone SVG, the same bytes for the same script; nothing when gnuplot is missing or refuses.
std::optional<std::string> draw(plot::Figure const& figure);

/// A standalone SVG as a part of a page: no prologue, no background, colours by the page's variables (`--fig-ink`, ...), so that it
/// follows light and dark.
std::string embedded(std::string const& svg, plot::Figure const& figure);

}  // namespace sysid
