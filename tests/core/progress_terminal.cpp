// The progress bar and lines against a clock and a screen of our own.
#include "core/system/progress_terminal.hpp"

#include <doctest/doctest.h>

using namespace sysid;

namespace {

struct Screen {
  double now = 0;
  std::string text;
  TerminalProgress::Means means(bool bar, int columns = 100) {
    return {bar, columns, [this] { return now; }, [this](std::string_view more) { text += more; }};
  }
};

}  // namespace

TEST_CASE("without a terminal there is a line per interval and none for a short job") {
  Screen screen;
  TerminalProgress progress(screen.means(false));
  progress.begin("posterior", 1000);
  for (int i = 1; i <= 9; ++i) {
    screen.now = i;
    progress.advance(static_cast<std::uint64_t>(i), "");
  }
  progress.end();
  CHECK(screen.text.empty());
  screen.now = 0;
  progress.begin("posterior", 1000);
  for (int i = 0; i <= 25; ++i) {
    screen.now = i;
    progress.advance(static_cast<std::uint64_t>(10 * i), "acceptance 0.24");
  }
  progress.end();
  CHECK(screen.text ==
        "posterior: 10 % (100 of 1000), 10/s, 1:30 left, acceptance 0.24\n"
        "posterior: 20 % (200 of 1000), 10/s, 1:20 left, acceptance 0.24\n"
        "posterior: done in 0:25\n");
}

TEST_CASE("a job that is stopped is not called done") {
  Screen screen;
  TerminalProgress progress(screen.means(false));
  progress.begin("sampling", 100);
  progress.advance(0, "");
  screen.now = 11;
  progress.advance(11, "");
  progress.end(false);
  CHECK(screen.text == "sampling: 11 % (11 of 100), 1/s, 1:29 left\nsampling: stopped after 0:11\n");
}

TEST_CASE("on a terminal the bar is redrawn in place, not too often, and wiped at the end") {
  Screen screen;
  TerminalProgress progress(screen.means(true));
  progress.begin("fit", 100);
  progress.advance(0, "");
  CHECK(screen.text == "\r\033[Kfit [                    ]   0 %");
  screen.text.clear();
  screen.now = 0.05;
  progress.advance(1, "");
  CHECK(screen.text.empty());
  screen.now = 2;
  progress.advance(50, "acceptance 0.3");
  CHECK(screen.text == "\r\033[Kfit [==========          ]  50 %, 25/s, 0:02 left, acceptance 0.3");
  screen.text.clear();
  progress.end();
  CHECK(screen.text == "\r\033[K");
}

TEST_CASE("the bar never runs over the end of the line") {
  Screen screen;
  TerminalProgress progress(screen.means(true, 20));
  progress.begin("a long name of a task", 100);
  progress.advance(50, "and a note");
  CHECK(screen.text == "\r\033[Ka long name of a ta");
}

TEST_CASE("a resumed job counts its rate from where it began") {
  Screen screen;
  TerminalProgress progress(screen.means(false));
  progress.begin("fit", 1000);
  progress.advance(900, "");
  screen.now = 10;
  progress.advance(910, "");
  CHECK(screen.text == "fit: 91 % (910 of 1000), 1/s, 1:30 left\n");
}

TEST_CASE("a job of unknown length shows its count") {
  Screen screen;
  TerminalProgress progress(screen.means(false));
  progress.begin("populations", 0);
  screen.now = 11;
  progress.advance(3, "threshold 0.2");
  CHECK(screen.text == "populations: 3, threshold 0.2\n");
}

TEST_CASE("a duration is minutes and seconds, with hours when there are any") {
  CHECK(format_duration(0) == "0:00");
  CHECK(format_duration(6.2) == "0:07");
  CHECK(format_duration(750) == "12:30");
  CHECK(format_duration(11100) == "3:05:00");
}
