// Tasks: what their options mean in numbers, and what is refused.
#include "check/checked/harmonics.hpp"
#include "checking.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

std::string const file =
    "model m {\ninput x [kN]\nstate y [mm]\ninitial y = 0\nparameter k [N/mm] ~ log_uniform(1, 10)\nparameter s [mm] ~ "
    "half_normal(sd = 1)\n"
    "1 [N s/mm]*y' = x - k*y\nobserve displacement ~ normal(y, sd = s)\n}\n"
    "data d {\nfile \"d.csv\"\ntime t\ninput x = x hold linear\nmeasure displacement = y\nsplit train = rows 1..10, test = rows "
    "11..20\n}\n";

SimulateTask simulation(std::string const& options) {
  return std::get<SimulateTask>(checked(file + "truth = simulate m with " + options + "\n").tasks.at(0).what);
}
FitTask fit(std::string const& options) {
  return std::get<FitTask>(checked(file + "f = fit m to d.test with " + options + "\n").tasks.at(0).what);
}
PredictTask prediction(std::string const& options) {
  return std::get<PredictTask>(
      checked(file + "f = fit m to d.train with mh\np = predict f on d.test" + options + "\n").tasks.at(1).what);
}
std::string refused(std::string const& tasks) { return messages(file + tasks + "\n"); }

}  // namespace

TEST_CASE("numbers of a simulation are in the units of what they are for") {
  SimulateTask const task = simulation(
      "values(k = 2, s = 3), input x = sine(amplitude = 4, frequency = 5, mean = 6 [N]), noise = 7, samples = 8, rate = 9 [kHz]");
  CHECK(task.values[0].value() == near(2000));
  CHECK(task.values[1].value() == near(3e-3));
  CHECK(task.inputs[0].kind == InputGenerator::Kind::sine);
  CHECK(task.inputs[0].arguments.at("amplitude") == near(4000));
  CHECK(task.inputs[0].arguments.at("frequency") == near(5));
  CHECK(task.inputs[0].arguments.at("mean") == near(6));
  CHECK(task.noise_fraction == near(0.07));
  CHECK(task.samples == 8);
  CHECK(task.step == near(1 / 9e3));
  CHECK(task.file == "truth.csv");
}

TEST_CASE("a simulation needs the values of the parameters that it uses, not of others") {
  CHECK(simulation("values(k = 2), input x = constant(value = 1), noise = 1, samples = 10, step = 1").noise_fraction == near(0.01));
  std::string const shown = refused("simulate m with values(k = 2), input x = constant(value = 1), samples = 10, step = 1");
  CHECK(errors_in(shown) == 1);
  CHECK(shown.find("error[E6011]: a simulation needs a value for `s`") != std::string::npos);
}

TEST_CASE("a record is made under the name of a table") {
  auto const said = [](std::string const& name) {
    return refused("simulate m with values(k = 2, s = 3), input x = constant(value = 1), samples = 10, step = 1, file = \"" + name +
                   "\"");
  };
  for (char const* name : {"", "..", "a/b.csv", "summary.json", "report.html"}) {
    CHECK(errors_in(said(name)) == 1);
    CHECK(said(name).find("error[E6004]: `file` must be the name of a text table") != std::string::npos);
  }
  CHECK(errors_in(said("truth.txt")) == 0);
  CHECK(errors_in(said(".hidden.csv")) == 0);
}

TEST_CASE("settings of a back end are its defaults where they are not given") {
  FitTask const task = fit("mh(samples = 1e4, proposal = spherical), seed = 7, substeps = 3");
  CHECK(task.backend == "mh");
  CHECK(task.settings.integer("samples") == 10000);
  CHECK(task.settings.integer("burn_in") == 5000);
  CHECK(task.settings.word("proposal") == "spherical");
  CHECK(task.seed.value() == 7);
  CHECK(task.solver == SolverSettings{.substeps = 3});
  CHECK_FALSE(task.refine_solver);
  CHECK(task.experiments.at(0).part == 1);
  CHECK(fit("mh").settings.integer("samples") == 25000);
  CHECK(fit("mh, substeps = automatic").refine_solver);
  CHECK(fit("mh, solver = heun").solver.method == "heun");
  CHECK(fit("mh, solver = heun").refine_solver);
  CHECK(fit("mh, solver = heun(substeps = 3)").solver == SolverSettings{.method = "heun", .substeps = 3});
  CHECK_FALSE(fit("mh, solver = heun(substeps = 3)").refine_solver);
}

