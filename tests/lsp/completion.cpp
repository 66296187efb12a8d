// What is offered where. `|` marks the cursor.
#include "assist/completion.hpp"

#include <doctest/doctest.h>

#include "client.hpp"
#include "core/system/files.hpp"
#include "temporary_folder.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

struct Folder {
  TemporaryFolder folder;
  Folder() {
    write_file(folder.path() / "bench.csv", "t,force,\"displacement[1]\"\n0,1,2\n");
    write_file(folder.path() / "springs.sysid",
               "model spring {\n  input u [m]\n  parameter k [N/m] ~ log_uniform(1, 10)\n  derive force [N] = k*u\n}\n");
  }
  std::vector<std::string> at(std::string text) const {
    std::size_t const cursor = text.find('|');
    text.erase(cursor, 1);
    auto const found = assist::complete((folder.path() / "a.sysid").string(), text, static_cast<std::uint32_t>(cursor));
    std::vector<std::string> labels;
    for (assist::Completion const& each : found.items) labels.push_back(each.label);
    return labels;
  }
};

std::string const before = R"(use springs
function twice(a) = 2*a
dictionary law { input x [N]; state y [m] = c; target = x; terms = y }
data bench { file "bench.csv"; time t [s]; input x = force [N] hold linear; split train = rows 1..2 }
model osc(n = 1) {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter mass [kg] ~ log_uniform(1, 10)
  part s = spring(u = y)
  let speed = y'
  mass*y'' + s.force + n*y = x
  observe c ~ normal(y, sd = 1)
  )";
std::string const behind = "\n}\nposterior = fit osc to bench.train with mh(samples = 1000)\n";

}  // namespace

TEST_CASE("disturbances, random initial values and errors of inputs: laws with their arguments, what they drive, filters") {
  Folder const folder;
  CHECK(has(folder.at(before + "dist|" + behind), "disturbance"));
  auto const laws = folder.at(before + "disturbance w [N] ~ |" + behind);
  CHECK((has(laws, "white") && has(laws, "ornstein_uhlenbeck") && has(laws, "normal") && !has(laws, "uniform")));
  auto const arguments = folder.at(before + "disturbance w [N] ~ ornstein_uhlenbeck(|" + behind);
  CHECK((has(arguments, "sd") && has(arguments, "time") && has(arguments, "mass")));
  CHECK(has(folder.at(before + "disturbance wind [N] ~ white(intensity = 1)\n  let pressure = |" + behind), "wind"));
  std::string const file = before + behind;
  auto const column = folder.at(file + "data noisy { file \"bench.csv\"; time t [s]; input x = force [N] |");
  CHECK((has(column, "hold") && has(column, "error")));
  CHECK(folder.at(file + "data noisy { file \"bench.csv\"; input x = force [N] hold linear error |") ==
        std::vector<std::string>{"normal"});
  CHECK(has(folder.at(file + "data noisy { file \"bench.csv\"; input x = force [N] hold linear error normal(|"), "sd"));
  CHECK(has(folder.at(file + "a = fit osc to bench with map, filter = |"), "unscented"));
  CHECK(has(folder.at(file + "f = predict posterior on bench with prediction = |"), "one_step"));
}

TEST_CASE("at the top: items, verbs, subjects, data, options and their values") {
  Folder const folder;
  std::string const file = before + behind;
  auto const top = folder.at(file + "|");
  CHECK((has(top, "model") && has(top, "fit") && has(top, "use") && !has(top, "mass")));
  CHECK(folder.at(file + "forecast = |") == std::vector<std::string>{"simulate", "fit", "select", "discover", "predict"});
  CHECK(has(folder.at(file + "use |"), "springs"));
  CHECK(has(folder.at(file + "use hy|"), "hysteresis"));
  CHECK(folder.at(file + "forecast = predict |") == std::vector<std::string>{"posterior"});
  CHECK(folder.at(file + "second = fit osc to bench with map\nboth = predict posterior, |") ==
        std::vector<std::string>{"posterior", "second"});
  CHECK(has(folder.at(file + "both = predict posterior, posterior |"), "on"));
  CHECK(folder.at(file + "both = predict posterior on bench with weights = |") ==
        std::vector<std::string>{"evidence", "stacking", "pseudo_bma", "equal"});
  CHECK(folder.at(file + "found = discover |") == std::vector<std::string>{"law"});
  auto const subjects = folder.at(file + "fit |");
  CHECK((has(subjects, "osc") && has(subjects, "spring") && !has(subjects, "bench")));
  CHECK(folder.at(file + "a = fit osc |") == std::vector<std::string>{"to", "with"});
  CHECK(folder.at(file + "a = fit osc(|") == std::vector<std::string>{"n"});
  CHECK(folder.at(file + "a = fit osc to |") == std::vector<std::string>{"bench"});
  CHECK(folder.at(file + "a = fit osc to bench.|") == std::vector<std::string>{"train"});
  auto const options = folder.at(file + "a = fit osc to bench with |");
  CHECK((has(options, "mh") && has(options, "start") && has(options, "seed") && !has(options, "abc_smc")));
  CHECK(has(folder.at(file + "a = fit osc to bench with map, |"), "substeps"));
  auto const settings = folder.at(file + "a = fit osc to bench with mh(|");
  CHECK((has(settings, "samples") && has(settings, "burn_in") && !has(settings, "mass")));
  CHECK(has(folder.at(file + "a = fit osc to bench with mh(samples = 10, |"), "chains"));
  CHECK(has(folder.at(file + "a = fit osc to bench with mh(proposal = |"), "spherical"));
  CHECK(has(folder.at(file + "a = fit osc to bench with map, start = |"), "rest"));
  CHECK(has(folder.at(file + "a = fit osc to bench with map, solver = |"), "cvode"));
  CHECK(folder.at(file + "a = fit osc to bench with map, search = near(|") == std::vector<std::string>{"posterior"});
  CHECK(has(folder.at(file + "a = simulate osc with values(|"), "mass"));
  CHECK(folder.at(file + "a = simulate osc with input |") == std::vector<std::string>{"x"});
  CHECK(has(folder.at(file + "a = simulate osc with input x = |"), "multisine"));
  CHECK(has(folder.at(file + "a = simulate osc with input x = gaussian(|"), "sd"));
  CHECK(has(folder.at(file + "a = discover law from bench with spike_slab(derivatives = |"), "weak"));
}

