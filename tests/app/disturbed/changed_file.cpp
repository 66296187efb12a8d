// What `--with-disturbance` makes of a text, before anything is fitted with it.
#include "app/disturbed/changed_file.hpp"

#include <doctest/doctest.h>

#include "app/running.hpp"

using namespace sysid;

namespace {

bool has(std::string const& text, std::string const& part) { return text.find(part) != std::string::npos; }

/// The equations of the first fit of a text.
struct Found {
  Source source;
  CheckedFile file;
  Task const* fit = nullptr;
  std::vector<DisturbedEquation> equations;

  explicit Found(std::string const& text, bool wanted = true) : source("case.sysid", text) {
    Diagnostics diagnostics;
    auto loaded = load(source, diagnostics);
    REQUIRE_MESSAGE(loaded, render(diagnostics, source));
    file = std::move(*loaded);
    for (Task const& task : file.tasks)
      if (fit == nullptr && std::holds_alternative<FitTask>(task.what)) fit = &task;
    REQUIRE(fit != nullptr);
    if (wanted) equations = disturbed_equations(source, file, *fit);
  }
  std::string changed(DisturbanceSize const& size) const {
    return text_with_disturbances(source, *fit, equations, std::vector<DisturbanceSize>(equations.size(), size),
                                  "results/post_with_disturbance");
  }
  /// What is said where no disturbance can be added, and the text at its place.
  std::pair<std::string, std::string> refusal() const {
    try {
      disturbed_equations(source, file, *fit);
    } catch (UserError const& error) {
      Diagnostic const& said = error.diagnostic();
      REQUIRE(said.primary);
      CHECK(!said.help.empty());
      return {said.message, std::string(source.text(said.primary->span))};
    }
    return {};
  }
};

bool can_be_loaded(std::string const& text) {
  Source source("changed.sysid", text);
  Diagnostics diagnostics;
  bool const good = load(source, diagnostics).has_value();
  INFO(render(diagnostics, source));
  CHECK(good);
  return good;
}

std::string const mast = R"(# A mast.
model mast {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter m [kg] ~ log_uniform(0.1, 10)  # with the sensor
  parameter k [N/m] ~ log_uniform(10, 1e4)
  m*y'' + 1 [N s/m]*y' + k*y = x  # Newton
  observe top ~ normal(y, sd = 1 [mm])
}
data bench { file "records/b.csv"; time t [s]; input x = x [N] hold linear; measure top = y [m] }

truth = simulate mast with values(m = 1, k = 100), input x = gaussian(sd = 1), samples = 50, rate = 10 [Hz], seed = 1
post  = fit mast to bench with map, seed = 1
other = fit mast to bench with map, search = near(post), seed = 2
ahead = predict post on bench with draws(10), seed = 1
)";

}  // namespace

TEST_CASE("the text stays as it is but for the disturbance, the paths and the tasks that belong to other fits") {
  Found const found(mast);
  REQUIRE(found.equations.size() == 1);
  std::string const text = found.changed({"N", 2.0, 0.1});
  CHECK(has(text, "# A mast.\nmodel mast {"));
  CHECK(has(text, "~ log_uniform(0.1, 10)  # with the sensor\n"));
  // (1e-4 * 2 N)^2 * 0.1 s and (10 * 2 N)^2 * 0.1 s, to powers of ten.
  CHECK(has(text, "\n  parameter unmeasured_intensity [N^2 s] ~ log_uniform(1e-8, 100)\n"));
  CHECK(has(text, "\n  disturbance unmeasured [N] ~ white(intensity = unmeasured_intensity)\n"));
  CHECK(has(text, "\n  derive unmeasured_rms [N] = sqrt(unmeasured_intensity/(0.1 [s]))\n"));
  CHECK(has(text, "\n  m*y'' + 1 [N s/m]*y' + k*y = x + unmeasured  # Newton\n"));
  CHECK(has(text, "file \"../../records/b.csv\";"));
  CHECK(has(text, "\npost_with_disturbance  = fit mast to bench with map, seed = 1\n"));
  CHECK(has(text, "\nahead_with_disturbance = predict post_with_disturbance on bench with draws(10), seed = 1\n"));
  CHECK_FALSE(has(text, "truth"));
  CHECK_FALSE(has(text, "other"));
  CHECK(can_be_loaded(text));
  CHECK(can_be_loaded(text_with_probes(found.source, found.equations)));
}

