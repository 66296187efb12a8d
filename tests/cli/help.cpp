// The pages of --help, for every verb that there is.
#include <doctest/doctest.h>

#include <sstream>
#include <vector>

#include "cli/asked.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

std::vector<std::string> const verbs = {
    "run", "simulate", "fit",    "select", "discover", "predict", "check",   "calibrate", "crosscheck", "fmt",        "repl",
    "lsp", "compare",  "report", "export", "track",    "list",    "explain", "document",  "manual",     "completion", "version"};

}  // namespace

TEST_CASE("the page of the program names every verb, in groups") {
  Said const said = Desk().ask("--help");
  CHECK(said.exit == 0);
  CHECK(said.text.find("Usage: sysid COMMAND [OPTIONS] ...\n") != std::string::npos);
  for (std::string const& verb : verbs) CHECK_MESSAGE(said.text.find("\n  " + verb + " ") != std::string::npos, verb);
  for (char const* group : {"Tasks of a file:", "Files:", "Results:", "Reference:", "Examples:"})
    CHECK_MESSAGE(said.text.find(group) != std::string::npos, group);
}

TEST_CASE("every verb has a page: what it does, its usage as one types it, options with one word for their value") {
  for (std::string const& verb : verbs) {
    CAPTURE(verb);
    Said const said = Desk().ask(verb + " --help");
    CHECK(said.exit == 0);
    CHECK(said.text.starts_with("sysid " + verb + ": "));
    CHECK(said.text.find("\nUsage: sysid " + verb) != std::string::npos);
    for (char const* of_cli11 : {"{", "...]", "TEXT", "UINT", "FLOAT", "INT", ":FLOAT", "build/"})
      CHECK_MESSAGE(said.text.find(of_cli11) == std::string::npos, of_cli11);
    std::istringstream lines(said.text);
    for (std::string line; std::getline(lines, line);) CHECK_MESSAGE(line.size() <= 96, line);
  }
}

TEST_CASE("a page says what holds without an option, and gives commands that work") {
  std::string const page = Desk().ask("fit --help").text;
  CHECK(page.find("-o, --output FOLDER") != std::string::npos);
  CHECK(page.find("(default: results)") != std::string::npos);
  CHECK(page.find("--no-figures ") != std::string::npos);
  CHECK(page.find("\nExamples:\n  sysid fit duffing.sysid --force\n") != std::string::npos);
  CHECK(Desk().ask("explain E2103").exit == 0);
}

TEST_CASE("without a verb the program shows its page and says by its exit code that nothing was done") {
  Said const said = Desk().ask("");
  CHECK(said.exit == 2);
  CHECK(said.text.find("Usage: sysid COMMAND") != std::string::npos);
}
