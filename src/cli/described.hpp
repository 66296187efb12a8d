// Options as data: what the pages of --help, the manual and the completions of shells are made from.
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace sysid::cli {

/// An option or argument without CLI11's words for its type and its checks.
struct DescribedOption {
  std::string short_name, long_name;  // "-o", "--output"; both empty: an argument
  std::string value;                  // one word, "FOLDER"; of an argument its name; empty: a flag
  std::vector<std::string> choices;   // all values there are, where the option's check knows them
  std::string text;                   // what it is for, with its default
  bool required = false, many = false;

  bool is_argument() const { return short_name.empty() && long_name.empty(); }
  /// "-o, --output": as a row begins.
  std::string names(std::string_view between = ", ") const;
};

/// Of a command, in the order in which they were declared; those of the program, which work behind any command, then --help. Of the
/// program itself: its own, --help first. Options that are only for tests are left out.
std::vector<DescribedOption> described_options(CLI::App const& app);

/// "sysid explain [CODE]", without [OPTIONS].
std::string usage(CLI::App const& verb);

/// The commands of the program, in their order.
std::vector<CLI::App const*> commands_of(CLI::App const& program);

/// The lines of a text.
std::vector<std::string> lines_of(std::string const& text);

}  // namespace sysid::cli
