// Results of a text, exported as the command line would, and what other programs say of them.
#pragma once
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <stdexcept>

#include "app/running.hpp"
#include "exchange/export.hpp"

namespace sysid::testing {

inline std::filesystem::path const models = std::filesystem::path(SYSID_SOURCE_DIR) / "models";
inline std::filesystem::path const scripts = std::filesystem::path(SYSID_SOURCE_DIR) / "tests/exchange";

/// Runs a text that lies beside its data, in a folder that stays as long as this.
class ExportedRun {
 public:
  ExportedRun(std::filesystem::path name, std::string text) : name_(std::move(name)), text_(std::move(text)) {
    options_.output = folder_.path() / "results";
    run_text(name_, text_, options_, {"fit", "select", "predict"});
  }

  std::filesystem::path results() const { return options_.output; }
  nlohmann::json summary(std::string const& task) const {
    return nlohmann::json::parse(read_file(options_.output / task / "summary.json"));
  }

  /// What the verb prints. draws 0: without the text.
  std::string export_all(int draws = 200) const {
    std::ostringstream out;
    ExportedResults const found = find_results(options_.output);
    require_exportable(found, true);
    Source source(name_.string(), text_);
    Diagnostics diagnostics;
    auto const file = load(source, diagnostics);
    if (!file) throw UserError(diagnostics.all().front());
    SilentProgress silent;
    std::ostream nowhere(nullptr);
    Session session(source, *file, options_, silent, nowhere, nowhere);
    export_netcdf(found, draws == 0 ? nullptr : &session, draws, out);
    return out.str();
  }

 private:
  TemporaryFolder folder_;
  std::filesystem::path name_;
  std::string text_;
  RunOptions options_;
};

struct Said {
  int exit = 0;
  std::string text;  // standard output and standard error
};

/// A shell's command and what it says.
inline Said said_by(std::string const& command) {
  FILE* const pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("cannot start " + command);
  Said said;
  std::array<char, 4096> buffer;
  while (std::size_t const count = std::fread(buffer.data(), 1, buffer.size(), pipe)) said.text.append(buffer.data(), count);
  int const status = pclose(pipe);
  said.exit = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  return said;
}

/// Debian's own, which has the packages that tests/run installs; another one of the PATH need not.
inline std::string const python = "/usr/bin/python3";

inline bool has_xarray() { return said_by(python + " -c 'import xarray, netCDF4'").exit == 0; }
inline bool has_posterior() { return said_by("Rscript --vanilla -e 'library(posterior)'").exit == 0; }

}  // namespace sysid::testing
