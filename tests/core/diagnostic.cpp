// Diagnostics as the user sees them: places, carets, order, number, and near names.
#include "core/text/diagnostic.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

using namespace sysid;

namespace {

Span find(Source const& source, std::string_view text, std::size_t from = 0) {
  std::size_t const at = source.text().find(text, from);
  return {static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(at + text.size())};
}

Diagnostic at(std::uint32_t offset, std::string message) {
  return {Severity::error, "E1001", std::move(message), Label{{offset, offset + 1}, ""}, {}, ""};
}

}  // namespace

TEST_CASE("a diagnostic shows the place, the line, both spans with their units, help and where to read more") {
  std::string text(8, '\n');
  text += "  m*y'' + c*y' + k + k3*y^3 = x\n";
  Source const source("duffing.sysid", text);
  Diagnostic const diagnostic{Severity::error,
                              "E2103",
                              "this term cannot be added to the ones before it",
                              Label{find(source, "k +"), "[N/m]"},
                              {Label{find(source, "m*y'' + c*y'"), "[N]"}},
                              "multiply it by a length, such as `y`"};
  Diagnostic shorter = diagnostic;
  shorter.primary->span.end = shorter.primary->span.begin + 1;
  CHECK(render(shorter, source) ==
        "duffing.sysid:9:18: error[E2103]: this term cannot be added to the ones before it\n"
        "   9 |   m*y'' + c*y' + k + k3*y^3 = x\n"
        "     |   ------------   ^ [N/m]\n"
        "     |   [N]\n"
        "help: multiply it by a length, such as `y`\n"
        "more: sysid explain E2103\n");
}

TEST_CASE("a second span on another line is shown with its line, in the order of the text") {
  Source const source("a.sysid", "state y [m]\ninput x [N]\n\nstate y [N]\n");
  Diagnostic const diagnostic{Severity::error,          "E2002", "`y` is declared twice", Label{find(source, "y [N]"), "again"},
                              {Label{{6, 7}, "first"}}, ""};
  CHECK(render(diagnostic, source) ==
        "a.sysid:4:7: error[E2002]: `y` is declared twice\n"
        "   1 | state y [m]\n"
        "     |       - first\n"
        "...\n"
        "   4 | state y [N]\n"
        "     |       ^^^^^ again\n"
        "more: sysid explain E2002\n");
}

TEST_CASE("texts that would run into each other stand on rows of their own") {
  Source const source("a", "a+b+c");
  Diagnostic const diagnostic{
      Severity::error, "", "three units", Label{{4, 5}, "metres"}, {Label{{0, 1}, "kilograms"}, Label{{2, 3}, "seconds"}}, ""};
  CHECK(render(diagnostic, source) ==
        "a:1:5: error: three units\n"
        "   1 | a+b+c\n"
        "     | - - ^ metres\n"
        "     |   seconds\n"
        "     | kilograms\n");
}

TEST_CASE("tabs and letters of two bytes do not shift the carets") {
  Source const source("a", "\t\xCF\x83\t= q");
  Diagnostic const diagnostic{Severity::warning, "E2001", "unknown", Label{find(source, "q"), ""}, {}, ""};
  CHECK(render(diagnostic, source) ==
        "a:1:6: warning[E2001]: unknown\n"
        "   1 |     \xCF\x83   = q\n"
        "     |           ^\n"
        "more: sysid explain E2001\n");
}

TEST_CASE("units of two-byte letters do not shift what stands to their right") {
  Source const source("a", "a     + b     + c");
  Diagnostic const diagnostic{
      Severity::error, "", "units", Label{{16, 17}, "x"}, {Label{{0, 1}, "[\xC2\xB5m]"}, Label{{8, 9}, "[s]"}}, ""};
  CHECK(render(diagnostic, source) ==
        "a:1:17: error: units\n"
        "   1 | a     + b     + c\n"
        "     | -       -       ^ x\n"
        "     | [\xC2\xB5m]    [s]\n");
}

TEST_CASE("a span over several lines is underlined to the end of its first line") {
  Source const source("a", "k = (1 +\n  2)\n");
  Diagnostic const diagnostic{Severity::error, "", "too long", Label{{4, 13}, ""}, {}, ""};
  CHECK(render(diagnostic, source) == "a:1:5: error: too long\n   1 | k = (1 +\n     |     ^^^^\n");
}

TEST_CASE("a place at the end of the text has a caret behind the last character") {
  Source const source("a", "model m {");
  Diagnostic const diagnostic{Severity::error, "", "expected `}`", Label{{9, 9}, ""}, {}, ""};
  CHECK(render(diagnostic, source) == "a:1:10: error: expected `}`\n   1 | model m {\n     |          ^\n");
}

