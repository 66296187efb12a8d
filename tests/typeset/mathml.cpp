// MathML of all that is shipped: well-formed, and with the pieces a formula has.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "core/text/source.hpp"
#include "syntax/parse.hpp"
#include "typeset/typeset.hpp"

namespace {

/// What is wrong with the tags and entities; empty: nothing.
std::string fault(std::string const& xml) {
  std::set<std::string> const known = {"math", "mrow",  "mi",    "mn",     "mo",  "mtext", "mfrac", "msup",
                                       "msub", "mover", "msqrt", "mtable", "mtr", "mtd",   "mspace"};
  std::vector<std::string> open;
  for (std::size_t i = 0; i < xml.size(); ++i) {
    if (xml[i] == '&') {
      std::size_t const end = xml.find(';', i);
      std::string const entity = end == std::string::npos ? "" : xml.substr(i, end - i + 1);
      if (entity != "&amp;" && entity != "&lt;" && entity != "&gt;" && entity != "&quot;") return "entity at " + xml.substr(i, 12);
    }
    if (xml[i] == '>') return "stray >";
    if (xml[i] != '<') continue;
    std::size_t const end = xml.find('>', i);
    if (end == std::string::npos) return "tag without an end";
    std::string const tag = xml.substr(i + 1, end - i - 1);
    std::string const name = tag.substr(tag[0] == '/' ? 1 : 0, tag.find(' ') - (tag[0] == '/' ? 1 : 0));
    if (!known.contains(name)) return "unknown tag " + name;
    if (tag[0] != '/') {
      open.push_back(name);
    } else {
      if (open.empty() || open.back() != name) return "misplaced end of " + name;
      open.pop_back();
    }
    i = end;
  }
  return open.empty() ? "" : "no end of " + open.back();
}

std::optional<std::string> mathml(std::string_view text) {
  auto const statement = sysid::model_statement(text);
  return statement ? sysid::mathml(std::vector{*statement}).front() : std::nullopt;
}

}  // namespace

TEST_CASE("the statements of all shipped models and of the standard library are well-formed MathML") {
  int formulas = 0;
  for (char const* folder : {"models", "stdlib"})
    for (auto const& entry : std::filesystem::recursive_directory_iterator(std::filesystem::path(SYSID_SOURCE_DIR) / folder)) {
      if (entry.path().extension() != ".sysid") continue;
      CAPTURE(entry.path().string());
      std::ostringstream text;
      text << std::ifstream(entry.path()).rdbuf();
      sysid::Diagnostics diagnostics;
      auto const file = sysid::parse(sysid::Source(entry.path().string(), text.str()), diagnostics);
      REQUIRE(file);
      for (auto const& item : file->items)
        if (auto const* model = std::get_if<sysid::ast::Model>(&item))
          for (auto const& formula : sysid::mathml(model->statements))
            if (formula) {
              CAPTURE(*formula);
              CHECK(fault(*formula) == "");
              ++formulas;
            }
    }
  CHECK(formulas > 300);
}

TEST_CASE("a text is one statement of a model or no formula") {
  CHECK_FALSE(mathml("a < b"));
  CHECK_FALSE(mathml("y^ = 1"));
  CHECK_FALSE(mathml("a = 1\nb = 2"));
  CHECK_FALSE(mathml("a = 1 } model n { b = 2"));
  CHECK_FALSE(mathml("input x [N]"));
}

TEST_CASE("what XML would read as its own is escaped") {
  auto const formula = mathml("a = if b < c and b > 1 then 1 else 0");
  REQUIRE(formula);
  CHECK(fault(*formula) == "");
  CHECK(formula->find("alttext=\"a = if b &lt; c and b &gt; 1 then 1 else 0\"") != std::string::npos);
}

TEST_CASE("parentheses grow around fractions and roots alone") {
  auto const grows = [](char const* text) { return mathml(text).value_or("").find("stretchy=\"true\"") != std::string::npos; };
  CHECK(grows("a = 2*(b/c + 1)"));
  CHECK(grows("a = (sqrt(b) + 1)*c"));
  CHECK_FALSE(grows("initial y = 0, y' = 0"));
  CHECK_FALSE(grows("observe force ~ normal(Cd*U*abs(U), sd = sigma)"));
}