TEST_CASE("a side that is zero, one that is a choice, and names that are taken") {
  Found const zero(with(mast, "+ k*y = x", "+ k*y - x = 0"));
  CHECK(has(zero.changed({"N", 1, 0.1}), "+ k*y - x = unmeasured  #"));
  Found const choice(with(mast, "= x  # Newton", "= if x > 0 [N] then x else 2*x"));
  CHECK(has(choice.changed({"N", 1, 0.1}), "= (if x > 0 [N] then x else 2*x) + unmeasured\n"));
  Found const closed(with(mast, "= x  # Newton", "= (if x > 0 [N] then x else 2*x)"));
  CHECK(can_be_loaded(closed.changed({"N", 1, 0.1})));
  Found const taken(with(mast, "parameter m [kg]", "parameter unmeasured [-] ~ normal(0, sd = 1)\n  parameter m [kg]"));
  CHECK(has(taken.changed({"N", 1, 0.1}), "= x + unmeasured_2  #"));
  // A unit that is no single word, and none.
  CHECK(has(zero.changed({"kg m/s^2", 1, 0.1}), "[(kg m/s^2)^2 s]"));
  CHECK(has(zero.changed({"", 1, 0.1}), "parameter unmeasured_intensity ~"));
}

TEST_CASE("each equation of motion gets a disturbance of its own, and nothing else does") {
  // y' = v moves nothing by itself; z has no mass, as long as something has.
  Found const pair(
      "model pair {\n input x [N]\n state y [m], z [m]\n initial y = 0, y' = 0, z = 0\n"
      " parameter k [N/m] ~ log_uniform(1, 100)\n"
      " 1 [kg]*y'' + k*(y - z) = x\n 1 [N s/m]*z' = k*(y - z)\n observe d ~ normal(y, sd = 1)\n}\n"
      "data b { file \"b.csv\"; time t [s]; input x = x [N] hold linear; measure d = y [m] }\npost = fit pair to b with map\n");
  REQUIRE(pair.equations.size() == 1);
  CHECK(pair.source.text(pair.equations[0].place).starts_with("1 [kg]*y''"));
  Found const first_order(
      "model tanks {\n input x [m/s]\n state h [m], g [m], v [m/s]\n initial h = 0, g = 0, v = 0\n"
      " parameter k [1/s] ~ log_uniform(1, 100)\n h' = v\n v' = 1 [1/s]*x - k*v\n g' = k*(h - g)\n observe d ~ normal(g, sd = "
      "1)\n}\n"
      "data b { file \"b.csv\"; time t [s]; input x = x [m/s] hold linear; measure d = y [m] }\npost = fit tanks to b with map\n");
  REQUIRE(first_order.equations.size() == 2);
  CHECK(first_order.equations[0].name == "unmeasured_v");
  CHECK(first_order.equations[1].name == "unmeasured_g");
}

