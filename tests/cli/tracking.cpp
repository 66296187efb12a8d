// `track` while its rows arrive: a kill leaves a table of whole lines, an interrupt its results.
#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>

#include "cli/asked.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

/// Follows grow.csv in the background, to which 200 rows are appended, and sends `signal` once 100 of them are in the table.
/// Prints the exit code.
std::string script(LineDesk const& desk, std::string const& signal) {
  std::string const table = "results/track/posterior/track.csv";
  return "cd '" + desk.path("").string() +
         "'; NO_COLOR=1; export NO_COLOR; (exec '" SYSID_PROGRAM
         "' track line.sysid results/posterior --record grow.csv --follow --no-figures -q) & pid=$!; "
         "i=0; while [ $i -lt 200 ]; do echo \"$i,$((2*i))\" >> grow.csv; i=$((i+1)); done; n=0; "
         "while [ $n -lt 400 ] && [ $(cat " +
         table + " 2>/dev/null | wc -l) -lt 120 ]; do sleep 0.05; n=$((n+1)); done; kill -" + signal +
         " $pid; wait $pid; echo exit $?";
}

std::vector<std::string> rows_of(std::string const& table) {
  std::istringstream text(table);
  std::vector<std::string> rows;
  for (std::string line; std::getline(text, line);)
    if (!line.starts_with('#')) rows.push_back(line);
  return rows;
}

}  // namespace

TEST_CASE("however a track that follows ends, its table has whole lines; an interrupt leaves the results as well") {
  for (char const* const signal : {"KILL", "TERM"}) {
    CAPTURE(signal);
    LineDesk const desk;
    REQUIRE(desk.ask("fit line.sysid -q --no-figures").exit <= 1);
    desk.save("grow.csv", "u,d\n");
    Said const said = said_by(script(desk, signal));
    std::string const table = read_file(desk.path("results/track/posterior/track.csv"));
    CHECK(table.ends_with('\n'));
    std::vector<std::string> const rows = rows_of(table);
    CHECK(rows.size() >= 80);
    REQUIRE(!rows.empty());
    auto const commas = std::count(rows.front().begin(), rows.front().end(), ',');
    for (std::string const& row : rows) CHECK(std::count(row.begin(), row.end(), ',') == commas);
    bool const killed = std::string(signal) == "KILL";
    CHECK(desk.has("results/track/posterior/summary.json") == !killed);
    if (killed)
      CHECK(said.text.find("exit 137") != std::string::npos);
    else
      CHECK((said.text.find("exit 0") != std::string::npos || said.text.find("exit 1\n") != std::string::npos));
  }
}