TEST_CASE("a message without a place names the file alone") {
  Source const source("a.csv", "");
  CHECK(render(Diagnostic{Severity::error, "E4001", "no rows", {}, {}, ""}, source) ==
        "a.csv: error[E4001]: no rows\nmore: sysid explain E4001\n");
}

TEST_CASE("a message with neither a place nor a code is the program's, not the file's") {
  Source const source("a.sysid", "");
  CHECK(render(Diagnostic{Severity::error, "", "`results` already contains results", {}, {}, "add --force"}, source) ==
        "sysid: error: `results` already contains results\nhelp: add --force\n");
}

TEST_CASE("diagnostics are sorted by place, those without one last") {
  Source const source("a", "abcdef");
  Diagnostics all;
  all.add({Severity::error, "", "nowhere", {}, {}, ""});
  all.add(at(4, "late"));
  all.add(at(1, "early"));
  std::string const text = render(all, source);
  CHECK(text.find("early") < text.find("late"));
  CHECK(text.find("late") < text.find("nowhere"));
}

TEST_CASE("twenty errors are shown and the rest counted; warnings are not errors") {
  Source const source("a", std::string(100, 'x'));
  Diagnostics all;
  CHECK_FALSE(all.has_errors());
  all.add({Severity::warning, "", "careful", Label{{99, 100}, ""}, {}, ""});
  CHECK_FALSE(all.has_errors());
  for (std::uint32_t i = 0; i < 23; ++i) all.add(at(i, "error number " + std::to_string(i) + " of many"));
  CHECK(all.has_errors());
  std::string const text = render(all, source);
  CHECK(text.find("error number 19 ") != std::string::npos);
  CHECK(text.find("error number 20 ") == std::string::npos);
  CHECK(text.find("careful") != std::string::npos);
  CHECK(text.ends_with("\n... and 3 more\n"));
}

TEST_CASE("colours surround the words and change nothing else") {
  Source const source("a", "abc");
  std::string const plain = render(at(1, "wrong"), source);
  std::string coloured = render(at(1, "wrong"), source, true);
  CHECK(coloured.find("\033[1;31m") != std::string::npos);
  for (std::size_t escape; (escape = coloured.find('\033')) != std::string::npos;)
    coloured.erase(escape, coloured.find('m', escape) - escape + 1);
  CHECK(coloured == plain);
}

TEST_CASE("JSON has one object per line with places from one, for every diagnostic") {
  Source const source("a",
                      "ab\n\xFF"
                      "cd");
  Diagnostics all;
  for (std::uint32_t i = 0; i < 25; ++i) {
    Diagnostic each = at(4, "wrong \"quote\"" + std::string(i, '!'));
    each.names = {std::to_string(i)};
    all.add(std::move(each));
  }
  std::string const text = render_json(all, source);
  CHECK(std::count(text.begin(), text.end(), '\n') == 25);
  auto const object = nlohmann::json::parse(text.substr(0, text.find('\n')));
  CHECK(object["file"] == "a");
  CHECK(object["severity"] == "error");
  CHECK(object["code"] == "E1001");
  CHECK(object["message"] == "wrong \"quote\"");
  CHECK(object["primary"]["line"] == 2);
  CHECK(object["primary"]["column"] == 2);
  CHECK(object["primary"]["begin"] == 4);
}

TEST_CASE("the edit distance counts insertion, deletion, substitution and a swap as one") {
  CHECK(edit_distance("", "") == 0);
  CHECK(edit_distance("abc", "") == 3);
  CHECK(edit_distance("kitten", "sitting") == 3);  // the textbook example
  CHECK(edit_distance("alhpa", "alpha") == 1);
  CHECK(edit_distance("ca", "abc") == 3);  // no substring is edited twice
}

TEST_CASE("near names come nearest first, at most three, and only when near") {
  std::vector<std::string> const known = {"displacement", "gamma", "alpha", "Alpha", "k1", "k2", "k3", "k4", "gaussian", "x", "y"};
  CHECK(nearest("alhpa", known) == std::vector<std::string>{"alpha", "Alpha"});
  CHECK(nearest("displacment", known) == std::vector<std::string>{"displacement"});
  CHECK(nearest("k5", known).size() == 3);
  CHECK(nearest("gauss", known) == std::vector<std::string>{"gaussian"});
  CHECK(nearest("stiffness", known).empty());
  CHECK(nearest("q", known).empty());                           // one letter is near no other
  CHECK(nearest("X", known) == std::vector<std::string>{"x"});  // but to its capital
  CHECK(nearest("ALPHA", known) == std::vector<std::string>{"alpha", "Alpha"});
}

