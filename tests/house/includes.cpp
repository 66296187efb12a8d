// The layers: which room (a folder of src/, or the grammar) may include which, and who alone may include Boost.Spirit, SUNDIALS,
// NLopt, netCDF and matio. Read from the #include lines.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/system/files.hpp"

namespace {

/// A room and the rooms that it may include beside itself; "core": all of core/. From the bottom up: a room rests on earlier ones.
std::vector<std::pair<std::string, std::set<std::string>>> const rooms = {
    {"core/text", {}},
    {"core/numeric", {"core/text"}},
    {"core/system", {"core/text"}},
    {"core/setting", {"core/text"}},
    {"core/ranks", {"core/text", "core/system"}},
    {"core/ranks/mpi", {"core/ranks"}},
    {"linear_algebra", {"core"}},
    {"result", {"core"}},
    {"criteria", {"core", "result"}},
    {"report/text", {"core", "result"}},
    {"data/cell", {"core"}},
    {"data/table", {"core", "data/cell"}},
    {"data/format", {"core", "data/table"}},
    {"data/format/libraries", {"data/format"}},
    {"data", {"core", "data/cell", "data/table", "data/format"}},
    {"data/look", {"core", "data/cell", "data/table", "data/format"}},
    {"expression", {"core"}},
    {"function", {"core", "expression"}},
    {"gaussian_process", {"core", "linear_algebra", "expression", "function"}},
    {"distribution", {"core", "expression", "function"}},
    {"model", {"core", "expression", "gaussian_process", "distribution"}},
    {"syntax", {"core"}},
    {"grammar/message", {"core", "syntax"}},
    {"grammar", {"core", "syntax", "grammar/message"}},
    {"grammar/format", {"core", "syntax", "grammar/message"}},
    {"regression/column", {"core", "linear_algebra", "data", "expression"}},
    {"regression/weak", {"core", "linear_algebra", "data", "regression/column"}},
    {"regression/choice", {"core", "linear_algebra"}},
    {"regression", {"core", "linear_algebra", "data", "regression/column", "regression/weak", "regression/choice"}},
    {"solver", {"core", "expression"}},
    {"program/bytecode", {"expression"}},
    {"program/interpreter", {"core", "program/bytecode"}},
    {"native", {"core/system", "program/bytecode"}},
    {"native/llvm", {"expression", "program/bytecode", "native"}},
    {"program", {"core", "expression", "solver", "program/bytecode", "program/interpreter", "native"}},
    {"program/moments", {"core", "expression", "solver", "program"}},
    {"simulate/lengths", {"native", "program/interpreter", "program"}},
    {"simulate", {"core", "data", "expression", "solver", "program/interpreter", "native", "program", "simulate/lengths"}},
    {"likelihood",
     {"core", "linear_algebra", "result", "data", "expression", "function", "distribution", "model", "solver", "program",
      "program/moments", "simulate"}},
    {"likelihood/process", {"core", "gaussian_process", "model", "simulate", "likelihood"}},
    {"likelihood/segments", {"core", "linear_algebra", "data", "simulate", "likelihood"}},
    {"likelihood/selection", {"core", "data", "model", "simulate", "likelihood"}},
    {"likelihood/smoothing", {"core", "result", "expression", "model", "program", "simulate", "likelihood"}},
    {"likelihood/particle",
     {"core", "data", "expression", "distribution", "model", "program", "simulate", "likelihood", "likelihood/smoothing"}},
    {"tracking",
     {"core", "linear_algebra", "data", "expression", "function", "distribution", "model", "solver", "program", "program/moments",
      "simulate"}},
    {"check/message", {"core", "function", "distribution", "syntax"}},
    {"check/elaborate", {"core", "function", "syntax", "check/message"}},
    {"check/checked",
     {"core", "data", "data/table", "expression", "distribution", "model", "syntax", "regression/column", "solver"}},
    {"check/units", {"core", "expression", "syntax", "check/message"}},
    {"check/expression",
     {"core", "expression", "function", "distribution", "model", "syntax", "check/message", "check/checked", "check/units"}},
    {"check/process",
     {"core", "expression", "gaussian_process", "model", "syntax", "check/message", "check/elaborate", "check/units",
      "check/expression"}},
    {"check/model",
     {"core", "expression", "model", "syntax", "check/message", "check/elaborate", "check/units", "check/expression",
      "check/process"}},
    {"check/dictionary",
     {"core", "expression", "function", "distribution", "syntax", "regression/column", "check/message", "check/elaborate",
      "check/checked", "check/units", "check/expression"}},
    {"check/data", {"core", "data", "data/table", "syntax", "check/message", "check/checked", "check/units", "check/expression"}},
    {"check/task",
     {"core", "data", "model", "solver", "syntax", "check/message", "check/units", "check/elaborate", "check/checked",
      "check/expression", "check/model", "check/data"}},
    {"check",
     {"core", "syntax", "check/message", "check/elaborate", "check/checked", "check/units", "check/model", "check/dictionary",
      "check/data", "check/task"}},
    {"search", {"core", "linear_algebra", "result", "gaussian_process", "likelihood"}},
    {"search/global", {"core", "linear_algebra", "result", "likelihood", "search"}},
    {"search/hierarchy", {"linear_algebra", "likelihood", "search", "search/global"}},
    {"search/improper", {"core", "linear_algebra", "result", "likelihood", "search"}},
    {"search/mode", {"core", "result", "search"}},
    {"diagnostics/law", {"core", "result", "model"}},
    {"diagnostics/residuals", {"core", "result", "data", "distribution", "model", "likelihood", "diagnostics/law"}},
    {"diagnostics",
     {"core", "linear_algebra", "result", "data", "distribution", "model", "solver", "likelihood", "likelihood/smoothing", "search",
      "diagnostics/residuals"}},
    {"diagnostics/identifiability", {"core", "linear_algebra", "result", "model", "likelihood"}},
    {"diagnostics/inputs", {"core", "data", "result", "model", "likelihood", "search"}},
    {"diagnostics/tolerance",
     {"core", "linear_algebra", "result", "data", "expression", "model", "solver", "likelihood", "search", "search/mode",
      "diagnostics"}},
    {"diagnostics/calibration", {"core", "result", "diagnostics"}},
    {"inference/backend", {"core", "result", "likelihood", "likelihood/selection", "search", "diagnostics"}},
    {"inference/evidence", {"core", "linear_algebra", "result", "distribution", "program", "likelihood", "search", "diagnostics"}},
    {"inference/chain",
     {"core", "linear_algebra", "result", "likelihood", "search", "search/global", "diagnostics", "inference/backend",
      "inference/evidence"}},
    {"inference/nuts",
     {"core", "linear_algebra", "result", "likelihood", "search", "diagnostics", "inference/backend", "inference/chain"}},
    {"inference/abc", {"core", "linear_algebra", "likelihood/selection", "inference/backend"}},
    {"inference/jump",
     {"core", "linear_algebra", "result", "likelihood", "search", "inference/backend", "inference/chain", "inference/evidence"}},
    {"inference",
     {"core", "linear_algebra", "result", "likelihood", "search", "search/global", "search/mode", "diagnostics",
      "inference/backend", "inference/chain", "inference/nuts", "inference/abc", "inference/evidence", "inference/jump"}},
    {"load",
     {"core", "syntax", "regression/column", "regression/choice", "check/message", "check/elaborate", "check/checked", "check",
      "inference"}},
    {"experiment",
     {"core", "result", "data", "data/cell", "data/table", "model", "solver", "syntax", "regression/column", "likelihood",
      "diagnostics/residuals", "check/checked", "check/units"}},
    {"mechanics", {"core", "result", "data", "model", "likelihood"}},
    {"discovery/preparation", {"core", "linear_algebra", "data", "check/checked", "regression", "experiment"}},
    {"discovery",
     {"core",
      "linear_algebra",
      "result",
      "report/text",
      "data",
      "model",
      "syntax",
      "regression/column",
      "regression",
      "simulate",
      "likelihood/segments",
      "check/elaborate",
      "check/checked",
      "check/expression",
      "diagnostics",
      "diagnostics/residuals",
      "diagnostics/tolerance",
      "load",
      "experiment",
      "discovery/preparation"}},
    {"discovery/search", {"core", "linear_algebra", "result", "simulate", "likelihood/segments", "discovery"}},
    {"typeset", {"core", "result", "syntax"}},
    {"report/figure", {"core", "result", "report/text", "diagnostics", "diagnostics/residuals"}},
    {"report/page", {"core", "result", "report/text", "diagnostics", "diagnostics/residuals", "report/figure"}},
    {"report/file", {"core", "result", "report/text", "diagnostics", "report/figure", "report/page"}},
    {"app/session",
     {"core",
      "load",
      "result",
      "data",
      "likelihood/particle",
      "gaussian_process",
      "model",
      "syntax",
      "regression/column",
      "regression/choice",
      "solver",
      "program",
      "simulate",
      "likelihood",
      "likelihood/process",
      "check/checked",
      "check/task",
      "search",
      "diagnostics",
      "diagnostics/residuals",
      "diagnostics/tolerance",
      "inference/backend",
      "inference",
      "experiment",
      "typeset",
      "report/figure",
      "report/page",
      "report/file"}},
    {"app/process",
     {"core", "linear_algebra", "result", "data", "gaussian_process", "model", "program", "simulate", "likelihood",
      "likelihood/process", "diagnostics", "diagnostics/residuals", "inference/backend", "experiment", "app/session"}},
    {"app/search",
     {"core", "data/cell", "likelihood", "search", "search/global", "diagnostics/tolerance", "inference/backend", "app/session"}},
    {"app/selection",
     {"core",
      "result",
      "criteria",
      "data",
      "model",
      "likelihood",
      "likelihood/selection",
      "search",
      "search/global",
      "diagnostics",
      "diagnostics/residuals",
      "diagnostics/tolerance",
      "inference/backend",
      "inference/chain",
      "inference",
      "experiment",
      "mechanics",
      "report/file",
      "app/session",
      "app/search",
      "app/process"}},
    {"app/preflight",
     {"core",
      "linear_algebra",
      "result",
      "data",
      "data/cell",
      "data/table",
      "expression",
      "gaussian_process",
      "model",
      "syntax",
      "simulate",
      "likelihood",
      "likelihood/particle",
      "search",
      "check/expression",
      "diagnostics",
      "diagnostics/identifiability",
      "diagnostics/tolerance",
      "experiment",
      "discovery",
      "app/session",
      "app/search",
      "app/process"}},
    {"app/fit",
     {"core",
      "linear_algebra",
      "result",
      "criteria",
      "data",
      "model",
      "likelihood",
      "likelihood/particle",
      "likelihood/smoothing",
      "search",
      "search/global",
      "search/hierarchy",
      "search/improper",
      "diagnostics",
      "diagnostics/residuals",
      "diagnostics/law",
      "diagnostics/identifiability",
      "diagnostics/inputs",
      "diagnostics/tolerance",
      "inference/backend",
      "inference",
      "inference/evidence",
      "experiment",
      "mechanics",
      "app/session",
      "app/search",
      "app/process",
      "app/preflight"}},
    {"app/task",
     {"core",
      "result",
      "data",
      "gaussian_process",
      "model",
      "syntax",
      "regression",
      "likelihood",
      "likelihood/particle",
      "likelihood/process",
      "check/checked",
      "diagnostics",
      "load",
      "experiment",
      "mechanics",
      "discovery",
      "discovery/preparation",
      "discovery/search",
      "report/file",
      "app/session",
      "app/process",
      "app/fit"}},
    {"app/record", {"core", "data/look", "report/figure"}},
    {"app/comparison", {"core", "result", "criteria", "model", "report/page", "report/file", "app/session"}},
    {"app/average",
     {"core", "result", "criteria", "data", "model", "likelihood", "check/checked", "diagnostics", "experiment", "report/file",
      "app/session", "app/comparison"}},
    {"app/calibration",
     {"core", "result", "data", "model", "simulate", "likelihood", "likelihood/particle", "check/checked", "diagnostics",
      "diagnostics/calibration", "inference/backend", "inference", "experiment", "report/file", "app/session", "app/fit"}},
    {"app/tracking",
     {"core", "result", "data", "data/table", "data/format", "expression", "distribution", "model", "program", "simulate",
      "likelihood", "tracking", "check/checked", "experiment", "report/file", "app/session"}},
    {"app/catalogue",
     {"core", "data/table", "function", "gaussian_process", "distribution", "model", "syntax", "regression/column",
      "regression/choice", "solver", "check/elaborate", "check/dictionary", "inference", "load"}},
    {"app/run",
     {"core", "result", "model", "syntax", "likelihood", "check/checked", "load", "experiment", "report/figure", "report/page",
      "report/file", "app/session", "app/selection", "app/preflight", "app/task", "app/comparison", "app/average"}},
    {"app/disturbed",
     {"core", "result", "data", "likelihood", "syntax", "check/checked", "load", "experiment", "report/page", "report/file",
      "app/session", "app/comparison", "app/run"}},
    {"exchange",
     {"core", "result", "data/format", "expression", "model", "simulate", "likelihood", "diagnostics", "experiment", "report/file",
      "app/session", "app/process", "app/selection"}},
    {"app/density",
     {"core", "model", "solver", "likelihood", "search", "diagnostics", "inference", "experiment", "app/session", "app/fit"}},
    {"assist", {"core",
                "data",
                "data/table",
                "function",
                "gaussian_process",
                "distribution",
                "model",
                "syntax",
                "grammar",
                "grammar/message",
                "regression/column",
                "regression/choice",
                "solver",
                "check/elaborate",
                "check/checked",
                "check/units",
                "check/expression",
                "check/model",
                "check/dictionary",
                "check/task",
                "inference",
                "load",
                "app/session",
                "app/catalogue"}},
    {"repl/work", {"core", "syntax"}},
    {"repl", {"core",          "report/text",      "data",        "data/table",    "data/format",    "syntax",
              "check/checked", "check/expression", "check/task",  "diagnostics",   "load",           "experiment",
              "report/page",   "report/file",      "app/session", "app/preflight", "app/comparison", "app/catalogue",
              "app/run",       "app/disturbed",    "assist",      "repl/work"}},
    {"lsp", {"core", "syntax", "assist"}},
    {"cli", {"core",         "syntax",        "app/record",  "diagnostics",   "inference",     "load",           "experiment",
             "typeset",      "report/figure", "report/page", "app/session",   "app/preflight", "app/comparison", "app/calibration",
             "app/tracking", "app/catalogue", "app/run",     "app/disturbed", "exchange",      "repl",           "lsp"}},
    {"embed",
     {"core", "data/cell", "data/table", "syntax", "likelihood", "check/checked", "load", "experiment", "app/session",
      "app/density"}},
    {"library", {"core", "embed"}},
    {"python",
     {"core", "syntax", "check/checked", "diagnostics/tolerance", "typeset", "report/page", "app/preflight", "app/comparison",
      "app/catalogue", "app/run", "assist", "exchange", "embed"}},
};

/// The one room, or two with a blank between them, that may include headers that begin like this.
std::pair<std::string, std::string> const owned[] = {
    {"<boost/spirit", "grammar"},
    {"<nlopt", "gaussian_process"},
    {"<netcdf", "data/format"},
    {"<matio", "data/format"},
    {"<zlib", "data/table data/format"},
    {"<cvode", "simulate"},
    {"<ida", "simulate"},
    {"<arkode", "simulate"},
    {"<nvector", "simulate"},
    {"<sunmatrix", "simulate"},
    {"<sunlinsol", "simulate"},
    {"<sundials", "simulate"},
    {"<llvm", "native/llvm"},
    {"<mpi", "core/ranks/mpi"},
    {"<pybind11", "python"},
    // Decompositions, the slowest of Eigen's templates to compile.
    {"<Eigen/Dense", "linear_algebra"},
    {"<Eigen/Cholesky", "linear_algebra"},
    {"<Eigen/Eigen", "linear_algebra"},
    {"<Eigen/LU", "linear_algebra"},
    {"<Eigen/QR", "linear_algebra"},
    {"<Eigen/SVD", "linear_algebra"},
};

std::set<std::string> const* allowed(std::string const& room) {
  auto const row = std::find_if(rooms.begin(), rooms.end(), [&](auto const& each) { return each.first == room; });
  return row == rooms.end() ? nullptr : &row->second;
}

/// What is wrong with a line of a file in `room`; empty: nothing.
std::string wrong(std::string const& room, std::string const& line) {
  static std::regex const own("^#include \"([a-z_/]+)/[^/\"]*\"");
  for (auto const& [header, owner] : owned)
    if (line.starts_with("#include " + header) && (" " + owner + " ").find(" " + room + " ") == std::string::npos)
      return room + " includes " + header + ", which is for " + owner;
  std::smatch match;
  if (!std::regex_search(line, match, own) || match[1] == room) return {};
  std::set<std::string> const* may = allowed(room);
  if (may == nullptr) return room + " is not listed";
  if (may->contains(match[1])) return {};
  if (match[1].str().starts_with("core/") && may->contains("core")) return {};
  return room + " includes " + match[1].str();
}

}  // namespace

