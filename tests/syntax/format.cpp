// Canonical layout: its look, that nothing is lost, and that it is its own layout.
#include "syntax/format.hpp"

#include <array>
#include <filesystem>

#include "core/system/files.hpp"
#include "grammar/message/layout.hpp"
#include "parsing.hpp"
#include "random_tree.hpp"

using namespace sysid;

namespace {

std::string layout_of(std::string const& text) {
  Source const source("test.sysid", text);
  Diagnostics diagnostics;
  auto const out = formatted(source, diagnostics);
  INFO(text, "\n", render(diagnostics, source));
  REQUIRE(out.has_value());
  return *out;
}

/// The layout of a model's body, without the model around it.
std::string body(std::string const& statements) {
  std::string const text = layout_of("model m {\n" + statements + "\n}\n");
  REQUIRE(text.starts_with("model m {\n"));
  REQUIRE(text.ends_with("\n}\n"));
  return text.substr(10, text.size() - 13);
}

std::vector<std::string> comments_of(std::string const& text) {
  std::vector<std::string> out;
  for (Span const span : grammar::scan(text).comments) {
    std::string comment = text.substr(span.begin, span.end - span.begin);
    while (comment.ends_with(' ') || comment.ends_with('\r') || comment.ends_with('\t')) comment.pop_back();
    out.push_back(comment);
  }
  return out;
}

/// The same statements with other blanks, newlines and `;`, and with comments wherever a line may end.
class Scatter {
 public:
  Scatter(std::uint64_t seed, bool with_comments) : random_(seed), with_comments_(with_comments) {}

  std::string operator()(std::string const& text) {
    Source const source("test", text);
    Diagnostics none;
    grammar::Layout const layout = grammar::lay_out(source, none, 1);
    std::string out;
    for (std::size_t i = 0; i < layout.tokens.size(); ++i) {
      grammar::Token const& token = layout.tokens[i];
      if (i > 0) {
        grammar::Token const& before = layout.tokens[i - 1];
        std::string const gap = text.substr(before.span.end, token.span.begin - before.span.end);
        bool const tight = gap.empty() && (token.is("[") || token.is("'") || token.is(".") || before.is("."));
        // Two words at the start of a line look like a declaration, and that an open bracket was forgotten.
        bool const declares = token.kind == grammar::TokenKind::word && i + 1 < layout.tokens.size() &&
                              layout.tokens[i + 1].kind == grammar::TokenKind::word;
        if (gap.find('\n') != std::string::npos)
          out += between_statements(!token.is("}") && !before.is("{") && !before.is("}"));
        else if (!tight && !declares && token.joins_before && random_.chance(3))
          out += blanks() + comments() + "\n" + blanks();
        else if (!tight)
          out += gap.empty() ? "" : " " + blanks();
      }
      out += token.text;
    }
    return out + blanks() + comments() + "\n";
  }

 private:
  std::string blanks() { return std::string(random_.below(4), ' ') + (random_.chance(5) ? "\t" : ""); }
  /// What may stand before a newline.
  std::string comments() {
    constexpr std::array<char const*, 8> texts{"# one", "// two",   "#",        "# ends in blanks  ",
                                               "# {",   "# \"text", "// × ; }", "#input x"};
    std::string out;
    while (with_comments_ && random_.chance(3)) out += (out.empty() ? " " : "\n" + blanks()) + random_.pick(texts);
    return out;
  }
  std::string between_statements(bool semicolon) {
    if (semicolon && random_.chance(4)) return blanks() + ";" + blanks() + (random_.chance(2) ? "" : comments() + "\n");
    return blanks() + comments() + (random_.chance(5) ? "\r\n" : "\n") + blanks();
  }

  test::Random random_;
  bool with_comments_;
};

}  // namespace

TEST_CASE("blanks stand around sums, comparisons and signs of equality, not around products and powers") {
  CHECK(body("m * y''+c*y' + ( k )*y=x") == "  m*y'' + c*y' + (k)*y = x");
  CHECK(body("let a=if x<- 1 then b else 2^ - 3") == "  let a = if x < -1 then b else 2^-3");
  CHECK(body("let a = f ( x,sd=2 )/( 2 * pi )") == "  let a = f(x, sd = 2)/(2*pi)");
  CHECK(body("let a=not( b and(c or d) )") == "  let a = not (b and (c or d))");
  CHECK(body("let a=b[ 1 , i+1 ]' - -c") == "  let a = b[1, i + 1]' - -c");
  CHECK(layout_of("data d {\nsplit a = rows ( 1 ) .. 2*n\n}\n") == "data d {\n  split a = rows (1)..2*n\n}\n");
  CHECK(layout_of("fit a(n=2)to b . c ,d with(1,2)") == "fit a(n = 2) to b.c, d with (1, 2)\n");
}

TEST_CASE("units stand one blank behind what they are of, without blanks but for products") {
  CHECK(body("parameter k[ N / m ]=1[N*s / m^( 1 - n )]") == "  parameter k [N/m] = 1 [N*s/m^(1-n)]");
  CHECK(body("parameter k = 1 [N^(1 - -n)]") == "  parameter k = 1 [N^(1- -n)]");
  CHECK(body("state q( 3 )[m]") == "  state q(3) [m]");
  CHECK(body("parameter k per experiment[kg m (s^ - 2)]") == "  parameter k per experiment [kg m (s^-2)]");
  CHECK(layout_of("data d {\nmeasure y=\"a b\"[mm]\ninput x=u[V]hold linear\n}\n") ==
        "data d {\n  measure y = \"a b\" [mm]\n  input   x = u [V] hold linear\n}\n");
  // What is bound may be an element; what follows it is an index and no unit.
  CHECK(layout_of("data d {\nmeasure y[1]=a[mm]\nmeasure y[10]=b [mm]\ninput u[1]=f[N] hold linear\n}\n") ==
        "data d {\n  measure y[1]  = a [mm]\n  measure y[10] = b [mm]\n  input   u[1] = f [N] hold linear\n}\n");
}

