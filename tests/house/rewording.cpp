// No decision hangs on the wording of a message: with other sentences the same errors remain, at the same places.
#include <doctest/doctest.h>

#include <algorithm>
#include <regex>
#include <tuple>
#include <vector>

#include "app/answer.hpp"
#include "check/message/errors_reuse.hpp"
#include "load/load.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

struct Told {
  Severity severity;
  std::string code;
  std::uint32_t begin, end;
  bool operator==(Told const&) const = default;
};

/// What is told of a text; words: what is done to every message first.
std::vector<Told> told_of(std::filesystem::path const& path, std::function<void(Diagnostic&)> words) {
  Source source(path.filename().string(), content(path));
  Diagnostics diagnostics;
  diagnostics.reword(std::move(words));
  load(source, diagnostics);
  std::vector<Told> told;
  for (Diagnostic const& each : diagnostics.all())
    told.push_back(
        {each.severity, each.code, each.primary ? each.primary->span.begin : 0, each.primary ? each.primary->span.end : 0});
  return told;
}

}  // namespace

TEST_CASE("with other sentences in every message the same errors remain at the same places") {
  WorkingFolder const here(error_examples);
  int several = 0;
  for (auto const& entry : std::filesystem::directory_iterator(error_examples)) {
    if (entry.path().extension() != ".sysid") continue;
    CAPTURE(entry.path().string());
    std::vector<Told> const plain = told_of(entry.path(), {});
    CHECK(told_of(entry.path(), [](Diagnostic& each) { each.message = each.help = "reworded"; }) == plain);
    CHECK(told_of(entry.path(), [](Diagnostic& each) { each.message.clear(), each.help.clear(); }) == plain);
    several += plain.size() > 1 ? 1 : 0;
  }
  CHECK(several > 0);
}

TEST_CASE("a message is about the names that it is given, whatever the words of its subject") {
  ast::Name const name{{}, "lost"};
  auto const told = [&](errors::Subject const& about) {
    return std::vector<Diagnostic>{
        errors::not_a_number({}, about),
        errors::constant_needed({}, about),
        errors::number_of_other_kind({}, about, Unit{}, Unit{}),
        errors::number_in_cycles({}, about, Unit{}, Unit{}),
        errors::stated_twice({}, {}, about),
        errors::unit_mismatch({}, about, "m", "N"),
        errors::whole_number_needed({}, about),
        errors::wrong_shape({}, about, Shape{}, Shape{}),
        errors::input_not_bound({}, "x", about, "bench"),
        errors::no_channel_bound({}, about, "bench", {}),
        errors::unknown_input({}, "x", "", about, {}),
        errors::unknown_channel({}, "y", about, {}),
        errors::unknown_member(name, about, "part", {}),
        errors::option_kind({}, "draws", about, "draws(200)"),
    };
  };
  std::vector<Diagnostic> const plain = told({"the value of `width`", {"width"}});
  for (char const* words : {"reworded", "", "the value of `other`", "`"}) {
    std::vector<Diagnostic> const reworded = told({words, {"width"}});
    for (std::size_t i = 0; i < plain.size(); ++i) {
      CAPTURE(plain[i].code);
      CAPTURE(words);
      CHECK(reworded[i].message != plain[i].message);
      CHECK(std::find(plain[i].names.begin(), plain[i].names.end(), "width") != plain[i].names.end());
      CHECK(reworded[i].names == plain[i].names);
      CHECK(reworded[i].kind == plain[i].kind);
      CHECK(same_matter(reworded[i], plain[i]));
    }
  }
  std::vector<Diagnostic> const other = told({"the value of `width`", {"height"}});
  for (std::size_t i = 0; i < plain.size(); ++i) CHECK_FALSE(same_matter(other[i], plain[i]));
}

TEST_CASE("no source decides by the text of a message, of its help or of a verdict, or takes names out of it") {
  std::regex const decision(
      "(\\.|->)(message|help|verdict|headline|words)(\\.(find|rfind|starts_with|ends_with|contains|compare|substr)|\\s*[!=]=)"
      "|(insert|emplace|contains|count)\\([^;]*(\\.|->)(message|help)\\b"
      "|find(_first_of)?\\(['\"]`['\"]");
  auto const decides = [&](std::string const& text) { return std::regex_search(text, decision); };
  CHECK(decides("said.insert(place + each.message)"));
  CHECK(decides("verdict.text + report.verdict.substr(0, 5)"));
  CHECK(decides("phrase.find('`')"));
  CHECK_FALSE(decides("report.verdict = headline(report)"));
  CHECK_FALSE(decides("names.insert(each.name); out += each.message;"));
  for (char const* folder : {"grammar", "src"})
    for (auto const& entry : std::filesystem::recursive_directory_iterator(std::filesystem::path(SYSID_SOURCE_DIR) / folder)) {
      if (entry.path().extension() != ".cpp" && entry.path().extension() != ".hpp") continue;
      // The page shows what stands in back quotes as code; the parser's own names of what it wants have them.
      if (entry.path().filename() == "html_elements.cpp" || entry.path().filename() == "explain.cpp") continue;
      std::string const text = content(entry.path());
      std::smatch found;
      CHECK_MESSAGE(!std::regex_search(text, found, decision), entry.path().string() << ": " << found.str());
    }
}