TEST_CASE("a start is the record's first row, rest or estimated") {
  CHECK(fit("mh").start.kind == StartRule::Kind::record);
  CHECK(fit("mh, start = rest").start.kind == StartRule::Kind::rest);
  StartRule const estimated = fit("mh, start = estimated(rows = 20)").start;
  CHECK(estimated.kind == StartRule::Kind::estimated);
  CHECK(estimated.rows == 20);
  CHECK(prediction(" with start = estimated").start.rows == 50);
  CHECK(refused("fit m to d with mh, start = rset").find("help: did you mean `rest`") != std::string::npos);
}

TEST_CASE("a prediction of several fits has one for each, with what the fits were fitted to") {
  std::string const fits = "f = fit m to d.train with mh\ng = fit m to d.train with nuts\n";
  auto const average = std::get<PredictTask>(
      checked(file + fits + "p = predict f, g on d.test with draws(50), weights = stacking, start = estimated\n").tasks.at(2).what);
  REQUIRE(average.members.size() == 2);
  CHECK(average.averages());
  CHECK(average.weights == AverageWeights::stacking);
  for (int k = 0; k < 2; ++k) {
    PredictTask const& member = average.members[static_cast<std::size_t>(k)];
    CHECK(member.fit == k);
    CHECK(member.draws == 50);
    CHECK(member.start.rows == 50);
    CHECK(member.experiments.size() == 1);
    CHECK(member.fitted == std::vector<int>{0});
    CHECK_FALSE(member.averages());
  }
  CHECK_FALSE(prediction("").averages());
}

TEST_CASE("predictions take 200 draws, one for each trajectory, unless told otherwise") {
  CHECK(prediction("").draws == 200);
  CHECK_FALSE(prediction("").redraw_each_step);
  CHECK(prediction(" with draws(50), redraw = step").draws == 50);
  CHECK(prediction(" with draws = 60, redraw = step").redraw_each_step);
}

TEST_CASE("a task without a name has one of its verb and subject") {
  CHECK(checked(file + "fit m to d with mh\n").tasks.at(0).name == "fit_m");
  std::string const shown = refused("fit m to d with mh\nfit m to d.train with mh");
  CHECK(errors_in(shown) == 1);
  CHECK(shown.find("error[E3013]: there are two tasks named `fit_m`") != std::string::npos);
}

TEST_CASE("an experiment is predicted once, and experiments that are predicted may overlap") {
  std::string const fitted = "f = fit m to d.train with mh\n";
  std::string const said = refused(fitted + "p = predict f on d.test, d.test");
  CHECK(errors_in(said) == 1);
  CHECK(said.find("error[E6304]: `d.test` would be predicted twice") != std::string::npos);
  CHECK(refused(fitted + "p = predict f on d, d").find("error[E6304]") != std::string::npos);
  CHECK(refused(fitted + "p = predict f on d, d.test").empty());
}

TEST_CASE("options are given once") {
  std::string const shown = refused("fit m to d with mh(chains = 2, chains = 3), seed = 1, seed = 2, map");
  CHECK(errors_in(shown) == 3);
  CHECK(shown.find("`the back end` is given twice") == std::string::npos);
  CHECK(shown.find("the back end is given twice") != std::string::npos);
  CHECK(errors_in(refused(
            "simulate m with values(k = 2, s = 1, k = 3), input x = gaussian(sd = 1, sd = 2), samples = 8, rate = 9")) == 2);
  CHECK(refused("simulate m with values(k = 2, s = 1), input x = gaussian(sd = 1), samples = 8, rate = 9, step = 1")
            .find("error[E4104]: the time between samples is given twice") != std::string::npos);
  CHECK(refused("fit m to d with mh, solver = heun, substeps = 2").find("error[E4104]: the solver is given twice") !=
        std::string::npos);
}

