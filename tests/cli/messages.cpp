// One style for what concerns no place in a text, with the exit codes that the documentation promises.
#include <doctest/doctest.h>

#include "cli/asked.hpp"

using namespace sysid;
using namespace sysid::testing;

TEST_CASE("a command line that cannot be understood says what was meant") {
  Desk const desk;
  auto const refused = [&](std::string const& arguments, std::string const& message) {
    Said const said = desk.ask(arguments);
    CHECK(said.exit == 2);
    CHECK(said.text == message);
  };
  refused("ftt x.sysid", "sysid: error: there is no command `ftt`\nhelp: did you mean `fit` or `fmt`?\n");
  refused("fit x.sysid --ouput y", "sysid: error: `sysid fit` has no option `--ouput`\nhelp: did you mean `--output`?\n");
  refused("fit", "sysid: error: FILE is required\nhelp: `sysid fit --help` lists its arguments and options\n");
  refused("fit --hlep", "sysid: error: `sysid fit` has no option `--hlep`\nhelp: did you mean `--help`?\n");
  refused("list distribution", "sysid: error: there is no list of `distribution`\nhelp: did you mean `distributions`?\n");
  refused("run x.sysid --set m=3",
          "sysid: error: `sysid run` has no option `--set`\n"
          "help: a value is written in the file: `parameter m [kg] = 3`\n");
  refused("--force fit x.sysid",
          "sysid: error: `--force` stands before the command\n"
          "help: options follow the command: `sysid fit FILE --force`\n");
  refused("--seed 3 fit x.sysid",
          "sysid: error: `--seed` stands before the command\n"
          "help: options follow the command: `sysid fit FILE --seed VALUE`\n");
  refused("-v",
          "sysid: error: `-v` stands before a command, and is no option of `sysid`\n"
          "help: the command comes first, then its file and its options: `sysid run FILE`\n");
  refused("fit x.sysid --threads",
          "sysid: error: `--threads` needs a value\nhelp: `sysid fit --help` lists its arguments and options\n");
  refused("list modules more",
          "sysid: error: `sysid list` takes no argument `more`\n"
          "help: `sysid list --help` lists its arguments and options\n");
  refused("explain E9999", "sysid: error: there is no message E9999\nhelp: `sysid explain` lists them all\n");
  refused("document springs", "sysid: error: there is no module springs\nhelp: `sysid list modules` lists them all\n");
  refused("export x.sysid -o y",
          "sysid: error: --output requires --stan\nhelp: `sysid export --help` lists its arguments and options\n");
  refused("run x.sysid --with-disturbance",
          "sysid: error: `sysid run` has no option `--with-disturbance`\nhelp: it is an option of `sysid fit`\n");
  refused("--sed 1",
          "sysid: error: `--sed` stands before a command, and is no option of `sysid`\n"
          "help: did you mean `--seed`? the command comes first, then its file and its options: `sysid run FILE`\n");
  refused("--seed 1",
          "sysid: error: `--seed` stands before a command\n"
          "help: the command comes first, then its file and its options: `sysid run FILE --seed`\n");
  refused("x.sysid", "sysid: error: there is no command `x.sysid`\nhelp: the command comes first: `sysid run x.sysid`\n");
  refused("help run", "sysid: error: there is no command `help`\nhelp: write `sysid run --help`\n");
  refused("run x.sysid m=2",
          "sysid: error: `sysid run` takes no argument `m=2`\n"
          "help: values of parameters and options of a task are written in its file\n");
  refused("run x.sysid –force",
          "sysid: error: `sysid run` takes no argument `–force`\nhelp: an option begins with two hyphens: `--force`\n");
  refused("fit x.sysid --with map",
          "sysid: error: `sysid fit` has no option `--with`\n"
          "help: what a task does is written in its file: `fit MODEL to DATA with mh(samples = 1000)`\n");
  std::string const of_tasks =
      "help: a command runs all its tasks of the file, and `--resume` keeps those that are complete; tasks that are run alone have "
      "a "
      "file of their own\n";
  refused("fit x.sysid posterior", "sysid: error: `sysid fit` takes no argument `posterior`\n" + of_tasks);
  refused("run x.sysid --only posterior", "sysid: error: `sysid run` has no option `--only`\n" + of_tasks);
  refused("check x.sysid --json",
          "sysid: error: `sysid check` has no option `--json`\n"
          "help: messages are written as JSON by `--error-format json`; the folder of a task has its results as JSON\n");
  desk.save("my rig.sysid", "");
  refused("run my rig.sysid",
          "sysid: error: `sysid run` takes no argument `rig.sysid`\n"
          "help: write the name of a file with blanks in quotes: `\"my rig.sysid\"`\n");
  CHECK(desk.ask("crosscheck x.sysid --against mhh").text.find("`mhh` is none of") != std::string::npos);
  CHECK(desk.ask("crosscheck x.sysid --against mhh").text.find("the nearest is `mh`") != std::string::npos);
  CHECK(desk.ask("--error-format json fit").text.starts_with("{\"file\":\"sysid\",\"severity\":\"error\",\"code\":\"\""));
}

