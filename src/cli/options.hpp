// Options that several verbs have.
#pragma once
#include <CLI/CLI.hpp>

#include "app/session/options.hpp"

namespace sysid::cli {

void add_file(CLI::App& verb, std::string& file);
void add_output(CLI::App& verb, std::filesystem::path& folder, char const* help = "the folder for results");
void add_seed(CLI::App& verb, std::optional<std::uint64_t>& seed, char const* help);
void add_threads(CLI::App& verb, int& threads);
/// --figures and --no-figures; without: that there are none.
void add_figures(CLI::App& verb, RunOptions& run, char const* without);

/// What verbs that write results have in common.
struct ResultOptions {
  std::string file;
  bool quiet = false;
  RunOptions run;
};
void add_result_options(CLI::App& verb, ResultOptions& options);

// Checks of values: why one is refused, or empty.
std::string refuse_no_path(std::string const& path);
/// Where `text` is none of `names`, with a near one.
std::string refuse_other_name(std::string const& text, std::vector<std::string> const& names);
std::string refuse_no_duration(std::string const& text);

}  // namespace sysid::cli