TEST_CASE("numbers outside their range or of the wrong kind are refused with what is allowed") {
  std::string const shown =
      refused("fit m to d with mh(samples = 0, chains = 1.5, burn_in = k, proposal = 3), substeps = 0, seed = -1");
  CHECK(errors_in(shown) == 6);
  CHECK(refused("fit m to d with mh, solver = rk5").find("did you mean `rk4`?") != std::string::npos);
  for (char const* each : {"`samples` must be at least 1, but is 0", "`chains` must be a whole number",
                           "`k` is not a number, and names cannot be used here", "help: choose `adaptive`, `walk` or `spherical`",
                           "`substeps` must lie between 1 and 10000", "`seed` must not be negative"})
    CHECK_MESSAGE(shown.find(each) != std::string::npos, each);
}

TEST_CASE("a solver of a model without differential equations is a warning") {
  std::string const text =
      "model map { time discrete 1 [s]; parameter a ~ uniform(0, 1); observe z ~ normal(a*lag(measured(z), 1), sd = 1) }\n"
      "model line { input u; parameter b ~ normal(0, sd = 1); observe z ~ normal(b*u, sd = 1) }\n"
      "data d { file \"d.csv\"; rate 1 [Hz]; input u = u; measure z = z }\n";
  for (std::string const model : {"map", "line"})
    for (std::string const option : {"solver = cvode", "substeps = 4", "solver = rk4(substeps = 2)"}) {
      CAPTURE(model);
      CAPTURE(option);
      std::string const said = messages(text + "fit " + model + " to d with map, " + option + "\n");
      CHECK(errors_in(said) == 0);
      CHECK(said.find("warning[E6019]: `" + model + "` has no differential equations to integrate") != std::string::npos);
    }
  CHECK(refused("fit m to d with mh, solver = cvode").empty());
}

TEST_CASE("a back end without settings says so") {
  CHECK(refused("fit m to d with map(3)").find("help: it takes none") != std::string::npos);
  CHECK(refused("fit m to d with map(samples = 3)").find("help: it has none") != std::string::npos);
}

TEST_CASE("a number in a unit of another kind is refused where one is wanted") {
  std::string const shown = refused(
      "simulate m with values(k = 2 [N], s = 3 [um]), input x = gaussian(sd = 1 [m]), noise = 1 [kg], samples = 8, rate = 9 [s]");
  CHECK(errors_in(shown) == 4);
  for (char const* each : {"`k` is in [N/mm], but this is in [N]", "`sd` is in [kN], but this is in [m]",
                           "`noise` is a pure number, but this is in [kg]", "`rate` is in [Hz], but this is in [s]"})
    CHECK_MESSAGE(shown.find(each) != std::string::npos, shown);
}

TEST_CASE("the sd of a generated temperature counts degrees, whatever the zero points") {
  for (char const* const input : {"degC", "K"}) {
    CAPTURE(input);
    std::string const room = "model room {\ninput T [" + std::string(input) +
                             "]\nstate y [m]\ninitial y = 0\ny' = 0 [m/s]\nobserve d ~ normal(y, sd = 1)\n}\n"
                             "made = simulate room with input T = ";
    auto const generated = [&](std::string const& signal) {
      return std::get<SimulateTask>(checked(room + signal + ", samples = 8, rate = 9\n").tasks.at(0).what).inputs.at(0).arguments;
    };
    CHECK(generated("gaussian(mean = 293 [K], sd = 5 [degC])").at("sd") == near(5));
    CHECK(generated("gaussian(mean = 293 [K], sd = 5 [delta_degC])").at("sd") == near(5));
    CHECK(generated("gaussian(mean = 293 [K], sd = 5)").at("sd") == near(5));
    CHECK(generated("sine(amplitude = 9 [degF], frequency = 1)").at("amplitude") == near(5));
    // A mean has its zero point.
    CHECK(generated("gaussian(mean = 20 [degC], sd = 5)").at("mean") == near(std::string(input) == "K" ? 293.15 : 20));
  }
}

