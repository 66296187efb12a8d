// What gnuplot draws as SVG, made smaller, and fit for a page.
#pragma once
#include <optional>
#include <string>

#include "report/figure/plot.hpp"

namespace sysid {

/// As gnuplot has drawn it, without what is empty or needlessly long, its identifiers unique within a page; nothing where that is
/// no whole SVG.
std::optional<std::string> finished_svg(std::string picture, plot::Figure const& figure);

/// A standalone SVG as a part of a page: no prologue, no background, colours by the page's variables (`--fig-ink`, ...), so that it
/// follows light and dark, no wider than lets its text be as large as the page's, and no narrower than lets it be read.
std::string embedded(std::string const& svg, plot::Figure const& figure);

}  // namespace sysid
