// Pages about the language, on screens of any width.
#include <doctest/doctest.h>

#include <sstream>
#include <vector>

#include "cli/asked.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

std::vector<std::string> lines_of(std::string const& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

}  // namespace

TEST_CASE("on a terminal sources of a page stay whole, and its prose is filled") {
  Desk const desk;
  Said const page = desk.ask("document hysteresis"), shown = desk.ask_on_terminal("document hysteresis", 60);
  CHECK(shown.exit == 0);
  bool fenced = false;
  for (std::string const& line : lines_of(page.text)) {
    if (line.starts_with("```")) fenced = !fenced;
    if (fenced) CHECK_MESSAGE(shown.text.find("\n" + line + "\n") != std::string::npos, line);
  }
  fenced = false;
  for (std::string const& line : lines_of(shown.text)) {
    if (line.starts_with("```")) fenced = !fenced;
    if (!fenced && !line.starts_with("|") && !line.starts_with("#")) CHECK_MESSAGE(line.size() <= 70, line);  // a link is longer
  }
  std::string const example = "    let stiffness_of_the_upper_spring_stiffness";
  CHECK(desk.ask_on_terminal("explain E1127", 80).text.find(example) != std::string::npos);
}

TEST_CASE("rows of a table go on below their own sentence") {
  Desk const desk;
  Said const shown = desk.ask_on_terminal("list backends", 60);
  CHECK(shown.text.find(
            "  burn_in    5000       first iterations, discarded; the\n                        proposal adapts during them\n") !=
        std::string::npos);
  std::string const whole = desk.ask("list backends").text;
  CHECK(whole.find("discarded; the proposal adapts during them\n") != std::string::npos);
  // A default is shown as a task writes it.
  for (std::string const line : {"  cross_check      yes ", "  polish           no "})
    CHECK_MESSAGE(whole.find(line) != std::string::npos, line);
}
