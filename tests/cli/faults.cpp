// What a command line, a file or a system can do to the program: each is answered with the exit code that it is worth, 70 by none.
#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/asked.hpp"
#include "sanitized.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

bool has(Said const& said, std::string const& text) { return said.text.find(text) != std::string::npos; }

/// A simulation of so many samples.
std::string simulation(std::string const& options) {
  return "model mass {\n  input x [N]\n  state y [m]\n  initial y = 0, y' = 0\n  1 [kg]*y'' + 20 [N s/m]*y' + 1e4 [N/m]*y = x\n"
         "  observe d ~ normal(y, sd = 1e-6)\n}\nmade = simulate mass with " +
         options + ", rate = 1000 [Hz], seed = 1\n";
}

}  // namespace

TEST_CASE("values of options that cannot be meant are refused in a line") {
  LineDesk const desk;
  Said said = desk.ask("fit line.sysid --seed -1");
  CHECK(said.exit == 2);
  CHECK(has(said, "a seed is a whole number from 0 to 18446744073709551615, not `-1`"));
  said = desk.ask("fit line.sysid --checkpoint-interval 0");
  CHECK(said.exit == 2);
  CHECK(has(said, "a time is a positive number of seconds, not `0`"));
  CHECK(said.text.size() < 300);
  said = desk.ask("fit line.sysid -o ''");
  CHECK(said.exit == 2);
  CHECK(has(said, "the path is empty"));
  CHECK_FALSE(desk.has("posterior"));
  CHECK(desk.ask("fit line.sysid --no-figures --quiet --seed 18446744073709551615 --checkpoint-interval 0.5 -o .").exit <= 1);
  CHECK(desk.has("posterior"));
}

TEST_CASE("the version is printed by a verb and by an option") {
  LineDesk const desk;
  Said const said = desk.ask("--version");
  CHECK(said.exit == 0);
  CHECK(said.text.starts_with("sysid "));
  CHECK(said.text == desk.ask("version").text);
}

TEST_CASE("codes that are misspelt have near ones") {
  LineDesk const desk;
  Said const said = desk.ask("explain chains_disagre");
  CHECK(said.exit == 2);
  CHECK(has(said, "did you mean `chains_disagree`? `sysid explain` lists them all"));
  CHECK_FALSE(has(desk.ask("explain wombat"), "did you mean"));
}

TEST_CASE("a path that the system refuses is an error of input and output") {
  LineDesk const desk;
  std::string const name(300, 'a');
  for (std::string const& command : {"fit line.sysid -o " + name, "report " + name, "compare " + name, "export " + name}) {
    Said const said = desk.ask(command);
    CHECK_MESSAGE(said.exit == 74, command);
    CHECK_MESSAGE(has(said, "file name too long"), said.text);
  }
  CHECK(desk.ask("repl nothere.sysid < /dev/null").exit == 74);
  CHECK(desk.ask("repl line.sysid < /dev/null").exit == 0);
}

TEST_CASE("an edited summary is the user's error") {
  LineDesk const desk;
  REQUIRE(desk.ask("fit line.sysid --no-figures --quiet").exit <= 1);
  CHECK(desk.ask("compare results").exit == 0);
  std::string text = read_file(desk.path("results/posterior/summary.json"));
  text.replace(text.find("\"seed\": 1"), 9, "\"seed\": \"one\"");
  desk.save("results/posterior/summary.json", text);
  for (char const* verb : {"compare", "report", "export --draws 0"}) {
    Said const said = desk.ask(std::string(verb) + " results");
    CHECK_MESSAGE(said.exit == 65, verb);
    CHECK_MESSAGE(has(said, "summary.json` has been changed since it was written"), said.text);
  }
}

