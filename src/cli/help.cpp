// Rows of two columns, the second one wrapped.
#include "cli/help.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <vector>

#include "cli/described.hpp"

namespace sysid::cli {
namespace {

constexpr std::size_t page_width = 96, widest_left = 28;

struct Row {
  std::string left, right;
};

std::string table(std::vector<Row> const& rows) {
  std::size_t width = 0;
  for (Row const& row : rows) width = std::max(width, std::min(row.left.size(), widest_left));
  std::string out;
  for (Row const& row : rows) {
    std::size_t const indent = width + 3;
    std::string line = fmt::format("  {:<{}}", row.left, width + 1);
    if (row.left.size() > width) {
      out += fmt::format("  {}\n", row.left);
      line = std::string(indent, ' ');
    }
    std::istringstream words(row.right);
    for (std::string word; words >> word;) {
      if (line.size() + 1 + word.size() > page_width) {
        out += line + "\n";
        line = std::string(indent, ' ');
      }
      line += " " + word;
    }
    out += line + "\n";
  }
  return out;
}

Row row_of(DescribedOption const& option) {
  if (option.is_argument()) return {option.value, option.text};
  std::string const left = option.short_name.empty() ? "    " + option.long_name : option.names();
  return {option.value.empty() ? left : left + " " + option.value, option.text};
}

std::string indented(std::string const& lines) {
  std::string out;
  for (std::string const& line : lines_of(lines)) out += fmt::format("  {}\n", line);
  return out;
}

std::string verbs_page(CLI::App const& app) {
  std::string out = fmt::format("{}\n\nUsage: sysid COMMAND [OPTIONS] ...\n", app.get_description());
  std::size_t width = 0;
  for (CLI::App const* verb : commands_of(app)) width = std::max(width, verb->get_name().size());
  std::string group;
  for (CLI::App const* verb : commands_of(app)) {
    if (verb->get_group() != group) out += fmt::format("\n{}:\n", group = verb->get_group());
    out += table({{fmt::format("{:<{}}", verb->get_name(), width), verb->get_description()}});
  }
  std::vector<Row> options;
  for (DescribedOption const& option : described_options(app)) options.push_back(row_of(option));
  return out + "\nOptions:\n" + table(options) + "\nExamples:\n" + indented(app.get_footer()) +
         "\n`sysid COMMAND --help` describes each command.\n";
}

std::string verb_page(CLI::App const& verb) {
  std::vector<Row> arguments, options;
  for (DescribedOption const& option : described_options(verb))
    (option.is_argument() ? arguments : options).push_back(row_of(option));
  std::string out = fmt::format("sysid {}: {}\n\nUsage: {} [OPTIONS]\n", verb.get_name(), verb.get_description(), usage(verb));
  if (!arguments.empty()) out += "\n" + table(arguments);
  out += "\nOptions:\n" + table(options);
  return verb.get_footer().empty() ? out : out + "\nExamples:\n" + indented(verb.get_footer());
}

}  // namespace

std::string HelpPages::make_help(CLI::App const* app, std::string, CLI::AppFormatMode) const {
  return app->get_parent() == nullptr ? verbs_page(*app) : verb_page(*app);
}

}  // namespace sysid::cli