TEST_CASE("a room rests on rooms below it") {
  std::set<std::string> below;
  for (auto const& [room, may] : rooms) {
    CAPTURE(room);
    for (std::string const& each : may) {
      CAPTURE(each);
      CHECK((below.contains(each) || (each == "core" && below.contains("core/setting"))));
    }
    CHECK(below.insert(room).second);
  }
}

TEST_CASE("includes point one way, and every folder of sources is a room") {
  std::filesystem::path const root(SYSID_SOURCE_DIR);
  int lines = 0;
  std::set<std::string> seen;
  for (std::filesystem::path const& place : {root / "src", root / "grammar"})
    for (auto const& entry : std::filesystem::recursive_directory_iterator(place)) {
      std::string const extension = entry.path().extension().string();
      if (extension != ".cpp" && extension != ".hpp") continue;
      std::string const room = entry.path().parent_path().lexically_relative(place == root / "src" ? place : root).string();
      CAPTURE(entry.path().string());
      CHECK(allowed(room) != nullptr);
      seen.insert(room);
      std::istringstream text(sysid::read_file(entry.path()));
      for (std::string line; std::getline(text, line);) {
        if (!line.starts_with("#include")) continue;
        ++lines;
        CHECK(wrong(room, line) == "");
        // What samplers see of a model, and no more: neither the language nor the model itself.
        if (room.starts_with("inference") && line.starts_with("#include \"likelihood/"))
          CHECK((line.find("likelihood/target.hpp") != line.npos || line.find("selection/selection_target.hpp") != line.npos));
      }
    }
  CHECK(lines > 3000);
  for (auto const& [room, may] : rooms) {
    CAPTURE(room);
    CHECK(seen.contains(room));
  }
}

