// Whatever the bytes: the parser answers with a tree or with messages, in bounded time and stack.
#include <algorithm>

#include "parsing.hpp"
#include "random_tree.hpp"

using namespace sysid;

namespace {

/// Parses and checks all that must hold for any bytes.
void check_any(std::string const& text) {
  Source const source("bytes", text);
  Diagnostics diagnostics;
  auto const tree = parse(source, diagnostics);
  INFO(text);
  REQUIRE(tree.has_value() == diagnostics.all().empty());
  REQUIRE(diagnostics.all().size() <= 20);
  for (Diagnostic const& diagnostic : diagnostics.all()) {
    REQUIRE(diagnostic.primary.has_value());
    REQUIRE(diagnostic.primary->span.begin <= diagnostic.primary->span.end);
    REQUIRE(diagnostic.primary->span.end <= text.size());
    for (Label const& label : diagnostic.secondary) REQUIRE(label.span.end <= text.size());
    // An unnamed composite behind an expectation would show its C++ type.
    REQUIRE(diagnostic.message.find("spirit") == std::string::npos);
  }
  REQUIRE(render(diagnostics, source).empty() == tree.has_value());
  if (tree) REQUIRE(test::parsed(unparse(*tree)) == *tree);
  Diagnostics alone;
  bool const expression = parse_expression(source, alone).has_value();
  REQUIRE(expression == alone.all().empty());
}

constexpr char const* fragments[] = {
    "model ",     "data ",    "m ",       "{",         "}",     "{\n",   "}\n",      "\n",     ";",     "input ",   "state ",
    "parameter ", "initial ", "observe ", "function ", "let ",  "time ", "file ",    "split ", "rows ", "measure ", "fit ",
    "to ",        "with ",    "if ",      "then ",     "else ", "and ",  "or ",      "not ",   "y",     "y''",      "'",
    " = ",        " == ",     " ~ ",      "<",         ">=",    "+",     "-",        "*",      "/",     "^",        "**",
    "->",         ":=",       "(",        ")",         "[",     "]",     ",",        ".",      "..",    "1",        "2.5",
    "1.",         ".5",       "1e",       "1e-4",      "1e999", "\"",    "\"text\"", "\\",     "#",     "//",       "%",
    "$",          "\xC3\xA9", "\xC3",     "\xFF",      "×",     "\t",    "\r"};

}  // namespace

TEST_CASE("a bracket at the end of a text, or alone, is answered") {
  for (std::string const bracket : {"{", "}", "[", "]", "(", ")"})
    for (std::string const before : {"", "model m\n", "fit =\n", "model m {\n  y^"}) check_any(before + bracket);
}

TEST_CASE("random bytes are answered") {
  test::Random random(3);
  for (int i = 0; i < 2000; ++i) {
    std::string text(random.below(200), ' ');
    for (char& c : text) c = static_cast<char>(random.below(256));
    check_any(text);
  }
}

TEST_CASE("random sequences of the language's pieces are answered") {
  test::Random random(4);
  for (int i = 0; i < 4000; ++i) {
    std::string text = random.chance(2) ? "model m {\n" : "";
    for (std::size_t n = random.below(60); n > 0; --n) text += random.pick(fragments);
    check_any(text);
  }
}

TEST_CASE("damaged files are answered") {
  test::Random random(5);
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    std::string text = unparse(test::RandomTree(seed).file());
    for (std::size_t n = 1 + random.below(4); n > 0 && !text.empty(); --n) {
      std::size_t const at = random.below(text.size());
      switch (random.below(4)) {
        case 0:
          text.erase(at, 1 + random.below(5));
          break;
        case 1:
          text.insert(at, random.pick(fragments));
          break;
        case 2:
          text[at] = static_cast<char>(random.below(256));
          break;
        default:
          text.resize(at);
      }
    }
    check_any(text);
  }
}

TEST_CASE("two hundred levels of nesting are read, more are refused, whatever nests") {
  struct Nesting {
    std::string open, close;
  };
  for (auto const& [open, close] : {Nesting{"(", ")"},
                                    {"f(", ")"},
                                    {"-", ""},
                                    {"not ", ""},
                                    {"2^", ""},
                                    {"(1, ", ")"},
                                    {"f(a = ", ")"},
                                    {"if a then b else ", ""},
                                    {"if ", " then a else b"},
                                    {"1 [m^(", ")]"},
                                    {"2^-", ""}}) {
    auto const nested = [&, &open = open, &close = close](std::size_t levels) {
      std::string text;
      for (std::size_t i = 0; i < levels; ++i) text += open;
      text += "y";
      for (std::size_t i = 0; i < levels; ++i) text += close;
      return text;
    };
    CAPTURE(open);
    std::size_t const levels_each = open == "2^-" ? 2 : 1;
    CHECK(unparse(test::parsed_expression(nested(200 / levels_each))).find('y') != std::string::npos);
    for (std::size_t const levels : {201UL, 1200UL}) {
      Diagnostics diagnostics;
      CHECK_FALSE(parse_expression(Source("deep", nested(levels)), diagnostics).has_value());
      REQUIRE(diagnostics.all().size() == 1);
      CHECK(diagnostics.all()[0].code == "E1122");
    }
    check_any("model m {\n y = " + nested(100000) + "\n}");
  }
  std::string const units(201, '(');
  check_any("model m {\n state y [" + units + "m" + std::string(201, ')') + "]\n}");
}

TEST_CASE("unclosed brackets by the thousand are answered") {
  for (std::string const piece : {"(", "[", "{", "f(", "model m {\n", "\"", "y = (\n", "data d {\n time t [\n"}) {
    std::string text;
    for (int i = 0; i < 20000; ++i) text += piece;
    check_any(text);
    check_any("model m {\n" + text);
  }
}

TEST_CASE("a sum of four thousand terms is read") {
  std::string sum = "y";
  for (int i = 0; i < 4000; ++i) sum += " + y";
  CHECK(unparse(test::parsed_expression(sum)) == sum);
}
