// A command line that cannot be understood: what is wrong with it and what was meant.
#pragma once
#include <CLI/CLI.hpp>

#include "cli/messages.hpp"

namespace sysid::cli {

/// Says why `app` could not read the command line, with near names of verbs and options. Exit code 2.
ExitCode misread(Messages const& messages, CLI::App const& app, CLI::ParseError const& error);

}  // namespace sysid::cli
