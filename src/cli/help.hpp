// The pages of --help: what a verb does, its options in a table, commands as one would type them.
#pragma once
#include <CLI/CLI.hpp>

namespace sysid::cli {

class HelpPages final : public CLI::FormatterBase {
 public:
  /// Of the program, whose verbs stand in their groups, or of a verb, whose examples are its footer, one a line. Options have one
  /// word for their value; what CLI11 adds about types and checks is left out.
  std::string make_help(CLI::App const* app, std::string name, CLI::AppFormatMode mode) const override;
};

}  // namespace sysid::cli