TEST_CASE("a file of another kind in the place of the model is named once") {
  LineDesk const desk;
  for (char const* verb : {"run", "check", "fmt --check", "export --latex"}) {
    Said const said = desk.ask(std::string(verb) + " bench.csv");
    CHECK_MESSAGE(said.exit == 65, verb);
    CHECK_MESSAGE(
        said.text.starts_with("bench.csv:1:1: error[E1128]: `bench.csv` is not a .sysid file: it looks like a table of numbers"),
        said.text);
    CHECK(said.text.find("error", 30) == std::string::npos);
  }
  desk.save("binary", std::string("\x7f"
                                  "ELF\0\1\2",
                                  7));
  CHECK(has(desk.ask("run binary"), "it looks like a program"));
  desk.save("slip.sysid", "modle line {\n}\n");
  CHECK(has(desk.ask("run slip.sysid"), "E1110"));
}

TEST_CASE("data without an end or a beginning are refused, and a record of a terabyte before it is read") {
  LineDesk const desk;
  auto const with_data = [&](std::string const& file) {
    std::string text = line_model;
    text.replace(text.find("bench.csv"), 9, file);
    desk.save("other.sysid", text);
    return desk.ask("check other.sysid");
  };
  for (std::string const file : {"/dev/zero", "pipe"}) {
    said_by("test -p '" + desk.path("pipe").string() + "' || mkfifo '" + desk.path("pipe").string() + "'");
    Said const said = with_data(file);
    CHECK(said.exit == 74);
    CHECK_MESSAGE(has(said, "it is a device or a pipe, not a file"), said.text);
  }
  said_by("truncate -s 1T '" + desk.path("huge.csv").string() + "'");
  Said const said = with_data("huge.csv");
  CHECK(said.exit == 65);
  CHECK_MESSAGE(has(said, "error[E5003]: reading `huge.csv` needs about 3.3 TB of memory"), said.text);
  CHECK(with_data("bench.csv").exit <= 1);
}

TEST_CASE("a simulation that needs more memory than there is is refused before it begins, one of a few samples is not") {
  if (sanitized) {
    MESSAGE("no limit of the address space holds the shadow memory of sanitizers");
    return;
  }
  LineDesk const desk;
  desk.save("large.sysid", simulation("samples = 100000000, input x = gaussian(sd = 10)"));
  Said const said =
      said_by("cd '" + desk.path(".").string() + "' && ulimit -v 4000000 && '" SYSID_PROGRAM "' simulate large.sysid");
  CHECK(said.exit == 65);
  CHECK_MESSAGE(has(said, "E5003"), said.text);
  CHECK_FALSE(desk.has("results"));
  desk.save("small.sysid", simulation("samples = 100, input x = gaussian(sd = 10)"));
  CHECK(desk.ask("simulate small.sysid --quiet").exit == 0);
}

TEST_CASE("a Gaussian process over more rows than memory takes as a matrix is refused, over a few it is fitted") {
  if (sanitized) {
    MESSAGE("no limit of the address space holds the shadow memory of sanitizers");
    return;
  }
  LineDesk const desk;
  auto const fitted = [&](int rows) {
    std::string csv = "u,v,d\n";
    for (int i = 0; i < rows; ++i)
      csv += std::to_string(i % 97) + "," + std::to_string(i % 89) + "," + std::to_string(i % 7) + "\n";
    desk.save("deck.csv", csv);
    desk.save("deck.sysid",
              "model deck {\n  input u, v\n  parameter s ~ log_uniform(0.1, 10)\n  parameter noise ~ log_uniform(0.1, 10)\n"
              "  function f(u, v) ~ gp(squared_exponential(amplitude = s, length = (10, 10)))\n"
              "  observe d ~ normal(f(u, v), sd = noise)\n}\n"
              "data bench {\n  file \"deck.csv\"\n  input u = u\n  input v = v\n  measure d = d\n}\n"
              "best = fit deck to bench with map, seed = 1\n");
    return said_by("cd '" + desk.path(".").string() +
                   "' && ulimit -v 4000000 && '" SYSID_PROGRAM "' fit deck.sysid --quiet --no-figures --threads 1");
  };
  Said const many = fitted(20000);
  CHECK(many.exit == 65);
  CHECK_MESSAGE(many.text.find("error[E5003]: a likelihood of 20000 rows with a Gaussian process needs about 9.6 GB of memory") !=
                    std::string::npos,
                many.text);
  Said const few = fitted(60);
  CHECK_MESSAGE(few.exit <= 1, few.text);
}

