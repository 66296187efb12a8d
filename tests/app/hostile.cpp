// Texts made to exhaust: each is answered with a code at a place, in bounded time, memory and length of the answer.
#include <doctest/doctest.h>
#include <sys/resource.h>

#include <ctime>
#include <functional>

#include "answer.hpp"
#include "sanitized.hpp"

using namespace sysid;

namespace {

std::string repeated(std::string const& piece, int count) {
  std::string out;
  for (int i = 0; i < count; ++i) out += piece;
  return out;
}

/// `line(1)` to `line(count)`, one below the other.
std::string lines(int count, std::function<std::string(std::string const& i, std::string const& before)> const& line) {
  std::string out;
  for (int i = 1; i <= count; ++i) out += line(std::to_string(i), std::to_string(i - 1)) + "\n";
  return out;
}

/// An oscillator with further statements.
std::string oscillator(std::string const& statements) {
  return "model oscillator {\n  input x [N]\n  state y [m]\n  initial y = 0, y' = 0\n  parameter k [N/m] ~ log_uniform(1, 10)\n" +
         statements + "\n  1 [kg]*y'' + k*y = x\n  observe position ~ normal(y, sd = 1 [m])\n}\n";
}

/// A static model of numbers.
std::string regression_text(std::string const& statements, std::string const& value) {
  return "model line {\n  input u\n" + statements + "\n  observe p ~ normal(" + value + "*u, sd = 1)\n}\n";
}

long peak_megabytes() {
  rusage use = {};
  getrusage(RUSAGE_SELF, &use);
  return use.ru_maxrss / 1024;
}

std::size_t count(std::string const& text, std::string const& what) {
  std::size_t found = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++found;
  return found;
}

/// The first error has this code and a place; "" where the text is sound.
void answered(std::string const& what, std::string const& text, std::string const& code) {
  CAPTURE(what);
  long const before = peak_megabytes();
  std::clock_t const begin = std::clock();
  test::Answer const answer = test::answer("hostile.sysid", text, test::Depth::front, "OUT");
  double const seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  std::string const first = answer.messages.substr(0, 400);
  CAPTURE(first);
  if (code.empty()) {
    CHECK(count(answer.messages, "error[") == 0);
  } else {
    CHECK(answer.messages.starts_with("hostile.sysid:"));
    CHECK(answer.messages.find("error[" + code + "]") < answer.messages.find('\n'));
    CHECK(answer.exit == ExitCode::user_error);
  }
  CHECK(count(answer.messages, "error[") <= 20);
  CHECK(answer.messages.size() < 200'000);
  // A quarter of the time and a tenth of the memory are used; sanitizers multiply both. Two nanoseconds for each pair of 100,000
  // characters would be 10 s.
  CHECK(seconds < 6 * testing::slower);
  CHECK(peak_megabytes() - before < 1500);
}

}  // namespace

TEST_CASE("bytes that are no text") {
  answered("nul bytes", std::string(100'000, '\0'), "E1128");
  answered("a model between nul bytes", std::string(1, '\0') + oscillator(""), "E1115");
  answered("no UTF-8", repeated("\x80\xFF", 40'000), "E1115");
  answered("UTF-16", repeated("\xFF\xFE", 40'000), "E1128");
  answered("UTF-8 beyond Unicode", "model \xC0\x80\xED\xA0\x80\xF4\x90\x80\x80 {}\n", "E1115");
  answered("control characters in a text", "model m \"" + std::string(70'000, '\x01') + "\" {}", "E1115");
}

TEST_CASE("long and many") {
  answered("more than a text holds", std::string(1'000'001, ' '), "E1126");
  answered("blanks", std::string(1'000'000, ' '), "");
  answered("newlines", std::string(1'000'000, '\n'), "");
  answered("semicolons", std::string(100'000, ';'), "");
  answered("closing braces", std::string(100'000, '}'), "E1101");
  answered("models never closed", repeated("model a {", 10'000), "E1102");
  answered("tasks inside of models never closed", repeated("model a {\nfit b\n", 7'000), "E1102");
  answered("open parentheses", oscillator("let a = " + std::string(100'000, '(')), "E1123");
  answered("minus signs", oscillator("let a = " + std::string(100'000, '-') + "1"), "E1123");
  answered("a name", oscillator("let " + std::string(100'000, 'a') + " = 1"), "E1127");
  answered("primes", oscillator("let a = y" + std::string(100'000, '\'')), "E1127");
  answered("a unit", oscillator("let a = 1 [" + std::string(100'000, 'm') + "]"), "E1127");
  answered("a path", oscillator("let a = b" + repeated(".c", 130'000)), "E2001");
  answered("a number", oscillator("let a = " + std::string(100'000, '1')), "E1108");
  answered("an exponent", oscillator("let a = 1e" + std::string(100'000, '9')), "E1108");
  answered("a title", "model m \"" + std::string(100'000, 't') + "\" {\n y = 1\n}\n", "E2001");
  answered("products", oscillator("let a = y" + repeated("*y", 3990)), "");
  answered("quotients", oscillator("let a = y" + repeated("/y", 3990)), "");
  answered("conditions", oscillator("let a = if y > 0" + repeated(" and y > 0", 1900) + " then 1 else 2"), "");
  answered("statements", oscillator(lines(13'000, [](auto const& i, auto&) { return "let a" + i + " = " + i; })), "");
  answered("mistakes", oscillator(lines(16'000, [](auto const& i, auto&) { return "let a" + i + " = b" + i; })), "E2001");
  answered("models", lines(3000, [](auto const& i, auto&) { return "model m" + i + " {\n  y" + i + " = 1\n}"; }), "E2001");
}

TEST_CASE("numbers without bounds") {
  answered("a literal", oscillator("let a = 1e400"), "E1108");
  answered("a size", regression_text("parameter q(1000000000) ~ normal(0, sd = 1)", "sum(q)"), "E2702");
  answered("a long vector", regression_text("parameter q(10000) ~ normal(0, sd = 1)", "sum(q)"), "");
  answered("a tower", regression_text("parameter q(9^9^9^9) ~ normal(0, sd = 1)", "sum(q)"), "E2701");
  answered("an argument", "model m(n = 1000000000) {\n  state q(n)\n  initial q = 0\n  q' = -q\n}\n", "E2702");
  answered("an index", regression_text("parameter q(3) ~ normal(0, sd = 1)", "q[99999999999999999999]"), "E2701");
  answered("an exponent of a unit", oscillator("let a = 1 [m^99999999999999999999]"), "E2012");
  answered("an order", "model m {\n  state y\n  initial y = 0\n  y" + std::string(198, '\'') + " = 1\n}\n", "E3007");
  answered("matrices", regression_text("parameter A(100, 100) ~ normal(0, sd = 1)\nlet B = A*A\nlet C = B*B", "sum(C*C)"), "E2709");
  answered("a mass matrix",
           "model m {\n  parameter M(200, 50) ~ normal(0, sd = 1)\n  state q(200)\n  initial q = 0, q' = 0\n"
           "  M*transpose(M)*q'' + q = 0\n}\n",
           "E2709");
  answered("states", "model m {\n  state " + repeated("a, ", 100'000) + "b\n}\n", "E2709");
  answered("different states",
           "model m {\n" + lines(20'000, [](auto const& i, auto&) { return "state a" + i + "\na" + i + "' = 1"; }) + "}\n",
           "E2709");
}

TEST_CASE("short texts that expand") {
  auto const follower = [](std::string const& definitions, std::string const& last) {
    return "model follower {\n  input u\n  state z\n  initial z = 0\n  z' = u' - z\n}\n"
           "model whole {\n  state y\n  initial y = 1\n  y' = -y\n  let a0 = y\n" +
           definitions + "  part f = follower(u = " + last + ")\n  observe p ~ normal(f.z, sd = 1)\n}\n";
  };
  answered("the rate of a product", follower("", "y*y*y"), "");
  answered("the rate of a long product", follower("", "y" + repeated("*y", 3990)), "E2709");
  answered("the rate of products of products",
           follower(lines(60, [](auto const& i, auto& j) { return "let a" + i + " = a" + j + "*a" + j; }), "a60"), "E2709");
  answered("the rate of a chain of definitions",
           follower(lines(20'000, [](auto const& i, auto& j) { return "let a" + i + " = a" + j + " + 1"; }), "a20000"), "E2709");
  answered("functions of functions",
           oscillator("function f0(x) = x\n" +
                      lines(60, [](auto const& i, auto& j) { return "function f" + i + "(x) = f" + j + "(x) + f" + j + "(x)"; }) +
                      "let a = f60(y)"),
           "E2709");
  answered("functions of sums of functions",
           oscillator("function f0(x) = x*x + x\n" +
                      lines(40, [](auto const& i, auto& j) { return "function f" + i + "(x) = f" + j + "(f" + j + "(x) + x)*x"; }) +
                      "let a = f40(k/1 [N/m])"),
           "E2709");
  answered("definitions of definitions",
           oscillator("let a0 = y\n" + lines(2000, [](auto const& i, auto& j) { return "let a" + i + " = a" + j + " + a" + j; })),
           "");
  answered("a chain of definitions",
           oscillator("let a0 = 1\n" + lines(13'000, [](auto const& i, auto& j) { return "let a" + i + " = a" + j + " + 1"; })),
           "");
  answered("a chain of definitions, the last first",
           oscillator(lines(40'000, [](auto const& i, auto& j) { return "let a" + j + " = a" + i + " + 1"; }) + "let a40000 = 1"),
           "E2709");
  answered(
      "a deep chain of functions of a state",
      oscillator("let a0 = y/1 [m]\n" + lines(7'000, [](auto const& i, auto& j) { return "let a" + i + " = sin(a" + j + ")"; })),
      "");
  answered("parts of parts",
           "model a0 {\n  parameter z ~ normal(0, sd = 1)\n}\n" +
               lines(60, [](auto const& i,
                            auto& j) { return "model a" + i + " {\n  part p = a" + j + "()\n  part q = a" + j + "()\n}"; }),
           "E2709");
  answered("a chain of parts",
           "model a0 {\n  parameter z ~ normal(0, sd = 1)\n}\n" +
               lines(3000, [](auto const& i, auto& j) { return "model a" + i + " {\n  part p = a" + j + "()\n}"; }),
           "E2709");
  answered("a part of itself", "model m {\n  part p = m()\n}\n", "E2801");
  answered("a part of itself with other arguments", "model m(n = 1) {\n  part p = m(n = n + 1)\n}\n", "E2801");
  answered("a module that uses itself", "use hostile\n", "E2902");
  answered(
      "one model with many arguments",
      "model a(n = 1, m = 1) {\n  parameter q(n) ~ normal(0, sd = m)\n  observe p(n) ~ normal(q, sd = 1)\n}\n" +
          lines(3000, [](auto const& i, auto&) { return "t" + i + " = simulate a(n = 1000, m = " + i + ") with samples = 1"; }),
      "E2709");
}
