// A fit by two back ends from the text to the folder of the comparison.
#include "app/calibration/crosscheck.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "core/numeric/random.hpp"
#include "core/system/files.hpp"
#include "core/system/interrupt.hpp"
#include "core/text/number.hpp"
#include "load/load.hpp"
#include "temporary_folder.hpp"

using namespace sysid;
using nlohmann::json;

namespace {

struct CrosscheckDesk {
  TemporaryFolder folder;
  RunOptions options;
  std::string out, said;

  CrosscheckDesk() {
    Stream stream({51, Purpose::test, 0, 0});
    std::string csv = "u,d\n";
    for (int i = 0; i < 40; ++i) csv += shortest(0.1 * i) + "," + shortest(0.2 * i + 0.3 * stream.normal()) + "\n";
    write_file(folder.path() / "bench.csv", csv);
    options.output = folder.path() / "results";
    options.figures = false;
  }
  int run(std::string const& backend, CrosscheckOptions const& asked = {}) {
    std::string const text =
        "model line {\n  input u\n  parameter slope ~ normal(0, sd = 10)\n  parameter sigma ~ log_uniform(0.01, 10)\n"
        "  observe d ~ normal(slope*u, sd = sigma)\n}\ndata bench { file \"bench.csv\"; input u = u; measure d = d }\n"
        "posterior = fit line to bench with " +
        backend + ", seed = 3\n";
    Source source((folder.path() / "case.sysid").string(), text);
    Diagnostics diagnostics;
    auto const file = load(source, diagnostics);
    REQUIRE(file);
    SilentProgress silent;
    std::ostringstream printed, notices;
    Session session(source, *file, options, silent, printed, notices);
    ExitCode const code = crosscheck(session, asked);
    out = printed.str();
    said = notices.str();
    return static_cast<int>(code);
  }
  json summary() const { return json::parse(read_file(options.output / "posterior/summary.json")); }
};

}  // namespace

TEST_CASE("two back ends agree on a straight line, number by number") {
  CrosscheckDesk desk;
  CHECK(desk.run("mh") == 0);
  CHECK(desk.out.find("mh and nuts agree: the largest of 10 differences is ") != std::string::npos);
  json const summary = desk.summary();
  CHECK(summary.at("verb") == "crosscheck");
  CHECK(summary.at("tables").at("both back ends").at("rows").size() == 10);
  CHECK(summary.at("settings").at("mh backend") == "mh");
  CHECK(summary.at("settings").at("nuts backend") == "nuts");
}

TEST_CASE("the other back end is the one that is named, and none that cannot judge") {
  CrosscheckDesk desk;
  CHECK(desk.run("nuts", {{}, "tempering"}) == 0);
  CHECK(desk.out.find("nuts and tempering agree") != std::string::npos);
  CHECK_THROWS_AS(desk.run("mh", {{}, "mh"}), UserError);
  CHECK_THROWS_AS(desk.run("mh", {{}, "map"}), UserError);
  CHECK_THROWS_AS(desk.run("mh", {{}, "auto"}), UserError);
  CHECK_THROWS_AS(desk.run("mh", {"prior", {}}), UserError);
}

TEST_CASE("an interrupted comparison keeps nothing, and promises nothing that there is not") {
  CrosscheckDesk desk;
  desk.options.interrupt_after = 1;
  CHECK(desk.run("mh") == 75);
  clear_interrupt();
  CHECK(desk.said.find("interrupted; nothing is kept") != std::string::npos);
  CHECK(desk.said.find("--resume") == std::string::npos);
  CHECK_FALSE(std::filesystem::exists(desk.options.output / "posterior/summary.json"));
  CHECK_FALSE(std::filesystem::exists(desk.options.output / "posterior/checkpoint.cbor"));
}

TEST_CASE("a comparison takes the place of an interrupted run only when it is told to") {
  CrosscheckDesk desk;
  std::filesystem::create_directories(desk.options.output / "posterior");
  write_file(desk.options.output / "posterior/checkpoint.cbor", "of another run");
  CHECK_THROWS_AS(desk.run("mh"), UserError);
  desk.options.force = true;
  CHECK(desk.run("mh") == 0);
  CHECK_FALSE(std::filesystem::exists(desk.options.output / "posterior/checkpoint.cbor"));
}

TEST_CASE("what `auto` has chosen is compared with another back end, drawn with other random numbers") {
  CrosscheckDesk desk;
  CHECK(desk.run("auto") == 0);
  CHECK(desk.out.find("mh and nuts agree") != std::string::npos);
  json const settings = desk.summary().at("settings");
  CHECK(settings.at("mh seed") == 3);
  CHECK(settings.at("nuts seed") != 3);
  desk.options.force = true;
  CHECK_THROWS_AS(desk.run("auto", {{}, "mh"}), UserError);
}

TEST_CASE("an optimum is held to the draws of a sampler") {
  CrosscheckDesk desk;
  CHECK(desk.run("map") == 0);
  CHECK(desk.summary().at("tables").at("both back ends").at("rows").size() == 4);
}
