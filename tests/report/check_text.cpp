// The page of a check, in lines for a terminal.
#include <doctest/doctest.h>

#include "report/page/check_page.hpp"

using namespace sysid;

TEST_CASE("a duration is told in the parts that it has") {
  CheckPage page;
  page.tasks.emplace_back();
  page.tasks[0].coverage.emplace_back();
  page.tasks[0].preflights.emplace_back();
  page.tasks[0].preflights[0].processes.emplace_back().rows = 100;
  for (auto const& [seconds, said] :
       {std::pair(0.02, "and 20 ms,"), std::pair(12.0, "and 0:12 (min:s),"), std::pair(3612.0, "and 1:00:12 (h:min:s),")}) {
    page.tasks[0].preflights[0].processes[0].seconds = seconds;
    CAPTURE(seconds);
    CHECK(check_text(page).find(said) != std::string::npos);
  }
}