TEST_CASE("options that would have no effect are refused") {
  LineDesk const desk;
  for (char const* const arguments :
       {"export --latex line.sysid --force", "export --latex line.sysid --model line.sysid", "export --latex line.sysid --draws 3",
        "export --stan line.sysid --model line.sysid", "fit line.sysid --dump model --with-disturbance"}) {
    CAPTURE(arguments);
    Said const said = desk.ask(arguments);
    CHECK(said.exit == 2);
    CHECK(said.text.starts_with("sysid: error: --"));
  }
  CHECK(desk.ask("export --latex line.sysid").exit == 0);
}

TEST_CASE("a file to write says that its folder is not there, and not that the disk is full") {
  LineDesk const desk;
  REQUIRE(desk.ask("fit line.sysid --quiet --no-figures").exit <= 1);
  Said said = desk.ask("report results -o missing/folder/x.html");
  CHECK(said.exit == 74);
  CHECK(said.text ==
        "sysid: error: cannot write `missing/folder/x.html`: no such file or directory\n"
        "help: there is no folder `missing/folder`: create it, or give another one\n");
  said = desk.ask("report results -o results");
  CHECK(said.exit == 74);
  CHECK(said.text.ends_with("help: `results` is a folder: give a file in it\n"));
  said = desk.ask("fit line.sysid -o line.sysid/results");
  CHECK(said.exit == 74);
  CHECK(said.text.ends_with("help: a part of the path is a file, not a folder: give another path\n"));
}

TEST_CASE("a model in place of a record, and a folder of results that is not there, are answered with what to give") {
  LineDesk const desk;
  Said said = desk.ask("data line.sysid");
  CHECK(said.exit == 65);
  CHECK(said.text ==
        "sysid: error: `line.sysid` is a file of models, not a record\n"
        "help: describe the record that it reads: `sysid data bench.csv`\n");
  std::string text = line_model;
  text.replace(text.find("bench.csv"), 9, "my bench.csv");
  desk.save("two.sysid", text);
  CHECK(desk.ask("data two.sysid").text.ends_with("help: describe the record that it reads: `sysid data 'my bench.csv'`\n"));
  for (char const* const verb : {"report", "compare", "export"}) {
    CAPTURE(verb);
    said = desk.ask(std::string(verb) + " results");
    CHECK(said.exit == 74);
    CHECK(said.text.starts_with("sysid: error: there is no folder `results`\nhelp: run the tasks first, `sysid run FILE`"));
  }
  REQUIRE(desk.ask("fit line.sysid --quiet --no-figures").exit <= 1);
  CHECK(desk.ask("track line.sysid results").text ==
        "sysid: error: `results` holds the results of a whole run\n"
        "help: give the folder of one of its fits: `results/posterior`\n");
  for (char const* const verb : {"report", "compare"}) {
    CAPTURE(verb);
    CHECK(desk.ask(std::string(verb) + " resuls").text ==
          "sysid: error: there is no folder `resuls`\nhelp: did you mean `results`?\n");
    CHECK(desk.ask(std::string(verb) + " results/posterio/").text.ends_with("help: did you mean `results/posterior`?\n"));
    CHECK(desk.ask(std::string(verb) + " line.sysid").text.starts_with("sysid: error: `line.sysid` is a file, not a folder"));
  }
}

TEST_CASE("the picture of a record has the format of its ending, and what keeps it from being drawn is said") {
  LineDesk const desk;
  Said const png = desk.ask("data bench.csv --plot x.png"), svg = desk.ask("data bench.csv --plot x.svg");
  if (svg.exit == 0) {
    if (png.exit == 0) CHECK(read_file(desk.path("x.png")).starts_with("\x89PNG"));  // else gnuplot lacks that terminal
    CHECK(read_file(desk.path("x.svg")).find("<svg") != std::string::npos);
    write_file(desk.path("gnuplot"), "#!/bin/sh\n[ \"$1\" = --version ]\n");
    std::filesystem::permissions(desk.path("gnuplot"), std::filesystem::perms::owner_all);
    Said const failed = said_by("cd '" + desk.path(".").string() +
                                "' && PATH=\"$PWD:$PATH\" NO_COLOR=1 '" SYSID_PROGRAM "' data bench.csv --plot y.svg");
    CHECK(failed.exit == 74);
    CHECK(failed.text.find("error: the plot was not drawn: gnuplot failed\n") != std::string::npos);
  } else {
    CHECK(png.text.find("error: the plot was not drawn: gnuplot is not installed\n") != std::string::npos);
  }
}

TEST_CASE("results that are there are an error of the program, not of the text") {
  LineDesk const desk;
  REQUIRE(desk.ask("fit line.sysid --quiet --no-figures").exit <= 1);
  Said const said = desk.ask("fit line.sysid");
  CHECK(said.exit == 65);
  CHECK(said.text.starts_with("sysid: error: `results/posterior` already contains results\nhelp: add --force"));
}
