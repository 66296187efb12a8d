// Results of a text, exported as the command line would, and what other programs say of them.
#pragma once
#include <sys/stat.h>

#include <cstdio>
#include <fstream>
#include <iterator>

#include "app/running.hpp"
#include "exchange/export_netcdf.hpp"
#include "said_by.hpp"

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

  /// What the verb prints, of one folder in the results where it is named. draws 0: without the text.
  std::string export_all(int draws = 200, std::string const& folder = "") const {
    std::ostringstream out;
    ResultsFolder const found = find_results(options_.output / folder);
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

/// Debian's own, which has the packages that tests/run installs; another one of the PATH need not.
inline std::string const python = "/usr/bin/python3";

/// A Python with xarray, which is imported once for all that it is asked: that takes more than a second of a processor.
class PreparedPython {
 public:
  PreparedPython() {
    if (mkfifo(answers().c_str(), 0600) != 0) throw std::runtime_error("cannot make a pipe for the answers of Python");
    std::string const script = "'" + (scripts / "prepared.py").string() + "' '" + answers().string() + "'";
    // Where it cannot begin, the shell answers in its place.
    process_ = popen((python + " " + script + " 2>/dev/null || echo 1 > '" + answers().string() + "'").c_str(), "w");
    if (process_ == nullptr) throw std::runtime_error("cannot start " + python);
    began_ = answer().exit == 0;
  }
  ~PreparedPython() { pclose(process_); }
  PreparedPython(PreparedPython const&) = delete;
  PreparedPython& operator=(PreparedPython const&) = delete;
  bool began() const { return began_; }
  /// As `python ARGUMENTS` of a shell.
  Said ask(std::string const& arguments) {
    std::fputs((nlohmann::json(arguments).dump() + "\n").c_str(), process_);
    std::fflush(process_);
    return answer();
  }

 private:
  std::filesystem::path answers() const { return folder_.path() / "answers"; }
  Said answer() const {
    std::ifstream in(answers());  // waits until somebody writes
    Said said;
    in >> said.exit;
    in.get();
    said.text.assign(std::istreambuf_iterator<char>(in), {});
    return said;
  }
  TemporaryFolder folder_;
  FILE* process_ = nullptr;
  bool began_ = false;
};

inline PreparedPython& prepared_python() {
  static PreparedPython python;
  return python;
}
inline bool has_xarray() { return prepared_python().began(); }
inline Said said_by_python(std::string const& arguments) { return prepared_python().ask(arguments); }

inline bool has_posterior() {
  static bool const found = said_by("Rscript --vanilla -e 'library(posterior)'").exit == 0;
  return found;
}

}  // namespace sysid::testing
