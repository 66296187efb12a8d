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
#include "report/figure/svg.hpp"

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

}  // namespace sysid