TEST_CASE("a vector equation gets a vector, a part its own, and a model in discrete time noise from sample to sample") {
  std::string const vector =
      "model row {\n input x [N]\n state q(2) [m]\n initial q = 0, q' = 0\n parameter k [N/m] ~ log_uniform(1, 100)\n"
      " 1 [kg]*q'' + 1 [N s/m]*q' + k*q = (x, x)\n observe d ~ normal(q[1], sd = 1)\n}\n"
      "data b { file \"b.csv\"; time t [s]; input x = x [N] hold linear; measure d = y [m] }\npost = fit row to b with map\n";
  Found const row(vector);
  CHECK(has(row.changed({"N", 1, 0.1}), "disturbance unmeasured(2) [N] ~ white"));
  CHECK(can_be_loaded(row.changed({"N", 1, 0.1})));
  CHECK(can_be_loaded(text_with_probes(row.source, row.equations)));
  Found const parts(
      "model body {\n input f [N]\n state y [m]\n initial y = 0, y' = 0\n parameter k [N/m] ~ log_uniform(1, 100)\n"
      " 1 [kg]*y'' + k*y = f\n}\nmodel two {\n input x [N]\n part a = body(f = x)\n part b = body(f = x)\n"
      " observe d ~ normal(a.y + b.y, sd = 1)\n}\n"
      "data b { file \"b.csv\"; time t [s]; input x = x [N] hold linear; measure d = y [m] }\npost = fit two to b with map\n");
  REQUIRE(parts.equations.size() == 1);  // one text for both
  std::string const text = parts.changed({"N", 1, 0.1});
  CHECK(has(text, "1 [kg]*y'' + k*y = f + unmeasured\n"));
  CHECK(can_be_loaded(text));
  Found const discrete(
      "model level {\n time discrete 1 [s]\n input u\n state y [m]\n initial y = 0\n parameter a ~ uniform(-1, 1)\n"
      " y = a*lag(y, 1) + 1 [m]*u\n observe d ~ normal(y, sd = 1)\n}\n"
      "data b { file \"b.csv\"; time t [s]; input u = x; measure d = y [m] }\npost = fit level to b with map\n");
  std::string const sampled = discrete.changed({"m", 2, 1});
  CHECK(has(sampled, "parameter unmeasured_sd [m] ~ log_uniform(1e-4, 10)\n"));
  CHECK(has(sampled, "disturbance unmeasured [m] ~ normal(0, sd = unmeasured_sd)\n"));
  CHECK(has(sampled, "y = a*lag(y, 1) + 1 [m]*u + unmeasured\n"));
  CHECK(can_be_loaded(sampled));
}

TEST_CASE("a fit without a name of a model with arguments stays in the file") {
  Found const found(
      "model row(n = 2) {\n input x [N]\n state q(n) [m]\n initial q = 0, q' = 0\n parameter k [N/m] ~ log_uniform(1, 100)\n"
      " 1 [kg]*q'' + k*q = x*unit_vector(n, n)\n observe d ~ normal(q[1], sd = 1)\n}\n"
      "data b { file \"b.csv\"; time t [s]; input x = x [N] hold linear; measure d = y [m] }\nfit row to b with map\n"
      "fit row(n = 3) to b with map\n");
  std::string const text = found.changed({"N", 1, 0.1});
  INFO(text);
  CHECK(has(text, found.fit->name + "_with_disturbance = fit row to b with map\n"));
  CHECK_FALSE(has(text, "fit row(n = 3)"));
  CHECK(can_be_loaded(text));
}

TEST_CASE("a model that can have no disturbance is refused where it says so") {
  auto const refused = [](std::string const& text) { return Found(text, false).refusal(); };
  auto const [has_one, at_one] =
      refused(with(with(mast, "  m*y''", "  disturbance w [N] ~ white(intensity = 1)\n  m*y''"), "= x  # Newton", "= x + w"));
  CHECK(has_one == "`mast` already has a disturbance");
  CHECK(at_one == "w");
  auto const [heavy, at_heavy] =
      refused(with(mast, "normal(y, sd = 1 [mm])", "student_t(y, scale = 1 [mm], degrees_of_freedom = 4)"));
  CHECK(has(heavy, "the noise of `top` is not normal"));
  CHECK(at_heavy == "top");
  auto const [rows, at_rows] = refused(
      "model line {\n input x\n parameter a ~ normal(0, sd = 1)\n observe d ~ normal(a*x, sd = 1)\n}\n"
      "data b { file \"b.csv\"; input x = x; measure d = y }\npost = fit line to b with map\n");
  CHECK(has(rows, "`line` has no states"));
  CHECK(has(at_rows, "fit"));
  auto const [past, at_past] = refused(
      "model arx {\n time discrete 1 [s]\n input u\n parameter a ~ uniform(-1, 1)\n"
      " observe d ~ normal(a*lag(measured(d), 1) + lag(u, 1), sd = 1)\n}\n"
      "data b { file \"b.csv\"; time t [s]; input u = x; measure d = y }\npost = fit arx to b with map\n");
  CHECK(has(past, "no equation to which a disturbance can be added"));
  CHECK(has(at_past, "fit"));
  auto const [process, at_process] =
      refused(with(with(mast, "  observe", "  function f(t) ~ gp(squared_exponential(amplitude = 1 [mm], length = 1))\n  observe"),
                   "normal(y, sd", "normal(y + f(x/1 [N]), sd"));
  CHECK(has(process, "Gaussian process"));
  CHECK(!at_process.empty());
}
