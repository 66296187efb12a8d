// What figures are drawn as.
#pragma once
#include <optional>
#include <string_view>

namespace sysid {

/// What becomes of a figure.
enum class FigureFormat {
  svg,
  png,   // 430 points per inch where it is one column, 85 mm, wide
  pdf,   // 85 mm wide for one column, 170 mm for two
  text,  // characters
};

/// "svg", "png", "pdf", "text": as the command line names it.
std::string_view name(FigureFormat format);
/// Nothing where no format has this name.
std::optional<FigureFormat> find_figure_format(std::string_view name);
/// Of its files: "svg", "png", "pdf", "txt".
std::string_view extension(FigureFormat format);
/// Whether the gnuplot that is installed, if one is, draws this format: some are built without PNG and PDF.
bool can_draw(FigureFormat format);

}  // namespace sysid
