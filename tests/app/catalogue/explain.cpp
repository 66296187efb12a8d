// The pages of docs/errors: every code has a section, its bad example gives the code and its mended twin does not.
#include "app/catalogue/explain.hpp"

#include <doctest/doctest.h>

#include <regex>
#include <set>

#include "app/answer.hpp"
#include "result/finding.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

// Files of the frame, then those of the example, which may replace them.
void write_files(ErrorSection const& section, std::vector<Example> const& examples, std::filesystem::path const& folder) {
  for (std::vector<Example> const* blocks : {&section.frame, &examples})
    for (Example const& block : *blocks)
      if (std::string const name = block.file_name(); !name.empty()) write(folder / name, block.text);
}

Answer answer_to(ErrorSection const& section, std::vector<Example> const& examples, Depth depth) {
  TemporaryFolder const folder, output;
  write_files(section, examples, folder.path());
  WorkingFolder const here(folder.path());
  return answer("example.sysid", section.complete(examples), depth, output.path());
}

std::set<std::string> codes_in_sources() {
  std::set<std::string> codes;
  std::regex const code("\"(E[1-6][0-9]{3})\"");
  for (char const* folder : {"grammar", "src"})
    for (auto const& entry : std::filesystem::recursive_directory_iterator(std::filesystem::path(SYSID_SOURCE_DIR) / folder)) {
      if (entry.path().extension() != ".cpp") continue;
      std::string const text = content(entry.path());
      for (std::sregex_iterator match(text.begin(), text.end(), code), end; match != end; ++match) codes.insert((*match)[1]);
    }
  return codes;
}

std::set<std::string> codes_of_findings() {
  std::set<std::string> codes;
  for (FindingRow const& row : finding_table()) codes.emplace(row.word);
  return codes;
}

}  // namespace

TEST_CASE("every code of the sources and every finding of the table has one section, and every section one of them") {
  std::set<std::string> const codes = codes_in_sources(), findings = codes_of_findings();
  std::set<std::string> explained;
  for (ErrorSection const& section : error_sections()) {
    CAPTURE(section.code);
    CHECK(explained.insert(section.code).second);
    CHECK((section.of_finding() ? findings : codes).contains(section.code));
    CHECK_FALSE(section.title.empty());
  }
  for (std::set<std::string> const* all : {&codes, &findings})
    for (std::string const& code : *all) CHECK_MESSAGE(explained.contains(code), code);
}

TEST_CASE("the sections about findings stand in the order of the table, which finds its codes by their words") {
  std::vector<std::string> sections, rows;
  for (ErrorSection const& section : error_sections())
    if (section.of_finding()) sections.push_back(section.code);
  for (FindingRow const& row : finding_table()) {
    rows.emplace_back(row.word);
    CHECK(finding_code(row.word) == row.code);
    CHECK(word(row.code) == row.word);
  }
  CHECK(sections == rows);
  CHECK_FALSE(finding_code("no_such_finding"));
}

TEST_CASE("the page about the verdict names every finding") {
  std::string const methods = content(std::filesystem::path(SYSID_SOURCE_DIR) / "docs" / "methods" / "verdict.md");
  std::size_t const begin = methods.find("## Findings and exit codes");
  REQUIRE(begin != std::string::npos);
  std::string const table = methods.substr(begin, methods.find("\n## ", begin + 1) - begin);
  for (std::string const& code : codes_of_findings()) CHECK_MESSAGE(table.find("`" + code + "`") != std::string::npos, code);
}

