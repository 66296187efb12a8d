// Manual pages and completions: that they say what the commands' tables say, and that shells can use them.
#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>
#include <vector>

#include "cli/asked.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

/// What bash offers for the last word of a command line.
std::vector<std::string> offered(Desk const& desk, std::vector<std::string> const& line) {
  std::string quoted;
  for (std::string const& word : line) quoted += " '" + word + "'";
  desk.save("ask.sh", "source completion.bash\nCOMP_WORDS=(" + quoted + ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_sysid\n" +
                          "for each in \"${COMPREPLY[@]}\"; do echo \"$each\"; done\n");
  std::istringstream said(said_by("cd '" + desk.path("").string() + "' && bash ask.sh").text);
  std::vector<std::string> words;
  for (std::string word; std::getline(said, word);) words.push_back(word);
  return words;
}

using Words = std::vector<std::string>;

bool has(Words const& words, std::string const& word) { return std::find(words.begin(), words.end(), word) != words.end(); }

bool installed(std::string const& shell) { return said_by("command -v " + shell).exit == 0; }

}  // namespace

TEST_CASE("bash completes commands, options, values and files") {
  Desk const desk;
  desk.save("completion.bash", desk.ask("completion bash").text);
  desk.save("beam.sysid", "");
  desk.save("beam.csv", "");
  CHECK(offered(desk, {"sysid", "dis"}) == Words{"discover"});
  CHECK(has(offered(desk, {"sysid", "--"}), "--version"));
  CHECK(has(offered(desk, {"sysid", "fit", "--"}), "--threads"));
  CHECK(has(offered(desk, {"sysid", "fit", "--"}), "--error-format"));
  CHECK(has(offered(desk, {"sysid", "fit", "--"}), "--with-disturbance"));
  CHECK_FALSE(has(offered(desk, {"sysid", "predict", "--"}), "--with-disturbance"));
  CHECK(offered(desk, {"sysid", "run", "beam.sysid", "--executor", "sc"}) == Words{"scalar"});
  CHECK(offered(desk, {"sysid", "run", "beam.sysid", "--instruction-set", ""}) == Words{"avx2", "avx512"});
  CHECK(offered(desk, {"sysid", "run", "beam.sysid", "--seed", ""}).empty());
  CHECK(offered(desk, {"sysid", "run", "be"}) == Words{"beam.sysid"});
  CHECK(offered(desk, {"sysid", "track", "beam.sysid", "results", "--record", "b"}) == Words{"beam.csv"});
  CHECK(has(offered(desk, {"sysid", "explain", "E21"}), "E2103"));
  CHECK(has(offered(desk, {"sysid", "document", ""}), "hysteresis"));
  CHECK(offered(desk, {"sysid", "manual", "disc"}) == Words{"discover"});
  CHECK_FALSE(has(offered(desk, {"sysid", "run", "--"}), "--interrupt-after"));  // for tests
}

TEST_CASE("zsh and fish can read their completions, and fish offers what bash does") {
  Desk const desk;
  desk.save("_sysid", desk.ask("completion zsh").text);
  desk.save("sysid.fish", desk.ask("completion fish").text);
  std::string const there = "cd '" + desk.path("").string() + "' && ";
  if (installed("zsh")) {
    Said const said = said_by(there +
                              "zsh -n _sysid && zsh -fc 'autoload -U compinit; compinit -D -u; source ./_sysid; "
                              "whence -w _sysid; print $_comps[sysid]'");
    CHECK_MESSAGE(said.text == "_sysid: function\n_sysid\n", said.text);
  }
  if (installed("fish")) {
    auto const offers = [&](std::string const& line) {
      return said_by(there + "HOME=. XDG_CONFIG_HOME=. XDG_DATA_HOME=. fish --no-config -c 'source sysid.fish; complete -C \"" +
                     line + "\"'")
          .text;
    };
    CHECK(offers("sysid disco").starts_with("discover\t"));
    CHECK(offers("sysid fit --with-dist").starts_with("--with-disturbance\t"));
    CHECK(offers("sysid run x.sysid --executor sc").starts_with("scalar\t"));
    CHECK(offers("sysid explain E2103").starts_with("E2103"));
  }
}

TEST_CASE("every command has a manual page with its options, which man sets without a warning") {
  Desk const desk;
  CHECK(desk.ask("manual -o pages").exit == 0);
  std::string const program = read_file(desk.path("pages/sysid.1"));
  int count = 0;
  for (auto const& entry : std::filesystem::directory_iterator(desk.path("pages"))) {
    CAPTURE(entry.path().filename().string());
    std::string const page = read_file(entry.path());
    CHECK(page.starts_with(".TH \"SYSID"));
    CHECK(page.find(".SH NAME\n") != std::string::npos);
    ++count;
    if (installed("man")) {
      Said const said = said_by("LC_ALL=C.UTF-8 MANROFFSEQ='' MANWIDTH=80 man --warnings -E UTF-8 -l -Tutf8 -Z '" +
                                entry.path().string() + "' > /dev/null");
      CHECK_MESSAGE(said.text == "", said.text);
    }
  }
  CHECK(count > 20);
  for (char const* part : {"\\fBsysid\\-fit\\fR(1)", ".SH EXIT STATUS", ".SS Tasks of a file", "\\fB\\-\\-version\\fR"})
    CHECK_MESSAGE(program.find(part) != std::string::npos, part);
  std::string const fit = desk.ask("manual fit").text;
  CHECK(fit.find("\\fB\\-o\\fR, \\fB\\-\\-output\\fR \\fIFOLDER\\fR\n") != std::string::npos);
  CHECK(fit.find("\\-\\-with\\-disturbance") != std::string::npos);
  Said const unknown = desk.ask("manual fitt");
  CHECK(unknown.exit == 2);
}