TEST_CASE("did you mean lists names as a sentence") {
  CHECK(did_you_mean("gama", {"gamma"}) == "did you mean `gamma`?");
  CHECK(did_you_mean("k5", {"k1", "k2"}) == "did you mean `k1` or `k2`?");
  CHECK(did_you_mean("k5", {"k1", "k2", "k3", "k4"}) == "did you mean `k1`, `k2` or `k3`?");
  CHECK(did_you_mean("zzz", {"alpha"}).empty());
}

TEST_CASE("a message about two files shows both, and each place in its own file") {
  Source source("main.sysid", "use laws\nk = 1\n");
  CHECK(source.next_begin() == 16);
  source.include("laws.sysid", "# laws\n  k = 2");
  CHECK(source.files() == 2);
  Span const own{9, 10}, other{source.line_begin(2, 1) + 2, source.line_begin(2, 1) + 3};
  CHECK(source.text(own) == "k");
  CHECK(source.text(other) == "k");
  CHECK(source.place(other.begin).line == 2);
  CHECK(source.place(other.begin).column == 3);
  CHECK(source.place(15).file == 0);
  CHECK(source.place(16).file == 1);
  CHECK(source.line(2, 0) == "k = 1");
  CHECK(source.line(3, 0).empty());
  CHECK(source.line(9, 1).empty());
  Diagnostic const diagnostic{Severity::error, "E2903", "two", Label{other, "this one"}, {{own, "and this one"}}, ""};
  CHECK(render(diagnostic, source) ==
        "laws.sysid:2:3: error[E2903]: two\n"
        "   2 |   k = 2\n"
        "     |   ^ this one\n"
        "     | in main.sysid\n"
        "   2 | k = 1\n"
        "     | - and this one\n"
        "more: sysid explain E2903\n");
  auto const object = nlohmann::json::parse(render_json(diagnostic, source));
  CHECK(object["file"] == "laws.sysid");
  CHECK(object["primary"]["begin"] == 9);
  CHECK(object["secondary"][0]["file"] == "main.sysid");
  CHECK(object["secondary"][0]["begin"] == 9);
}

TEST_CASE("what is found twice at one place is said once") {
  Source const source("a", "abcdef");
  Diagnostics all;
  for (int i = 0; i < 3; ++i) all.add(at(2, i == 2 ? "wrong in other words" : "wrong"));
  Diagnostic of_a_name = at(2, "worse");
  of_a_name.names = {"name"};
  all.add(of_a_name);
  std::string const text = render(all, source);
  CHECK(text.find("wrong") == text.rfind("wrong"));
  CHECK(text.find("worse") != std::string::npos);
}

TEST_CASE("two messages say the same by code, places and names, whatever their words") {
  Diagnostic const one{Severity::error, "E6005", "`a` is wrong", Label{{2, 4}, {}}, {}, {}, {"a"}};
  auto const changed = [&](auto const& change) {
    Diagnostic other = one;
    change(other);
    return same_matter(one, other);
  };
  CHECK(changed([](Diagnostic& each) { each.message = "reworded", each.help = "too", each.primary->text = "here"; }));
  CHECK_FALSE(changed([](Diagnostic& each) { each.names = {"b"}; }));
  CHECK_FALSE(changed([](Diagnostic& each) { each.code = "E6004"; }));
  CHECK_FALSE(changed([](Diagnostic& each) { each.primary->span.begin = 1; }));
  CHECK(changed([](Diagnostic& each) { each.secondary.push_back({{0, 1}, {}}); }));  // one mistake, met from several places
  Diagnostic const bare{Severity::error, "", "something is wrong", std::nullopt, {}, {}};
  CHECK_FALSE(same_matter(bare, bare));
}

TEST_CASE("at the prompt a message names what is typed there") {
  Diagnostic const error = result_error("E6208", "`a` contains an interrupted run", resume_or_replace());
  Source const source("prompt", "");
  CHECK(render(error, source) ==
        "prompt: error[E6208]: `a` contains an interrupted run\nhelp: continue with --resume, or start again with --force\n"
        "more: sysid explain E6208\n");
  CHECK(render(error, source, false, Surface::prompt) ==
        "prompt: error[E6208]: `a` contains an interrupted run\n"
        "help: give the task another name, or start the prompt with --force or another -o\nmore: help E6208\n");
  Diagnostic plain = error;
  plain.prompt_help.clear();
  plain.help = "write `sysid explain ` and --resume";  // the user's own words stay
  CHECK(render(plain, source, false, Surface::prompt).find("help: write `sysid explain ` and --resume\n") != std::string::npos);
}
