// The layers: which folder may include which, and who alone may include Boost.Spirit, SUNDIALS and NLopt. Read from the #include
// lines.
#include <doctest/doctest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "core/files.hpp"

namespace {

using Folders = std::set<std::string>;

std::map<std::string, Folders> const allowed = {
    {"core", {"core"}},
    {"data", {"data", "core"}},
    {"expression", {"expression", "core"}},
    {"function", {"function", "expression", "core"}},
    {"distribution", {"distribution", "function", "expression", "core"}},
    {"model", {"model", "gaussian_process", "distribution", "function", "expression", "core"}},
    {"syntax", {"syntax", "core"}},
    {"grammar", {"grammar", "syntax", "core"}},
    {"check",
     {"check", "regression", "syntax", "model", "gaussian_process", "data", "distribution", "function", "expression", "core"}},
    {"program", {"program", "model", "distribution", "function", "expression", "core"}},
    {"simulate", {"simulate", "program", "data", "expression", "core"}},
    {"likelihood",
     {"likelihood", "simulate", "program", "model", "gaussian_process", "linear_algebra", "data", "distribution", "function",
      "expression", "core"}},
    {"regression", {"regression", "linear_algebra", "data", "expression", "core"}},
    {"linear_algebra", {"linear_algebra", "core"}},
    {"gaussian_process", {"gaussian_process", "linear_algebra", "function", "expression", "core"}},
    {"inference", {"inference", "likelihood", "gaussian_process", "linear_algebra", "core"}},
    {"assist",
     {"assist", "app", "check", "grammar", "syntax", "inference", "regression", "gaussian_process", "distribution", "function",
      "data", "core"}},
    {"lsp", {"lsp", "assist", "syntax", "core"}},
    {"repl", {"repl", "assist", "app", "check", "syntax", "report", "inference", "data", "core"}},
    {"app",
     {"app", "report", "typeset", "check", "syntax", "regression", "inference", "likelihood", "gaussian_process", "simulate",
      "program", "model", "linear_algebra", "data", "distribution", "function", "expression", "core"}},
    {"typeset", {"typeset", "syntax", "core"}},
    {"report", {"report", "typeset", "inference", "likelihood", "core"}},
    {"cli", {"cli", "exchange", "repl", "lsp", "app", "report", "typeset", "syntax", "core"}},
    {"exchange", {"exchange", "app", "report", "typeset", "inference", "likelihood", "simulate", "expression", "syntax", "core"}},
};

}  // namespace

TEST_CASE("includes point one way, Boost.Spirit stays in grammar/ and SUNDIALS in src/simulate/") {
  std::filesystem::path const root(SYSID_SOURCE_DIR);
  std::regex const own("^#include \"([a-z_]+)/[^\"]*\"");
  int lines = 0;
  for (auto const& [folder, may] : allowed) {
    auto const place = folder == "grammar" ? root / folder : root / "src" / folder;
    for (auto const& entry : std::filesystem::recursive_directory_iterator(place)) {
      std::string const extension = entry.path().extension().string();
      if (extension != ".cpp" && extension != ".hpp") continue;
      std::istringstream text(sysid::read_file(entry.path()));
      for (std::string line; std::getline(text, line);) {
        CAPTURE(entry.path().string());
        CAPTURE(line);
        std::smatch match;
        if (std::regex_search(line, match, own)) {
          ++lines;
          CHECK(may.contains(match[1].str()));
          // A back end sees one header of likelihood/ beside the further views.
          if (folder == "inference" || folder == "report")
            if (match[1].str() == "likelihood")
              CHECK((line.find("likelihood/target.hpp") != std::string::npos ||
                     line.find("likelihood/selection_target.hpp") != std::string::npos));
        }
        if (line.starts_with("#include <boost/spirit")) CHECK(folder == "grammar");
        if (line.starts_with("#include <nlopt")) CHECK(folder == "gaussian_process");
        if (line.starts_with("#include <netcdf")) CHECK(folder == "exchange");
        for (char const* header : {"<cvode", "<ida", "<arkode", "<nvector", "<sunmatrix", "<sunlinsol", "<sundials"})
          if (line.starts_with(std::string("#include ") + header)) CHECK(folder == "simulate");
      }
    }
  }
  CHECK(lines > 300);
}
