// Which newlines end a statement.
#include "parsing.hpp"

using namespace sysid;
using test::messages;
using test::parsed;
using test::statements;

TEST_CASE("a newline, a semicolon and a closing brace end a statement") {
  CHECK(statements("state y\n y' = 1").size() == 2);
  CHECK(statements("state y; y' = 1; let a = 2").size() == 3);
  CHECK(statements(";; \n\n ; state y ;\n;").size() == 1);
  CHECK(parsed("model m { y' = 1 }\nmodel n { }").items.size() == 2);
  CHECK(parsed("").items.empty());
  CHECK(parsed("# only a comment").items.empty());
}

TEST_CASE("a line that ends in an operator, a comma, = or ~ goes on") {
  ast::File const expected = parsed("model m {\n let a = b + c*d\n}");
  CHECK(parsed("model m {\n let a = b +\n c*d\n}") == expected);
  CHECK(parsed("model m {\n let a = b + c*\n\n\n d\n}") == expected);
  CHECK(parsed("model m {\n let a =\n b + c*d\n}") == expected);
  CHECK(parsed("model m {\n let a = b + # why\n // and why not\n c*d\n}") == expected);
  CHECK(parsed("model m {\r\n let a = b +\r\n\tc*d\r\n}\r\n") == expected);
  CHECK(statements("state y,\n z") == statements("state y, z"));
  CHECK(statements("parameter a ~\n normal(0, 1)") == statements("parameter a ~ normal(0, 1)"));
  for (std::string const symbol : {"+", "-", "*", "/", "^", "<", "<=", ">", ">=", "==", "!=", "and", "or"})
    CHECK(statements("let a = b " + symbol + "\n c").size() == 1);
}

TEST_CASE("a line that begins with a binary operator continues the one before") {
  for (std::string const symbol : {"+", "-", "*", "/", "^", "<", "<=", ">", ">=", "==", "!=", "and", "or"})
    CHECK(statements("let a = b\n " + symbol + " c").size() == 1);
  CHECK(statements("m*y''\n  + c*y'\n  + k*y = x") == statements("m*y'' + c*y' + k*y = x"));
  CHECK(statements("let a = if b\n then c\n else d") == statements("let a = if b then\n c else\n d"));
}

TEST_CASE("an open parenthesis or bracket joins lines") {
  CHECK(statements("parameter a ~ normal(\n 0\n ,\n 1\n )") == statements("parameter a ~ normal(0, 1)"));
  CHECK(statements("parameter a [N\n s/m]\nlet b = 1").size() == 2);
  CHECK(statements("let a = (b\n)\n\nlet c = f(d,\n# a comment with ( in it\n e)").size() == 2);
}

TEST_CASE("a semicolon ends even a line that an operator would continue") {
  CHECK(statements("let a = b;\n(-c) = d").size() == 2);
  CHECK(messages("model m {\n let a = b +;\n c = d\n}").find("expected a value but found `;`") != std::string::npos);
}

TEST_CASE("between blocks a line that ends or begins with a word of a task goes on") {
  ast::File const expected = parsed("p = fit a to b.c with mh(samples = 10), start = rest");
  CHECK(parsed("p = fit a to\n b.c with mh(samples = 10), start = rest") == expected);
  CHECK(parsed("p = fit a to b.c with\n mh(samples = 10),\n start = rest\n") == expected);
  CHECK(parsed("p =\n fit a to b.c\n with mh(samples = 10), start = rest\n") == expected);
  CHECK(parsed("p = fit a\nwith = fit b").items.size() == 2);
}

TEST_CASE("inside a model the words of a task are names and join nothing") {
  CHECK(statements("let a = with\nlet b = on\nlet to = from\nto = 1").size() == 4);
}

TEST_CASE("no statement begins with a sign") {
  CHECK(messages("model m {\n -k*y = x\n}").find("E1120") != std::string::npos);
  CHECK(statements("k = y\n -z").size() == 1);
  CHECK(statements("(-k)*y = x").size() == 1);
}

TEST_CASE("comments begin with # or // and end with their line") {
  CHECK(statements("state y # [m\nstate z // (\n// } \nlet a = \"#//\"").size() == 3);
}

TEST_CASE("a byte order mark is no part of the text") { CHECK(parsed("\xEF\xBB\xBFmodel m { }").items.size() == 1); }
