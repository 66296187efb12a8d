// Every message of the syntax stage: the bad examples of tests/golden/errors with what is shown for them.
// SYSID_BLESS=1 in the environment rewrites the expected texts; review the difference.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "core/system/files.hpp"
#include "parsing.hpp"

using namespace sysid;
using test::messages;

namespace {

std::filesystem::path const examples = std::filesystem::path(SYSID_SOURCE_DIR) / "tests/golden/errors";

std::vector<std::filesystem::path> syntax_examples() {
  std::vector<std::filesystem::path> out;
  for (auto const& entry : std::filesystem::directory_iterator(examples))
    if (entry.path().extension() == ".sysid" && entry.path().filename().string().starts_with("E1")) out.push_back(entry.path());
  std::sort(out.begin(), out.end());
  return out;
}

std::size_t count(std::string const& text, std::string const& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

}  // namespace

TEST_CASE("each bad example is answered by the expected messages") {
  bool const bless = std::getenv("SYSID_BLESS") != nullptr;
  for (std::filesystem::path const& path : syntax_examples()) {
    Source const source(path.filename().string(), read_file(path));
    Diagnostics diagnostics;
    CAPTURE(path.string());
    CHECK_FALSE(parse(source, diagnostics).has_value());
    std::string const shown = render(diagnostics, source);
    std::filesystem::path expected = path;
    expected.replace_extension(".expected");
    if (bless) std::ofstream(expected, std::ios::binary) << shown;
    CHECK(shown == read_file(expected));
  }
}

TEST_CASE("an example shows its own code first, and every code has an example") {
  std::set<std::string> codes;
  for (std::filesystem::path const& path : syntax_examples()) {
    std::string const code = path.filename().string().substr(0, 5);
    codes.insert(code);
    if (code != "E11_s")
      CHECK_MESSAGE(read_file(path.string().substr(0, path.string().size() - 6) + ".expected").find(code) != std::string::npos,
                    path);
  }
  codes.insert("E1123");  // its example would hold thousands of operators; tested below
  codes.insert("E1126");  // a million bytes
  std::string const wording = read_file(std::filesystem::path(SYSID_SOURCE_DIR) / "grammar/message/errors.cpp");
  for (std::size_t at = wording.find("\"E1"); at != std::string::npos; at = wording.find("\"E1", at + 1))
    CHECK_MESSAGE(codes.contains(wording.substr(at + 1, 5)), wording.substr(at + 1, 5));
}

TEST_CASE("a statement of too many operators is refused in one message") {
  std::string sum = "y";
  for (int i = 0; i < 4001; ++i) sum += " + y";
  std::string const shown = messages("model m {\n  state y\n  y' = " + sum + "\n  let a = 1\n}\n");
  CHECK(shown.starts_with("test.sysid:3:3: error[E1123]: the statement that begins here has more than 4000 operators"));
  CHECK(count(shown, "error[") == 1);
}

TEST_CASE("at most twenty errors are reported") {
  std::string body;
  for (int i = 0; i < 50; ++i) body += "  2 y = 3\n";
  CHECK(count(messages("model m {\n" + body + "}\n"), "error[E1105]") == 20);
  std::string stray;
  for (int i = 0; i < 50; ++i) stray += "  y = $\n";
  CHECK(count(messages("model m {\n" + stray + "}\n"), "error[E1115]") == 20);
}

TEST_CASE("one mistake gives one message") {
  for (std::string const text : {
           "model m {\n  y' = (1\n}\n",
           "model m {\n  y' = 1)\n}\n",
           "model m {\n  y' = [1\n  y = 3\n}\nfit m\n",
           "model m {\n  y' = 1\n",
           "model m \n  y' = 1\n  state y\n  parameter k ~ normal(0, 1)\n}\nfit m to d\n",
           "model \"m\" {\n  y' = 1\n  state y\n}\nfit m to d\n",
           "model m {\n  y' = 1\n}\n}\nfit m to d\n",
           "model m {\n  candidates a {\n    b; c = 3\n    d\n  }\n  state y\n}\n",
           "model m \"open {\n  y' = 1\n  state y\n}\nfit m to d\n",
           "model m {\n  y' = $ + $ (\n  state y\n}\n",
           "dictionary d {\n  input x\n  terms = a b\n}\nfit m to d\n",
           "model m {\n  y' = 3 +\n}\nfit m\n",
           "data d {\n  file 'a.csv'\n  time t [s]\n}\n",
           "p = fit m to d with mh(samples = 3\nq = fit m to d\n",
           "model m {\n  let K = [1, 2; 3, 4]\n  state y\n}\n",
           "model m {\n  initial = [0; 0]\n  state y\n}\n",
           "model m \"title\"\n  state y\n  y' = 1\nend m;\ndata d {\n  file \"a.csv\"\n}\n",
       }) {
    CAPTURE(text);
    std::string const shown = messages(text);
    CHECK_MESSAGE(count(shown, "error[") == 1, shown);
  }
}

TEST_CASE("a quote behind a name stands for two primes only where no text can begin") {
  CHECK(messages("model m \"title\" {\n  state y\n  y'' = 1\n}\n").empty());
  CHECK(messages("model m\"title\" {\n  state y\n  y'' = 1\n}\n").empty());
  CHECK(messages("data d {\n  file\"a.csv\"\n  rate 1 [Hz]\n  measure y = \"a b\"\n}\n").empty());
  std::string const two = messages("model m {\n  state y\n  m*y\" + k*y\" = 1\n}\n");
  CHECK(two.find("help: a second derivative is written with two primes: `y''`") != std::string::npos);
  CHECK(count(two, "error[") == 1);
}

TEST_CASE("an expression alone reports what follows it") {
  Source const source("--set", "1e4 [N/m] k");
  Diagnostics diagnostics;
  CHECK_FALSE(parse_expression(source, diagnostics).has_value());
  CHECK(render(diagnostics, source) ==
        "--set:1:9: error[E1105]: there is no operator between `]` and `k`\n"
        "   1 | 1e4 [N/m] k\n"
        "     |         ^^^\n"
        "help: multiplication is written with `*`\n"
        "more: sysid explain E1105\n");
  Diagnostics empty;
  CHECK_FALSE(parse_expression(Source("--set", ""), empty).has_value());
  CHECK(empty.all().at(0).message == "expected a value but found the end of the file");
}

TEST_CASE("a million bytes are read, one more is refused") {
  std::string const text = "use hysteresis";
  CHECK(messages(text + std::string(1'000'000 - text.size(), ' ')).empty());
  CHECK(messages(text + std::string(1'000'001 - text.size(), ' ')).find("error[E1126]: the text is longer than 1000000 bytes") !=
        std::string::npos);
}

TEST_CASE("a message shows of a very long line what lies around the mark") {
  std::string const blanks(5000, ' ');
  std::string const shown = messages("use hysteresis;" + blanks + "use ;" + blanks + "use damping");
  CHECK(shown.find("^") != std::string::npos);
  CHECK(shown.find(" ... ") != std::string::npos);
  CHECK(shown.size() < 2000);
  CHECK(shown.find("use ;") != std::string::npos);
  CHECK(shown.find("damping") == std::string::npos);
}

TEST_CASE("a line that is no text is not shown, its place is; a line of text is shown") {
  std::string const binary =
      messages(std::string("\x7f"
                           "ELF\x02\x01\x01\0\0\0\x03 model",
                           17));
  CHECK(binary.find("error[E1") != std::string::npos);
  CHECK(binary.find(":1:") != std::string::npos);
  CHECK(binary.find(" | ") == std::string::npos);
  CHECK(binary.find("ELF") == std::string::npos);
  CHECK(messages("model m {\n\tstate ?\r\n}\n").find("   2 |     state ?\n") != std::string::npos);
}

TEST_CASE("two signs behind a value need a blank between them") {
  auto const model = [](std::string const& value) { return messages("model m {\n  let a = " + value + "\n}\n"); };
  for (char const* const sound : {"1 - -2", "1 + -2", "-(-1)", "2^-1", "(--1)", "1*-2", "1 -\n  -2"}) {
    CAPTURE(sound);
    CHECK(model(sound).empty());
  }
  CHECK(model("20 +- 5").find("error[E1117]: `+-` is not an operator") != std::string::npos);
  CHECK(model("20 +- 5").find("`~ normal(20, sd = 5)`") != std::string::npos);
  CHECK(model("a--b").find("to subtract a negative number, write a space between the signs") != std::string::npos);
  CHECK(model("a -- a comment").find("a comment begins with `#` or `//`") != std::string::npos);
  CHECK(count(model("a ++ b"), "error[") == 1);
}

TEST_CASE("braces inside a statement are told once, blocks on one line are none") {
  CHECK(messages("model m { state y; y' = 1 }\ndata d { file \"d.csv\"; rate 10 [Hz] }\n").empty());
  std::string const power = messages("model m {\n  state y\n  y' = 1 - y^{2} + 3\n}\n");
  CHECK(power.starts_with("test.sysid:3:14: error[E1115]: `{` has no meaning here"));
  CHECK(count(power, "error[") == 1);
  CHECK(count(messages("p = fit m to d with mh{samples = 100, chains = 4}, seed = 1\n"), "error[") == 1);
  CHECK(messages("model m {\n  state {\n}\n").find("E1115") == std::string::npos);
}

TEST_CASE("raised digits and commands of LaTeX are one mistake with what they stand for") {
  auto const model = [](std::string const& value) { return messages("model m {\n  let a = " + value + "\n}\n"); };
  CHECK(model("10⁻¹²").find("the character `⁻¹²` is not part of the language\n") != std::string::npos);
  CHECK(model("10⁻¹²").find("help: write `^-12`") != std::string::npos);
  CHECK(model("y₁ + σ").empty());  // names
  CHECK(model("\\frac{a}{b}").find("the command `\\frac` of LaTeX has no meaning here") != std::string::npos);
  CHECK(model("\\alpha").find("write `alpha` without `\\`") != std::string::npos);
  CHECK(count(model("\\frac{a}{b} + 1"), "error[") == 1);
}