TEST_CASE("numbers, texts and parentheses stay as they are spelt") {
  CHECK(body("let a = 1e3 + 0.10 + 1E-07 + ((b))") == "  let a = 1e3 + 0.10 + 1E-07 + ((b))");
}

TEST_CASE("neighbouring declarations form a table, an empty line ends it") {
  CHECK(body("input x [N]\nparameter m [kg]=1\nparameter kay ~ flat()\n\nparameter c [N s/m] = 2") ==
        "  input     x [N]\n  parameter m   [kg] = 1\n  parameter kay      ~ flat()\n\n  parameter c [N s/m] = 2");
  CHECK(layout_of("a = fit m to d\nlonger = fit m to d\n\nb = fit m to d\n") ==
        "a      = fit m to d\nlonger = fit m to d\n\nb = fit m to d\n");
}

TEST_CASE("candidates stand one a line, their probabilities behind their names") {
  CHECK(layout_of("candidates laws\"which?\"{linear probability(1/2);law( n=1 .. 4,m=( 1,3 ))probability 0.25\nshared m,q[1]}\n"
                  "s=select laws to d with abc_smc(schedule=(10,1)),distance=abs(residual(y)),weights(y=1)") ==
        "candidates laws \"which?\" {\n  linear probability (1/2)\n  law(n = 1..4, m = (1, 3)) probability 0.25\n  shared m, "
        "q[1]\n}\n\n"
        "s = select laws to d with abc_smc(schedule = (10, 1)), distance = abs(residual(y)), weights(y = 1)\n");
  CHECK(layout_of("candidates c {\nlinear probability 0.5\ncubic_law probability 0.5\nstate probability p[1]\n}\n") ==
        "candidates c {\n  linear    probability 0.5\n  cubic_law probability 0.5\n  state     probability p[1]\n}\n");
}

TEST_CASE("blocks stand apart, at most one empty line is kept, none at the ends of a block") {
  CHECK(layout_of("\n\nmodel m {\n\n\nlet a = 1\n\n\n\nlet b = 1\n\n}\n# of n\nmodel n {}\nfit m to d\n\n\n") ==
        "model m {\n  let a = 1\n\n  let b = 1\n}\n\n# of n\nmodel n {\n}\n\nfit m to d\n");
}

TEST_CASE("long statements end their lines before operators and behind commas") {
  std::string const term = "stiffness_of_the_left_support*displacement";
  CHECK(body(term + " + " + term + " + " + term + " = 0") == "  " + term + " + " + term + "\n      + " + term + " = 0");
  CHECK(layout_of(
            "posterior = fit duffing to bench.train with mh(samples = 25000, burn_in = 5000, thin = 10, chains = 4), seed = 1") ==
        "posterior = fit duffing to bench.train\n"
        "    with mh(samples = 25000, burn_in = 5000, thin = 10, chains = 4), seed = 1\n");
}

TEST_CASE("comments stay where they were: above, behind, inside and at the ends") {
  std::string const text =
      "# head\n"
      "\n"
      "# of the model\n"
      "model m {  # opens\n"
      "  # first\n"
      "  m*y''    # inertia\n"
      "      + c  # damping\n"
      "      # stiffness\n"
      "      + k*y = x\n"
      "  let a = 1                # one\n"
      "  let b = a + a + a + a*a  # two\n"
      "                           # and on\n"
      "  # last\n"
      "}  # closes\n"
      "\n"
      "fit m to d  // a task\n"
      "# end\n";
  CHECK(layout_of(text) == text);
  // A newline behind `to` would continue the task.
  CHECK(layout_of("fit to ; other = fit n to d # why") == "fit to;\nother = fit n to d  # why\n");
}

TEST_CASE("a text with mistakes has no layout") {
  Source const source("test.sysid", "model m {\n let a = (1\n}\n");
  Diagnostics diagnostics;
  CHECK_FALSE(formatted(source, diagnostics).has_value());
  CHECK(diagnostics.has_errors());
}

TEST_CASE("random files keep their tree and comments, and their layout is its own") {
  for (std::uint64_t seed = 0; seed < 1500; ++seed) {
    ast::File const tree = test::RandomTree(seed).file();
    std::string const plain = unparse(tree);
    CAPTURE(seed);
    std::string const scattered = Scatter(seed, true)(plain);
    INFO(scattered);
    std::string const text = layout_of(scattered);
    INFO(text);
    REQUIRE(test::parsed(text) == tree);
    REQUIRE(comments_of(text) == comments_of(scattered));
    REQUIRE(layout_of(text) == text);
    REQUIRE(text.find(" \n") == std::string::npos);
    REQUIRE(text.find("\n\n\n") == std::string::npos);
    // Without comments and empty lines all layouts of a text have one canonical layout.
    REQUIRE(layout_of(Scatter(seed, false)(plain)) == layout_of(plain));
  }
}

TEST_CASE("shipped models and the standard library are in canonical layout") {
  int count = 0;
  for (char const* folder : {"models", "stdlib"})
    for (auto const& entry : std::filesystem::recursive_directory_iterator(std::filesystem::path(SYSID_SOURCE_DIR) / folder)) {
      if (entry.path().extension() != ".sysid") continue;
      std::string const text = read_file(entry.path());
      CHECK_MESSAGE(layout_of(text) == text, "`sysid fmt " << entry.path().string() << "` would change it");
      ++count;
    }
  CHECK(count > 20);
}
