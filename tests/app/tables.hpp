// Columns of a table that a task wrote.
#pragma once
#include <doctest/doctest.h>

#include <sstream>
#include <string>
#include <vector>

namespace sysid {

/// By its name, comments left out.
inline std::vector<double> column(std::string const& csv, std::string const& name) {
  std::istringstream lines(csv);
  std::string line;
  std::vector<double> values;
  int wanted = -1;
  while (std::getline(lines, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream cells(line);
    std::string cell;
    for (int i = 0; std::getline(cells, cell, ','); ++i) {
      if (wanted < 0 && cell == name) {
        wanted = i;
        break;
      }
      if (i == wanted) values.push_back(std::stod(cell));
    }
  }
  CAPTURE(csv.substr(0, 600));
  REQUIRE_MESSAGE(wanted >= 0, name);
  return values;
}

}  // namespace sysid