TEST_CASE("in a model: statements, names in scope, functions, distributions, kernels, members of parts") {
  Folder const folder;
  auto const in_model = [&](std::string const& line) { return folder.at(before + line + behind); };
  auto const start = in_model("|");
  CHECK((has(start, "parameter") && has(start, "observe") && has(start, "mass") && has(start, "sqrt")));
  auto const expression = in_model("let e = ma|");
  for (char const* name : {"mass", "y", "x", "s", "speed", "n", "twice", "sqrt", "if", "pi"}) {
    CAPTURE(name);
    CHECK(has(expression, name));
  }
  CHECK((!has(expression, "normal") && !has(expression, "bench") && !has(expression, "k") && !has(expression, "parameter")));
  auto members = in_model("let e = s.|");
  std::sort(members.begin(), members.end());
  CHECK(members == std::vector<std::string>{"force", "k", "u"});
  auto const priors = in_model("parameter c2 ~ |");
  CHECK((has(priors, "normal") && has(priors, "log_uniform") && !has(priors, "mass") && !has(priors, "sqrt")));
  auto const noises = in_model("observe d ~ |");
  CHECK((has(noises, "student_t") && !has(noises, "log_uniform")));
  auto const arguments = in_model("parameter c2 ~ normal(0, |");
  CHECK((has(arguments, "sd") && has(arguments, "precision") && has(arguments, "lower") && has(arguments, "mass")));
  CHECK_FALSE(has(in_model("parameter c2 ~ normal(0, sd = |"), "precision"));
  CHECK(in_model("function g(a) ~ |") == std::vector<std::string>{"gp"});
  CHECK(has(in_model("function g(a) ~ gp(|"), "matern52"));
  CHECK(has(in_model("function g(a) ~ gp(matern52(|"), "amplitude"));
  CHECK(has(in_model("function g(width) = 2*|"), "width"));
  auto const models = in_model("part t = |");
  CHECK((has(models, "spring") && !has(models, "mass")));
  auto const bound = in_model("part t = spring(|");
  CHECK((has(bound, "u") && has(bound, "k")));
  CHECK(in_model("let e = measured(|") == std::vector<std::string>{"c"});
  CHECK(has(in_model("parameter c2 [|"), "mm"));
  CHECK(has(in_model("parameter c2 |"), "per"));
  CHECK(has(in_model("let e = y[|"), "n"));
  CHECK(in_model("let e = 1  # nor|").empty());
}

TEST_CASE("in data blocks, candidates and dictionaries: columns, files, rules, channels, families of terms") {
  Folder const folder;
  std::string const file = before + behind;
  auto const in_data = [&](std::string const& line) {
    return folder.at(file + "data more {\n  file \"bench.csv\"\n  " + line + "\n}\n");
  };
  CHECK(has(in_data("|"), "measure"));
  CHECK(in_data("time |") == std::vector<std::string>{"t", "force", "\"displacement[1]\""});
  CHECK(in_data("measure c = |").size() == 3);
  CHECK(has(in_data("input |"), "x"));
  CHECK(in_data("measure |") == std::vector<std::string>{"c"});
  CHECK(has(in_data("input x = force [N] |"), "hold"));
  CHECK(has(in_data("input x = force [N] hold |"), "band_limited"));
  CHECK(in_data("split train = |") == std::vector<std::string>{"rows"});
  CHECK(folder.at(file + "data more {\n  file \"be|\n}\n") == std::vector<std::string>{"bench.csv"});
  auto const set = folder.at(file + "candidates laws {\n  |\n}\n");
  CHECK((has(set, "osc") && has(set, "shared")));
  CHECK(has(folder.at(file + "candidates laws {\n  osc\n  shared |\n}\n"), "mass"));
  auto const terms = folder.at(file + "dictionary d {\n  input x [N]\n  state y [m] = c\n  target = x\n  terms = |\n}\n");
  CHECK((has(terms, "polynomial") && has(terms, "y") && has(terms, "sqrt") && !has(terms, "mass")));
  CHECK(has(folder.at(file + "dictionary d {\n  state y [m] = |\n}\n"), "c"));
}
