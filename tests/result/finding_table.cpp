// The table of findings against the sources: every finding that is made has a severity of its row.
#include "result/finding_table.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>

using namespace sysid;

TEST_CASE("every finding that the sources make has a severity that its row allows") {
  std::map<std::string, Severity> const severities = {
      {"error", Severity::error}, {"warning", Severity::warning}, {"note", Severity::note}};
  // `FindingCode::x, Severity::y`, and in tables that name the severity first `Severity::y, FindingCode::x`.
  std::regex const made(
      "FindingCode::(\\w+),\\s*((?:[^,;]|, (?=\\w+\\)))*Severity::\\w+[^,;]*),|Severity::(\\w+), FindingCode::(\\w+)");
  std::regex const each_severity("Severity::(\\w+)");
  std::set<std::string> seen;
  for (auto const& entry : std::filesystem::recursive_directory_iterator(std::filesystem::path(SYSID_SOURCE_DIR) / "src")) {
    if (entry.path().extension() != ".cpp" && entry.path().extension() != ".hpp") continue;
    std::ifstream file(entry.path());
    std::string const text((std::istreambuf_iterator<char>(file)), {});
    for (std::sregex_iterator i(text.begin(), text.end(), made), end; i != end; ++i) {
      std::string const code = (*i)[1].matched ? (*i)[1].str() : (*i)[4].str();
      std::string const severity = (*i)[1].matched ? (*i)[2].str() : "Severity::" + (*i)[3].str();
      auto const known = finding_code(code);
      for (std::sregex_iterator s(severity.begin(), severity.end(), each_severity); s != end; ++s)
        CHECK_MESSAGE(row_of(*known).severities.contains(severities.at((*s)[1].str())),
                      entry.path().string() << ": " << code << " with " << (*s)[1].str());
      seen.insert(code);
    }
  }
  // Of these the code or the severity is computed.
  for (std::string const code : {"chains_disagree", "ess_bulk_low", "ess_tail_low", "worse_than_the_mean", "failed_predictions"})
    CHECK_MESSAGE(seen.insert(code).second, code);
  for (FindingRow const& row : finding_table()) CHECK_MESSAGE(seen.contains(std::string(row.word)), row.word);
}
