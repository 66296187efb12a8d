// The prompt behind a pseudo-terminal.
#include <doctest/doctest.h>

#include "dialogue.hpp"
#include "pseudo_terminal.hpp"
#include "sanitized.hpp"

using namespace sysid;

namespace {

bool shows(std::string const& text, std::string const& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("a prompt, a statement over several lines, an answer, the end") {
  TemporaryFolder folder;
  PseudoTerminal terminal(folder.path());
  CHECK(shows(terminal.until(terminal.prompt), "`help` lists the commands"));
  terminal.type("function twice(a) =\r");
  CHECK(shows(terminal.until("...> "), "...> "));
  CHECK_FALSE(shows(terminal.enter("2*a"), "error"));
  CHECK(shows(terminal.enter("show"), "function twice(a) = 2*a"));
  CHECK(shows(terminal.enter("mean(k)"), "no task has been run yet"));
  terminal.type("\x04");
  CHECK(terminal.ended() == 0);
}

TEST_CASE("on a narrow screen a source is shown as it is, messages go on below") {
  TemporaryFolder folder;
  PseudoTerminal terminal(folder.path(), {}, 60);
  terminal.until(terminal.prompt);
  // A source that is typed is drawn over several rows of the screen: it comes from a file.
  std::string const comment = "# a comment of more words than a line of sixty columns has room for, all of them in one line";
  write_file(folder.path() / "long.sysid", comment + "\nfunction twice(a) = 2*a\n");
  terminal.enter("load long.sysid");
  CHECK(shows(terminal.enter("show"), comment));
  CHECK(shows(terminal.enter("drop a"), "there is no `a` in the session"));
  CHECK(shows(terminal.enter("load \"of a file that is nowhere to be found, by a long name.sysid\""), "\r\n    "));
  terminal.type("\x04");
  CHECK(terminal.ended() == 0);
}

TEST_CASE("Ctrl-C takes back a line and what is unfinished, and the prompt goes on") {
  TemporaryFolder folder;
  PseudoTerminal terminal(folder.path());
  terminal.until(terminal.prompt);
  terminal.type("mean(k\r");
  terminal.until("...> ");
  terminal.type("and more\x03");
  CHECK(shows(terminal.until(terminal.prompt), "^C"));
  CHECK(shows(terminal.enter("help quit"), "ends the session"));
  terminal.type("\x03");
  terminal.until(terminal.prompt);
  terminal.type("quit\r");
  CHECK(terminal.ended() == 0);
}

TEST_CASE("Tab completes a word, and shows all that could stand there") {
  TemporaryFolder folder;
  PseudoTerminal terminal(folder.path());
  terminal.until(terminal.prompt);
  terminal.type("help log_un\t\r");
  CHECK(shows(terminal.until(terminal.prompt), "log_uniform(lower, upper)"));
  terminal.type("help log_\t");
  CHECK(shows(terminal.until("log_uniform"), "log_normal"));
  terminal.type("\x03");
  terminal.until(terminal.prompt);
}

TEST_CASE("arrows recall entries, of this session and of the last, a block in one line") {
  TemporaryFolder folder;
  {
    PseudoTerminal terminal(folder.path());
    terminal.until(terminal.prompt);
    terminal.enter("help split");
    terminal.type("function f(a) =\r");
    terminal.until("...> ");
    terminal.enter("3*a");
    terminal.type("\x1b[A\x1b[A\r");
    CHECK(shows(terminal.until("ranges of rows"), "ranges of rows"));
    terminal.until(terminal.prompt);
    terminal.type("\x04");
    CHECK(terminal.ended() == 0);
  }
  PseudoTerminal terminal(folder.path());
  terminal.until(terminal.prompt);
  terminal.type("\x1b[A\x1b[A");
  CHECK(shows(terminal.until("f(a) = 3*a"), "function f(a) = 3*a"));
}

TEST_CASE("letters of all alphabets can be typed, and edited") {
  TemporaryFolder folder;
  PseudoTerminal terminal(folder.path());
  terminal.until(terminal.prompt);
  // Two letters of two bytes, the second taken back.
  terminal.enter("function \u03b1\u03b2\x7f(a) = a");
  CHECK(shows(terminal.enter("show"), "function \u03b1(a) = a"));
}

TEST_CASE("Ctrl-C stops a run and keeps its draws; what is not saved is kept, too") {
  TemporaryFolder folder;
  PseudoTerminal terminal(folder.path());
  terminal.until(terminal.prompt);
  std::string model = oscillator;
  for (char& c : model)
    if (c == '\n') c = ';';
  model.replace(model.find("{;"), 2, "{");
  model.replace(model.find("; }") == std::string::npos ? model.rfind(";}") : model.find("; }"), 1, " ");
  terminal.enter(model);
  terminal.enter(
      "made = simulate oscillator with values(c = 20, k = 1e4, sigma = 1e-6), input x = gaussian(sd = 10), samples = 500, rate = "
      "500 [Hz], seed = 1");
  terminal.enter(
      "data bench { file \"results/made/made.csv\"; time t [s]; input x = x [N] hold zero_order; measure displacement = "
      "displacement [m] }");
  // Longer than any patience; once it samples the bar says so.
  terminal.type("post = fit oscillator to bench with mh(samples = 20000000, thin = 100), seed = 1\r");
  terminal.until("sampling", 60);
  terminal.until("%", 60);
  usleep(static_cast<useconds_t>(1500000 * testing::slower));
  terminal.type("\x03");
  CHECK(shows(terminal.until(terminal.prompt, 60), "continue with `resume`"));
  CHECK(shows(terminal.enter("mean(k)"), "[N/m]"));
  terminal.type("\x04");
  CHECK(terminal.ended() == 0);
  CHECK(shows(read_file(folder.path() / "state" / "sysid" / "unsaved.sysid"), "model oscillator"));
}