TEST_CASE("tests leave decompositions of matrices to linear_algebra as well") {
  std::filesystem::path const root = std::filesystem::path(SYSID_SOURCE_DIR) / "tests";
  int lines = 0;
  for (auto const& entry : std::filesystem::recursive_directory_iterator(root)) {
    std::string const folder = entry.path().parent_path().lexically_relative(root).string();
    if (entry.path().extension() != ".cpp" || folder == "linear_algebra") continue;
    CAPTURE(entry.path().string());
    std::istringstream text(sysid::read_file(entry.path()));
    for (std::string line; std::getline(text, line); ++lines)
      if (line.starts_with("#include <Eigen/")) CHECK(wrong("search", line) == "");
  }
  CHECK(lines > 10'000);
}

// The library runs in programs whose locale has decimal commas.
TEST_CASE("no source reads numbers by the locale of the process") {
  std::filesystem::path const root = std::filesystem::path(SYSID_SOURCE_DIR) / "src";
  int lines = 0;
  for (auto const& entry : std::filesystem::recursive_directory_iterator(root)) {
    if (entry.path().extension() != ".cpp" && entry.path().extension() != ".hpp") continue;
    CAPTURE(entry.path().string());
    std::istringstream text(sysid::read_file(entry.path()));
    for (std::string line; std::getline(text, line); ++lines)
      for (char const* const each : {"strtod(", "stod(", "strtof(", "stof(", "atof("}) {
        CAPTURE(line);
        CHECK(line.find(each) == std::string::npos);
      }
  }
  CHECK(lines > 50'000);
}

TEST_CASE("an include that points upwards is found") {
  CHECK(wrong("result", "#include \"report/page/html.hpp\"") == "result includes report/page");
  CHECK(wrong("model", "#include \"syntax/ast.hpp\"") == "model includes syntax");
  CHECK(wrong("core/text", "#include \"core/numeric/unit.hpp\"") == "core/text includes core/numeric");
  CHECK(wrong("cellar", "#include \"core/text/source.hpp\"") == "cellar is not listed");
  CHECK(wrong("check", "#include <boost/spirit/home/x3.hpp>") == "check includes <boost/spirit, which is for grammar");
  CHECK(wrong("search", "#include <Eigen/Dense>") == "search includes <Eigen/Dense, which is for linear_algebra");
  CHECK(wrong("check", "#include \"core/text/source.hpp\"").empty());
}

TEST_CASE("a folder of sources is small enough to find a thing in") {
  std::filesystem::path const root(SYSID_SOURCE_DIR);
  for (auto const& [room, may] : rooms) {
    std::filesystem::path const place = room.starts_with("grammar") ? root / room : root / "src" / room;
    int files = 0, lines = 0;
    for (auto const& entry : std::filesystem::directory_iterator(place)) {
      if (!entry.is_regular_file()) continue;
      ++files;
      std::string const text = sysid::read_file(entry.path());
      if (entry.path().extension() != ".json") lines += static_cast<int>(std::count(text.begin(), text.end(), '\n'));
    }
    CAPTURE(room);
    CHECK(files <= 40);
    CHECK(lines <= 4000);
  }
}