TEST_CASE("the bad example of a section gives its code, once and alone, and the mended twin gives nothing") {
  // What a text cannot show, or not in a few lines: said in words on the page.
  std::set<std::string> const in_words = {"E1122", "E1123", "E1126", "E2109", "E2114", "E4003", "E4020", "E4023",
                                          "E4027", "E4028", "E5003", "E6201", "E6202", "E6206", "E6207", "E6208",
                                          "E6209", "E6210", "E6211", "E6212", "E6213", "E6214", "E6215"};
  for (ErrorSection const& section : error_sections()) {
    CAPTURE(section.code);
    if (section.of_finding()) continue;  // of results, which no text shows
    CHECK(section.bad.empty() == in_words.contains(section.code));
    CHECK(section.mended.empty() == section.bad.empty());
    if (section.bad.empty() || section.mended.empty()) continue;
    Depth depth = Depth::front;
    Answer bad = answer_to(section, section.bad, depth);
    for (Depth const deeper : {Depth::data, Depth::run})
      if (bad.messages.empty()) bad = answer_to(section, section.bad, depth = deeper);
    std::set<std::string> const warnings = {"E2120", "E2121", "E2210", "E2213", "E2214", "E3019", "E3021", "E3114", "E6019", "E6020"};
    std::string const severity = warnings.contains(section.code) ? "warning[" : "error[";
    std::size_t const unread_there = section.code == "E3019" ? 0 : count(bad.messages, "warning[E3019]");
    CHECK_MESSAGE(count(bad.messages, "error[") + count(bad.messages, "warning[") - unread_there == 1, bad.messages);
    CHECK_MESSAGE(count(bad.messages, severity + section.code + "]") == 1, bad.messages);
    Answer const mended = answer_to(section, section.mended, depth);
    // A few lines need not use all that they declare.
    std::size_t const unread = section.code == "E3019" ? 0 : count(mended.messages, "warning[E3019]");
    CHECK_MESSAGE(count(mended.messages, "error[") + count(mended.messages, "warning[") == unread, mended.messages);
    CHECK(mended.exit <= ExitCode::doubtful);
  }
}

TEST_CASE("a section is shown with its examples and the file they complete") {
  std::string const page =
      "# E2: names\n"
      "\n"
      "```sysid inside\n"
      "model m {\n"
      "  state y\n"
      "}\n"
      "```\n"
      "\n"
      "## E2001: unknown\n"
      "\n"
      "What it means.\n"
      "\n"
      "Bad:\n"
      "\n"
      "```sysid\n"
      "let a = b\n"
      "```\n"
      "\n"
      "Corrected:\n"
      "\n"
      "```sysid\n"
      "let a = y\n"
      "```\n"
      "\n"
      "# Another frame\n"
      "\n"
      "```sysid above\n"
      "model n { }\n"
      "```\n"
      "\n"
      "```csv n.csv\n"
      "t\n"
      "```\n"
      "\n"
      "## E2002: twice\n"
      "\n"
      "In words.\n";
  auto const sections = read_error_page(page);
  REQUIRE(sections.size() == 2);
  CHECK(sections[0].code == "E2001");
  CHECK(sections[0].title == "unknown");
  CHECK(sections[0].complete(sections[0].bad) == "model m {\n  state y\n  let a = b\n}\n");
  CHECK(sections[0].complete(sections[0].mended) == "model m {\n  state y\n  let a = y\n}\n");
  CHECK(sections[0].complete({{"sysid file", "model o { }\n"}}) == "model o { }\n");
  CHECK(sections[1].bad.empty());
  REQUIRE(sections[1].frame.size() == 2);
  CHECK(sections[1].complete({{"sysid", "fit n\n"}}) == "model n { }\nfit n\n");
}

TEST_CASE("explain finds a code however it is written") {
  auto const text = explain("E2001");
  REQUIRE(text.has_value());
  CHECK(text->starts_with("E2001: a name that is not declared\n"));
  CHECK(text->find("\nCorrected:\n\n    derive fn [Hz] = sqrt(k/m) / (2*pi)\n") != std::string::npos);
  CHECK(text->find("are part of the model of this file:\n\n    model oscillator {\n") != std::string::npos);
  CHECK(text->find("```") == std::string::npos);
  CHECK(explain("e2001") == text);
  CHECK(explain("2001") == text);
  CHECK_FALSE(explain("E9999").has_value());
  CHECK_FALSE(explain("").has_value());
}

TEST_CASE("a finding is explained by its word, and listed behind the codes") {
  auto const text = explain("chains_disagree");
  REQUIRE(text);
  CHECK(text->starts_with("chains_disagree: chains with different distributions\n"));
  CHECK(text->find("R-hat") != std::string::npos);
  CHECK_FALSE(explain("chains"));
  CHECK_FALSE(explain(""));
  std::string const all = list_codes();
  CHECK(all.find("E1101 ") < all.find("\nchain_did_not_move"));
  CHECK(all.find("\nE6305 ") < all.find("\nchain_did_not_move"));
}
