// gnuplot as a child process: script in, picture out, through a temporary folder.
#include "report/figure/gnuplot.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include "core/system/files.hpp"
#include "core/text/diagnostic.hpp"
#include "core/text/number.hpp"

extern char** environ;

namespace sysid {

namespace {

namespace fs = std::filesystem;

struct TemporaryFolder {
  TemporaryFolder() {
    std::error_code error;
    fs::path const base = fs::temp_directory_path(error);
    std::string name = ((error ? fs::path("/tmp") : base) / "sysid-XXXXXX").string();
    if (char const* made = mkdtemp(name.data())) path = made;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path.empty()) fs::remove_all(path, ignored);
  }
  TemporaryFolder(TemporaryFolder const&) = delete;
  TemporaryFolder& operator=(TemporaryFolder const&) = delete;
  fs::path path;
};

/// Exit status of gnuplot without the user's own settings, its messages and standard input shut off; -1 when it cannot be run.
int run_gnuplot(std::vector<std::string> arguments, fs::path const& folder) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  std::string const output = folder.empty() ? "/dev/null" : (folder / "picture").string();
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  int const failed = posix_spawnp(&child, "gnuplot", &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) return -1;
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) text.replace(at, from.size(), to);
}

/// The value of the attribute that begins at `prefix` in a line, up to `end`.
std::string_view between(std::string_view line, std::string_view prefix, char end) {
  std::size_t const begin = line.find(prefix);
  if (begin == std::string_view::npos) return {};
  std::string_view const rest = line.substr(begin + prefix.size());
  return rest.substr(0, rest.find(end));
}

/// gnuplot writes a hundred bytes per filled point; a run of them is one path of round dots.
std::string join_points(std::string_view svg) {
  std::string out, points, scale, colour;
  auto const flush = [&] {
    if (points.empty()) return;
    out += fmt::format("\t<path stroke='{}' stroke-width='{:.2f}' stroke-linecap='round' d='{}'/>\n", colour,
                       2 * leading_number(scale), points);
    points.clear();
  };
  while (!svg.empty()) {
    std::size_t const end = std::min(svg.find('\n'), svg.size() - 1);
    std::string_view const line = svg.substr(0, end + 1);
    svg.remove_prefix(end + 1);
    if (!line.starts_with("\t<use xlink:href='#gpPt6'")) {
      flush();
      out += line;
      continue;
    }
    if (between(line, "scale(", ')') != scale || between(line, "color='", '\'') != colour) flush();
    scale = between(line, "scale(", ')');
    colour = between(line, "color='", '\'');
    points += fmt::format("M{}h.01", between(line, "translate(", ')'));
  }
  flush();
  return out;
}

/// Coordinates of paths and polygons to a tenth of a pixel: gnuplot writes hundredths, a seventh of a file.
std::string to_tenths(std::string_view svg) {
  auto const is_part = [](char c) { return (c >= '0' && c <= '9') || c == '.'; };
  std::string out;
  bool coordinates = false;
  for (std::size_t at = 0; at < svg.size();) {
    if (svg[at] == '\'') coordinates = !coordinates && (out.ends_with(" d=") || out.ends_with(" points = "));
    std::size_t end = at;
    while (coordinates && end < svg.size() && is_part(svg[end])) ++end;
    std::string_view const number = svg.substr(at, end - at);
    if (std::size_t const dot = number.find('.'); dot != number.npos && dot > 0 && dot + 3 == number.size()) {
      out += fmt::format("{:.1f}", leading_number(number));
      if (out.ends_with(".0")) out.resize(out.size() - 2);
    } else {
      end = std::max(end, at + 1);
      out += svg.substr(at, end - at);
    }
    at = end;
  }
  return out;
}

/// Numbers and titles that are empty; whether gnuplot writes such a title hangs on what it has drawn before.
void erase_empty_texts(std::string& svg) {
  constexpr std::string_view empty = ">\n\t\t<text></text>\n\t</g>\n";
  for (std::size_t at = 0; (at = svg.find(empty, at)) != std::string::npos;) {
    std::size_t const begin = svg.rfind("\t<g transform=", at);
    if (begin == std::string::npos || svg.find('\n', begin) < at) {
      ++at;
      continue;
    }
    bool const own_line = begin == 0 || svg[begin - 1] == '\n';
    svg.erase(begin, at + empty.size() - (own_line ? 0 : 1) - begin);
    at = begin;
  }
}

