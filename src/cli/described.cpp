// CLI11 keeps the names, the word for the value and the set of values of an option in one string each.
#include "cli/described.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

namespace sysid::cli {
namespace {

bool shown(CLI::Option const& option) { return !option.get_group().empty(); }

/// Of "NAME:{scalar,lanes}" what stands in braces.
std::vector<std::string> choices_in(std::string const& type) {
  auto const open = type.find(":{"), close = type.find('}');
  if (open == std::string::npos || close == std::string::npos) return {};
  std::istringstream in(type.substr(open + 2, close - open - 2));
  std::vector<std::string> choices;
  for (std::string choice; std::getline(in, choice, ',');) choices.push_back(choice);
  return choices;
}

DescribedOption described(CLI::Option const& option) {
  DescribedOption made;
  std::string const type = option.get_type_name(), &fallback = option.get_default_str();
  if (!option.get_snames().empty()) made.short_name = "-" + option.get_snames().front();
  if (!option.get_lnames().empty()) made.long_name = "--" + option.get_lnames().front();
  if (!option.nonpositional())
    made.value = option.get_name(true);
  else if (option.get_items_expected_max() > 0)
    made.value = type.substr(0, type.find(':'));
  made.choices = choices_in(type);
  made.text = option.get_description() + (fallback.empty() ? "" : fmt::format(" (default: {})", fallback));
  made.required = option.get_required();
  made.many = option.get_expected_max() > 1;
  return made;
}

}  // namespace

std::string DescribedOption::names(std::string_view between) const {
  if (short_name.empty() || long_name.empty()) return short_name + long_name;
  return fmt::format("{}{}{}", short_name, between, long_name);
}

std::vector<DescribedOption> described_options(CLI::App const& app) {
  std::vector<DescribedOption> options;
  for (CLI::Option const* option : app.get_options())
    if (shown(*option)) options.push_back(described(*option));
  CLI::App const* const program = app.get_parent();
  if (program == nullptr) return options;
  for (CLI::Option const* option : program->get_options())
    if (option != program->get_help_ptr() && option != program->get_version_ptr()) options.push_back(described(*option));
  std::rotate(options.begin(), options.begin() + 1, options.end());
  return options;
}

std::string usage(CLI::App const& verb) {
  std::string text = "sysid " + verb.get_name();
  for (DescribedOption const& option : described_options(verb)) {
    if (!option.is_argument()) continue;
    std::string const name = option.value + (option.many ? "..." : "");
    text += " " + (option.required ? name : fmt::format("[{}]", name));
  }
  return text;
}

std::vector<CLI::App const*> commands_of(CLI::App const& program) { return program.get_subcommands({}); }

std::vector<std::string> lines_of(std::string const& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

}  // namespace sysid::cli