TEST_CASE("a free run of a Gaussian process says what its matrix takes, also where the fit did without one") {
  if (sanitized) {
    MESSAGE("no limit of the address space holds the shadow memory of sanitizers");
    return;
  }
  LineDesk const desk;
  std::string csv = "y\n";
  for (int i = 0; i < 15000; ++i) csv += std::to_string(std::sin(0.1 * i) + 0.05 * (i % 7 - 3)) + "\n";
  desk.save("rows.csv", csv);
  desk.save("echo.sysid",
            "model echo {\n  time discrete 1 [s]\n  function f(before) ~ gp(matern32(amplitude = 1, length = 1))\n"
            "  parameter sigma ~ log_uniform(1e-2, 1)\n  observe y ~ normal(f(lag(measured(y), 1)), sd = sigma)\n}\n"
            "data record { file \"rows.csv\"; step 1 [s]; measure y = y; split few = rows 1..20 }\n"
            "best = fit echo to record with map, seed = 1\n"
            "free = predict best on record.few with draws(1), prediction = free_run, seed = 1\n");
  auto const limited = [&](char const* kilobytes, char const* verb) {
    return said_by("cd '" + desk.path(".").string() + "' && ulimit -v " + kilobytes + " && '" SYSID_PROGRAM "' " + verb +
                   " echo.sysid --quiet --no-figures --threads 1");
  };
  Said const fitted = limited("2000000", "fit");
  CHECK_MESSAGE(fitted.exit <= 1, fitted.text);
  Said const predicted = limited("1500000", "predict");
  CHECK(predicted.exit == 65);
  // The first row has none before it.
  CHECK_MESSAGE(has(predicted, "error[E5003]: a free run of a Gaussian process that is fitted to 14999 rows needs about 1.8 GB"),
                predicted.text);
}

TEST_CASE("a long simulation hears a request within a second, with any input") {
  LineDesk const desk;
  for (char const* input : {"gaussian(sd = 10)", "multisine(sd = 10, lowest = 5, highest = 400)"}) {
    desk.save("long.sysid", simulation(std::string("samples = 2000000, input x = ") + input));
    desk.save(
        "stop.sh",
        "'" SYSID_PROGRAM
        "' simulate long.sysid --quiet &\nwhile [ ! -e results ] && kill -0 $!; do sleep 0.05; done\nsleep 0.3\nkill -HUP $!\n"
        "began=$(date +%s%N)\nwait $!\ncode=$?\necho \"$(( ($(date +%s%N) - began) / 1000000 )) ms\"\nexit $code\n");
    Said const said = said_by("cd '" + desk.path(".").string() + "' && sh stop.sh");
    CHECK_MESSAGE(said.exit == 75, said.text);
    auto const end = said.text.rfind(" ms");
    REQUIRE(end != std::string::npos);
    CHECK_MESSAGE(std::stoi(said.text.substr(said.text.rfind('\n', end) + 1)) < 1500 * slower, said.text);  // on a busy machine
    CHECK_FALSE(desk.has("results"));
  }
}

TEST_CASE("of two runs into one folder the second is refused") {
  LineDesk const desk;
  std::string text = line_model;
  text.replace(text.find("samples = 60"), 12, "samples = 4000000");
  desk.save("long.sysid", text);
  desk.save("two.sh", "'" SYSID_PROGRAM "' fit long.sysid --quiet &\nsleep 0.7\n'" SYSID_PROGRAM
                      "' fit line.sysid --quiet --force\necho \"second: $?\"\nkill -KILL $!\nwait $! 2> /dev/null\n"
                      "'" SYSID_PROGRAM "' fit line.sysid --quiet --no-figures --force\necho \"third: $?\"\n");
  Said const said = said_by("cd '" + desk.path(".").string() + "' && sh two.sh");
  CHECK_MESSAGE(has(said, "error: another run of sysid (process "), said.text);
  CHECK_MESSAGE(has(said, "second: 65"), said.text);
  CHECK_MESSAGE((has(said, "third: 0") || has(said, "third: 1")), said.text);  // a killed run holds nothing
}