/// Removes what gnuplot writes for features that are not used, and makes its identifiers unique within a page.
void finish_svg(std::string& svg, std::string const& name) {
  svg = to_tenths(join_points(svg));
  std::size_t const begin = svg.find("<defs>"), end = svg.find("</defs>");
  if (begin != std::string::npos && end != std::string::npos && svg.find("<use", end) == std::string::npos)
    svg.erase(begin, end + 8 - begin);
  replace_all(svg, "\"gnuplot_canvas\"", "\"" + name + "_canvas\"");
  erase_empty_texts(svg);
  // Groups that hold nothing are most of the file's lines.
  for (std::size_t at = 0; (at = svg.find("<g fill=\"none\"", at)) != std::string::npos;) {
    std::size_t const end = svg.find('>', at);
    if (end != std::string::npos && svg.compare(end + 1, 6, "\n</g>\n") == 0)
      svg.erase(at, end + 7 - at);
    else
      at = end;
  }
  replace_all(svg, "font-family=\"Helvetica\"", "font-family=\"Helvetica, Arial, 'Liberation Sans', sans-serif\"");
}

/// "#1f2933" as gnuplot writes it: "rgb( 31,  41,  51)" for strokes, "rgb(31,41,51)" for text.
std::vector<std::string> as_written(std::string_view colour) {
  auto const channel = [&](std::size_t at) { return std::stoi(std::string(colour.substr(at, 2)), nullptr, 16); };
  int const red = channel(1), green = channel(3), blue = channel(5);
  return {fmt::format("rgb({:3}, {:3}, {:3})", red, green, blue), fmt::format("rgb({},{},{})", red, green, blue)};
}

}  // namespace

namespace {

struct FormatRow {
  FigureFormat format;
  std::string_view name, extension, terminal;
};
constexpr FormatRow formats[] = {
    {FigureFormat::svg, "svg", "svg", "svg"},
    {FigureFormat::png, "png", "png", "pngcairo"},
    {FigureFormat::pdf, "pdf", "pdf", "pdfcairo"},
    {FigureFormat::text, "text", "txt", "dumb"},
};

FormatRow const& row(FigureFormat format) { return formats[static_cast<std::size_t>(format)]; }

/// Without the feeds between plots, blanks at the ends of lines, and lines without anything above and below.
std::string without_blank_lines(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    std::size_t const end = std::min(text.find('\n'), text.size());
    std::string line(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    std::erase(line, '\f');
    line.erase(line.find_last_not_of(' ') + 1);
    if (!line.empty() || !out.empty()) out += line + '\n';
  }
  while (out.ends_with("\n\n")) out.pop_back();
  return out;
}

}  // namespace

std::string_view name(FigureFormat format) { return row(format).name; }

std::string_view extension(FigureFormat format) { return row(format).extension; }

std::optional<FigureFormat> find_figure_format(std::string_view name) {
  for (FormatRow const& each : formats)
    if (each.name == name) return each.format;
  return std::nullopt;
}

bool gnuplot_installed() { return run_gnuplot({"gnuplot", "--version"}, {}) == 0; }

bool can_draw(FigureFormat format) {
  return run_gnuplot({"gnuplot", "-d", "-e", fmt::format("set terminal {}", row(format).terminal)}, {}) == 0;
}

