// Rows of two columns, the second one wrapped.
#include "cli/help.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <vector>

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

bool shown(CLI::Option const& option) { return !option.get_group().empty(); }
bool positional(CLI::Option const& option) { return !option.nonpositional(); }

/// "FOLDER": the type without CLI11's words for its checks.
std::string placeholder(CLI::Option const& option) {
  std::string const type = option.get_type_name();
  return type.substr(0, type.find(':'));
}

Row row_of(CLI::Option const& option) {
  std::string left = positional(option) ? option.get_name(true) : "";
  for (std::string const& name : option.get_snames()) left += "-" + name;
  for (std::string const& name : option.get_lnames()) left += (left.empty() ? "    --" : ", --") + name;
  if (!positional(option) && option.get_items_expected_max() > 0) left += " " + placeholder(option);
  std::string const& fallback = option.get_default_str();
  return {left, option.get_description() + (fallback.empty() ? "" : fmt::format(" (default: {})", fallback))};
}

/// "FOLDER...", "[CODE]": as it stands in the usage.
std::string usage_of(CLI::Option const& option) {
  std::string const name = option.get_name(true) + (option.get_expected_max() > 1 ? "..." : "");
  return option.get_required() ? name : fmt::format("[{}]", name);
}

std::string indented(std::string const& lines) {
  std::istringstream in(lines);
  std::string out;
  for (std::string line; std::getline(in, line);) out += fmt::format("  {}\n", line);
  return out;
}

std::string verbs_page(CLI::App const& app) {
  std::string out = fmt::format("{}\n\nUsage: sysid COMMAND [OPTIONS] ...\n", app.get_description());
  std::size_t width = 0;
  for (CLI::App const* verb : app.get_subcommands({})) width = std::max(width, verb->get_name().size());
  std::string group;
  for (CLI::App const* verb : app.get_subcommands({})) {
    if (verb->get_group() != group) out += fmt::format("\n{}:\n", group = verb->get_group());
    out += table({{fmt::format("{:<{}}", verb->get_name(), width), verb->get_description()}});
  }
  std::vector<Row> options;
  for (CLI::Option const* option : app.get_options()) options.push_back(row_of(*option));
  return out + "\nOptions:\n" + table(options) + "\nExamples:\n" + indented(app.get_footer()) +
         "\n`sysid COMMAND --help` describes each command.\n";
}

std::string verb_page(CLI::App const& verb) {
  std::string usage = fmt::format("sysid {}", verb.get_name());
  std::vector<Row> arguments, options;
  for (CLI::Option const* option : verb.get_options()) {
    if (!shown(*option)) continue;
    (positional(*option) ? arguments : options).push_back(row_of(*option));
    if (positional(*option)) usage += " " + usage_of(*option);
  }
  // Those of the program work behind the verb, too.
  CLI::App const& program = *verb.get_parent();
  for (CLI::Option const* option : program.get_options())
    if (option != program.get_help_ptr() && option != program.get_version_ptr()) options.push_back(row_of(*option));
  std::rotate(options.begin(), options.begin() + 1, options.end());  // --help last
  std::string out = fmt::format("sysid {}: {}\n\nUsage: {} [OPTIONS]\n", verb.get_name(), verb.get_description(), usage);
  if (!arguments.empty()) out += "\n" + table(arguments);
  out += "\nOptions:\n" + table(options);
  return verb.get_footer().empty() ? out : out + "\nExamples:\n" + indented(verb.get_footer());
}

}  // namespace

std::string HelpPages::make_help(CLI::App const* app, std::string, CLI::AppFormatMode) const {
  return app->get_parent() == nullptr ? verbs_page(*app) : verb_page(*app);
}

}  // namespace sysid::cli
