// Several experiments in one task: their names, the values that data blocks fix, which fitted one a prediction is of.
#include "checking.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

std::string const fleet_model =
    "model m {\ninput x\nstate y [m]\ninitial y = 0\nparameter dose per experiment [g]\nparameter mass per experiment [kg] = 2\n"
    "parameter k per experiment [N/mm] ~ log_uniform(1, 10)\nparameter c ~ log_uniform(1, 10)\n"
    "y' = x - k*y/mass*c*dose\nobserve displacement ~ normal(y, sd = 1)\n}\n";

std::string block_of(std::string const& name, std::string const& more) {
  return "data " + name + " {\nfile \"d.csv\"\ntime t\ninput x = x hold linear\nmeasure displacement = y\n" +
         "split early = rows 1..10, late = rows 11..20\n" + more + "\n}\n";
}
std::string const blocks = block_of("bench", "constant dose = 30 [mg]") +
                           block_of("hall", "constant dose = 5; constant mass = 700 [g]") +
                           block_of("field", "constant dose = 1; constant k = 3");

std::vector<ExperimentUse> fitted_uses(std::string const& data) {
  return std::get<FitTask>(checked(fleet_model + blocks + "f = fit m to " + data + " with mh\n").tasks.at(0).what).experiments;
}
std::string refused_tasks(std::string const& text) { return messages(fleet_model + blocks + text + "\n"); }

}  // namespace

TEST_CASE("experiments are named by their blocks, and by their parts too where a block is used twice") {
  auto const plain = fitted_uses("bench.late, hall");
  REQUIRE(plain.size() == 2);
  CHECK(plain[0].name == "bench");
  CHECK(plain[0].part == 1);
  CHECK(plain[1].name == "hall");
  CHECK(plain[1].part == -1);
  auto const twice = fitted_uses("bench.late, hall, bench.early");
  CHECK(twice[0].name == "bench.late");
  CHECK(twice[1].name == "hall");
  CHECK(twice[2].name == "bench.early");
}

TEST_CASE("constants are in SI, bare ones in the unit of the parameter, and take the place of a value or a prior") {
  auto const uses = fitted_uses("bench, hall, field");
  CHECK(uses[0].constants[0].value() == near(30e-6));
  CHECK_FALSE(uses[0].constants[1]);
  CHECK_FALSE(uses[0].constants[2]);
  CHECK(uses[1].constants[0].value() == near(5e-3));
  CHECK(uses[1].constants[1].value() == near(0.7));
  CHECK(uses[2].constants[2].value() == near(3e3));
}

TEST_CASE("constants are converted to the zero point of their parameter, and refused where they are of another kind") {
  std::string const room =
      "model room {\ninput x\nstate T [degC]\ninitial T = Ta\nparameter Ta per experiment [degC]\n"
      "parameter Tk per experiment [K] = 300\nparameter rise per experiment [delta_degC] = 1\n"
      "parameter w per experiment [rad/s] = 1\nparameter k [1/s] ~ log_uniform(1, 10)\n"
      "T' = -k*(T - Ta - rise)*sin(w*1 [s])*Tk/300 [K]\nobserve displacement ~ normal(T, sd = 1)\n}\n";
  auto const with = [&](std::string const& constants) { return room + block_of("d", constants) + "f = fit room to d with map\n"; };
  auto const values = [&](std::string const& constants) {
    return std::get<FitTask>(checked(with(constants)).tasks.at(0).what).experiments.at(0).constants;
  };
  CHECK(values("constant Ta = 300 [K]")[0].value() == doctest::Approx(26.85).epsilon(1e-12));
  CHECK(values("constant Ta = 68 [degF]")[0].value() == doctest::Approx(20).epsilon(1e-12));
  CHECK(values("constant Ta = 20")[0].value() == 20);
  CHECK(values("constant Ta = 20; constant Tk = 20 [degC]")[1].value() == doctest::Approx(293.15).epsilon(1e-12));
  CHECK(values("constant Ta = 20; constant rise = 5 [K]")[2].value() == 5);
  auto const said = [&](std::string const& constants) { return messages(with("constant Ta = 20; " + constants)); };
  CHECK(said("constant rise = 5 [degC]").find("error[E2014]: the constant `rise` is in [delta_degC], but this is in [degC]") !=
        std::string::npos);
  CHECK(said("constant w = 1 [Hz]").find("error[E4017]: the constant `w` is in [rad/s], but this is in [Hz]: one counts cycles") !=
        std::string::npos);
  CHECK(errors_in(said("constant w = 60 [1/s]")) == 0);
}