TEST_CASE("a multisine has harmonics in its band, below half the rate") {
  auto const band = [](std::string const& limits) {
    return refused("simulate m with values(k = 1, s = 1), input x = multisine(sd = 1, " + limits +
                   "), samples = 100, rate = 10 [Hz]");
  };
  CHECK(band("lowest = 1, highest = 4").empty());
  CHECK(band("lowest = 0.1, highest = 0.1").empty());  // the first harmonic, 10 Hz / 100
  CHECK(band("lowest = 1, highest = 5").find("error[E6101]: this multisine reaches 5 Hz, but half the sampling rate is 5 Hz") !=
        std::string::npos);
  CHECK(band("lowest = 1.01, highest = 1.09").find("error[E6101]: no harmonic of the record (a multiple of 0.1 Hz)") !=
        std::string::npos);
  CHECK(band("lowest = 0, highest = 0.05").find("error[E6101]: no harmonic") != std::string::npos);
}

TEST_CASE("a multisine has the harmonics on the limits of its band, whatever the rounding") {
  auto const of = [](double lowest, double highest) { return harmonics_in_band(lowest, highest, 1000, 0.01); };
  CHECK(of(0.1, 0.3).first == 1);
  CHECK(of(0.1, 0.3).last == 3);
  CHECK(of(0.3, 0.3).first == 3);  // 3 * 0.1 is more than 0.3
  CHECK(of(0.3, 0.3).last == 3);
  CHECK(of(0, 0.7).last == 7);
  CHECK(of(0.31, 0.39).empty());
  CHECK(of(1e300, 49).empty());
  CHECK(harmonics_in_band(0, 4.99999, 100, 0.1).last == 49);
  CHECK(refused("simulate m with values(k = 1, s = 1), input x = multisine(sd = 1, lowest = 0.3, highest = 0.3), samples = 1000, "
                "rate = 100")
            .empty());
}

TEST_CASE("a sine at or above half the rate is refused: its samples are those of another") {
  auto const said = [](std::string const& frequency) {
    return refused("simulate m with values(k = 1, s = 1), input x = sine(amplitude = 1, frequency = " + frequency +
                   "), samples = 100, rate = 1000 [Hz]");
  };
  CHECK(said("499.9").empty());
  CHECK(said("900 [Hz]").find("error[E6101]: this sine has 900 Hz, but half the sampling rate is 500 Hz") != std::string::npos);
  CHECK(said("0.5 [kHz]").find("error[E6101]") != std::string::npos);
}

TEST_CASE("a misspelt name of each kind is answered with the one that is near") {
  for (auto const& [task, guess] : std::map<std::string, std::string>{
           {"fit n to d with mh", "there is no model `n`"},
           {"fit m to dd with mh", "did you mean `d`?"},
           {"fit m to d.tset with mh", "did you mean `test`?"},
           {"fit m to d with hm", "did you mean `mh`?"},
           {"fit m to d with hm(samples = 3)", "did you mean `mh`?"},
           {"fit m to d with mh(sampels = 3)", "did you mean `samples`?"},
           {"fit m to d with mh(proposal = adaptve)", "did you mean `adaptive`?"},
           {"fit m to d with mh, sead = 3", "did you mean `seed`?"},
           {"p = fit m to d with mh\nf = predict pp on d", "did you mean `p`?"},
           {"p = fit m to d with mh\nf = predict p on d with draw(20)", "did you mean `draws`"},
           {"p = fit m to d with mh\nf = predict p on d with redraw = stpe", "did you mean `step`?"},
           {"p = fit m to d with mh\nq = fit m to d with mh\nf = predict p, q on d with weights = stack",
            "did you mean `stacking`?"},
           {"p = fit m to d with mh\nq = fit m to d with mh\nf = predict p, qq on d", "did you mean `q`?"},
           {"simulate m with vlaues(k = 1)", "did you mean `values`?"},
           {"simulate m with values(kk = 1)", "did you mean `k`?"},
           {"simulate m with input xx = constant(value = 1)", "did you mean `x`?"},
           {"simulate m with input x = gausian(sd = 1)", "did you mean `gaussian`?"},
           {"simulate m with input x = gaussian(ds = 1)", "did you mean `sd`?"},
           {"simulate m with input x = gaussian(sd = 1, hold = liner)", "did you mean `linear`?"},
           {"simulate m with sampels = 3", "did you mean `samples`?"},
       }) {
    std::string const shown = refused(task);
    CAPTURE(task);
    CHECK_MESSAGE(shown.find(guess) != std::string::npos, shown);
  }
}