namespace {

/// What the scripts of figures ask for.
std::string variables(FigureFormat format, int columns) {
  return fmt::format("format = '{}'; columns = {}", name(format), std::max(columns, 20));
}

/// As gnuplot has drawn it; nothing where that is no whole SVG.
std::optional<std::string> finished_svg(std::string picture, plot::Figure const& figure) {
  if (picture.find("</svg>") == std::string::npos) return std::nullopt;
  finish_svg(picture, plot::identifier(figure.name));
  return picture;
}

/// All by one process; nothing where it fails, as one script that is refused ends it. started: whether there is a gnuplot.
std::optional<std::vector<std::optional<std::string>>> drawn_together(std::vector<plot::Figure> const& figures, bool& started) {
  TemporaryFolder const folder;
  if (folder.path.empty()) return std::nullopt;
  std::string all;
  for (std::size_t i = 0; i < figures.size(); ++i) {
    write_file(folder.path / fmt::format("{}.gnuplot", i), figures[i].script);
    all += fmt::format("reset\n{}\nset output {}\nload {}\nunset multiplot\nset output\n", variables(FigureFormat::svg, 80),
                       plot::quote((folder.path / fmt::format("{}.svg", i)).string()),
                       plot::quote((folder.path / fmt::format("{}.gnuplot", i)).string()));
  }
  write_file(folder.path / "all.gnuplot", all);
  int const status = run_gnuplot({"gnuplot", "-d", (folder.path / "all.gnuplot").string()}, folder.path);
  started = status >= 0;
  if (status != 0) return std::nullopt;
  std::vector<std::optional<std::string>> drawn;
  for (std::size_t i = 0; i < figures.size(); ++i) {
    fs::path const picture = folder.path / fmt::format("{}.svg", i);
    drawn.push_back(fs::exists(picture) ? finished_svg(read_file(picture), figures[i]) : std::nullopt);
  }
  return drawn;
}

}  // namespace

std::optional<std::string> draw(plot::Figure const& figure, FigureFormat format, int columns) {
  TemporaryFolder const folder;
  if (folder.path.empty()) return std::nullopt;
  try {
    write_file(folder.path / "figure.gnuplot", figure.script);
    if (run_gnuplot({"gnuplot", "-d", "-e", variables(format, columns), (folder.path / "figure.gnuplot").string()}, folder.path) !=
        0)
      return std::nullopt;
    std::string picture = read_file(folder.path / "picture");
    if (format == FigureFormat::text) return without_blank_lines(picture);
    // A terminal that gnuplot does not have makes no error of its own.
    if (format == FigureFormat::png && !picture.starts_with("\x89PNG")) return std::nullopt;
    if (format == FigureFormat::pdf && !picture.starts_with("%PDF")) return std::nullopt;
    return format == FigureFormat::svg ? finished_svg(std::move(picture), figure) : picture;
  } catch (IoError const&) {
    return std::nullopt;  // a figure is worth no failed run; the report says what is missing
  }
}

std::vector<std::optional<std::string>> draw_all(std::vector<plot::Figure> const& figures) {
  std::vector<std::optional<std::string>> drawn(figures.size());
  bool started = true;
  if (figures.size() > 1) try {
      if (auto together = drawn_together(figures, started)) drawn = std::move(*together);
    } catch (IoError const&) {
    }
  for (std::size_t i = 0; i < figures.size() && started; ++i)
    if (!drawn[i]) drawn[i] = draw(figures[i]);
  return drawn;
}

std::string embedded(std::string const& svg, plot::Figure const& figure) {
  std::size_t const begin = svg.find("<svg");
  std::string out = begin == std::string::npos ? svg : svg.substr(begin);
  auto const follow = [&](std::string_view colour, std::string const& variable) {
    for (std::string const& form : as_written(colour)) replace_all(out, form, "var(--fig-" + variable + ")");
    replace_all(out, fmt::format("\"{}\"", colour), "\"var(--fig-" + variable + ")\"");
  };
  follow(plot::ink, "ink");
  follow(plot::muted, "muted");
  follow(plot::rule, "rule");
  follow(plot::paper, "paper");
  follow(plot::model, "model");
  follow(plot::response_band, "band");
  follow(plot::noise_band, "noise-band");
  follow(plot::data, "data");
  follow(plot::contrast, "contrast");
  for (std::size_t c = 0; c < std::size(plot::chains); ++c) follow(plot::chains[c], fmt::format("chain-{}", c + 1));
  std::size_t const box = out.find("viewBox=\"0 0 ");
  // Its text would otherwise be larger than the page's, or too small to be read: 9 pixels of its 12.
  double const width = box == std::string::npos ? 0 : leading_number(std::string_view(out).substr(box + 13));
  std::string const widest =
      width > 0 ? fmt::format(" style=\"max-width:{:.0f}px;min-width:{:.0f}px\"", 1.4 * width, 0.75 * width) : "";
  replace_all(out, "<svg ", fmt::format("<svg role=\"img\" aria-label=\"{}\"{}", plot::identifier(figure.name), widest));
  return out;
}

}  // namespace sysid