TEST_CASE("values and rates of a task are not taken in cycles for radians, and widths of temperatures have no zero point") {
  std::string const oven =
      "model oven {\ninput T [degC]\nparameter w [rad/s] ~ log_uniform(1, 10)\nparameter Ta [degC] ~ normal(20, sd = 1)\n"
      "observe c ~ normal((T - Ta)*w, sd = 1 [K rad/s])\n}\n";
  auto const with = [&](std::string const& w, std::string const& input, std::string const& rate) {
    return oven + "s = simulate oven with values(w = " + w + ", Ta = 300 [K]), input T = gaussian(" + input + "), rate = " + rate +
           ", noise = 0, samples = 3, seed = 1\n";
  };
  CHECK(messages(with("1 [Hz]", "sd = 1", "1 [Hz]")).find("error[E4017]: `w` is in [rad/s], but this is in [Hz]") !=
        std::string::npos);
  CHECK(messages(with("1", "sd = 1", "1 [rad/s]")).find("error[E4017]: `rate` is in [Hz], but this is in [rad/s]") !=
        std::string::npos);
  auto const task = std::get<SimulateTask>(checked(with("1", "mean = 300 [K], sd = 2 [K]", "1 [Hz]")).tasks.at(0).what);
  CHECK(task.values[1].value() == doctest::Approx(26.85).epsilon(1e-12));
  CHECK(task.inputs[0].arguments.at("mean") == doctest::Approx(26.85).epsilon(1e-12));
  CHECK(task.inputs[0].arguments.at("sd") == 2);
}

TEST_CASE("a prediction has the parameters of the fitted experiment of its block, else of a new one") {
  auto const of = [](std::string const& tasks) {
    return std::get<PredictTask>(checked(fleet_model + blocks + tasks).tasks.at(1).what).fitted;
  };
  CHECK(of("f = fit m to bench.early, hall with mh\np = predict f on hall.late, field, bench.late\n") ==
        std::vector<int>{1, -1, 0});
  CHECK(of("f = fit m to bench.early, bench.late with mh\np = predict f on bench.late, bench\n") == std::vector<int>{1, -1});
}

TEST_CASE("what a data block fixes must be a parameter that experiments have for themselves") {
  std::string const other =
      messages(fleet_model + block_of("b", "constant dose = 1; constant dosis = 2") + "f = fit m to b with mh\n");
  CHECK(other.find("error[E6301]") != std::string::npos);
  CHECK(other.find("did you mean") != std::string::npos);
  CHECK(messages(fleet_model + block_of("b", "constant dose = 1; constant c = 2") + "f = fit m to b with mh\n")
            .find("error[E6302]") != std::string::npos);
  CHECK(messages(fleet_model + block_of("b", "") + "f = fit m to b with mh\n").find("error[E6303]") != std::string::npos);
  CHECK(messages(fleet_model + block_of("b", "constant dose = 1 [s]") + "f = fit m to b with mh\n").find("error[E2014]") !=
        std::string::npos);
  CHECK(messages(fleet_model + block_of("b", "constant dose = 1; constant dose = 2")).find("error[E4104]") != std::string::npos);
  // Said once, however many tasks use the block.
  CHECK(errors_in(messages(fleet_model + block_of("b", "constant dose = 1; constant c = 2") +
                           "f = fit m to b with mh\ng = fit m to b.late with mh\n")) == 1);
  // A block may serve several models.
  std::string const second =
      "model n {\ninput x\nstate y [m]\ninitial y = 0\nparameter c ~ log_uniform(1, 10)\ny' = x - c*y\n"
      "observe displacement ~ normal(y, sd = 1)\n}\n";
  CHECK(messages(fleet_model + second + blocks + "f = fit n to bench with mh\n").empty());
}

TEST_CASE("rows are used once") {
  CHECK(refused_tasks("f = fit m to bench, hall, bench with mh").find("error[E6304]: `bench` is used twice") != std::string::npos);
  CHECK(refused_tasks("f = fit m to bench.late, bench with mh").find("error[E6304]: `bench` and `bench.late` overlap") !=
        std::string::npos);
  CHECK(errors_in(refused_tasks("f = fit m to bench.early, bench.late with mh")) == 0);
}

TEST_CASE("a shared parameter's prior cannot read what experiments have for themselves") {
  std::string const shown = messages(
      "model m {\ninput x\nstate y\ninitial y = 0\nparameter k per experiment ~ normal(0, sd = 1)\nparameter c ~ normal(k, sd = "
      "1)\ny' = x - c*k*y\nobserve d ~ normal(y, sd = 1)\n}\n");
  CHECK(shown.find("error[E6305]") != std::string::npos);
  CHECK(errors_in(shown) == 1);
}

TEST_CASE("a simulation takes values of per-experiment parameters, or their value in the model") {
  auto const task = [](std::string const& values) {
    return std::get<SimulateTask>(checked(fleet_model + "s = simulate m with values(" + values +
                                          "), input x = gaussian(sd = 1), noise = model, samples = 9, step = 1\n")
                                      .tasks.at(0)
                                      .what)
        .values;
  };
  CHECK(task("dose = 1, k = 2, c = 3")[1].value() == near(2));
  CHECK(task("dose = 1, k = 2, c = 3, mass = 5")[1].value() == near(5));
}

TEST_CASE("an input that only observations read needs no rule between its samples, one that moves a state does") {
  auto const said = [](std::string const& equation, std::string const& noise) {
    return messages("model m {\ninput s\nstate y\ninitial y = 1\nparameter k [1/s] ~ log_uniform(0.1, 10)\n" + equation +
                    "\nobserve a ~ normal(y, sd = " + noise +
                    ")\n}\ndata d { file \"d.csv\"; time t [s]; input s = s; measure a = y }\n"
                    "f = fit m to d with map\n");
  };
  CHECK(said("y' = -k*y", "s") == "");
  CHECK(said("y' = -k*y + 1 [1/s]*s", "0.1").find("E4105") != std::string::npos);
}
