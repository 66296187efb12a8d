// Data blocks, and whether they serve a model.
#include "checking.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

std::string const model =
    "model m {\ninput x [N]\nstate y [m]\ninitial y = 0\nparameter k [N/m] ~ normal(1, sd = 1)\n1 [N s/m]*y' = x - k*y\n"
    "observe displacement ~ normal(y, sd = 1)\nobserve force ~ normal(k*y, sd = 1)\n}\n";

std::string const whole =
    "data d {\nfile \"d.csv\"\ntime t [ms]\ninput x = \"the force\" [kN] hold cubic\nmeasure displacement = y [mm]\n"
    "split train = rows 1..10, test = rows 11..20\n}\n";

std::string block(std::string const& statements) { return "data d {\nfile \"d.csv\"\n" + statements + "\n}\n"; }
std::string fitted(std::string const& statements) { return messages(model + block(statements) + "fit m to d with mh\n"); }

}  // namespace

TEST_CASE("a data block is what it says") {
  DataBlock const data = checked(whole).data.at(0);
  CHECK(data.name == "d");
  CHECK(data.path == "d.csv");
  REQUIRE(data.time.has_value());
  CHECK(data.time->unit->scale == near(1e-3));
  REQUIRE(data.inputs.size() == 1);
  CHECK(data.inputs[0].column == "the force");
  CHECK(data.inputs[0].rule == InputRule::cubic);
  CHECK(data.inputs[0].unit->scale == near(1e3));
  CHECK(data.measured.at(0).channel == "displacement");
  REQUIRE(data.parts.size() == 2);
  CHECK(data.parts[1].first == 11);
  CHECK(data.parts[1].last == 20);
}

TEST_CASE("a rate or a step stands for a time column, in any unit") {
  for (char const* statement : {"rate 2 [kHz]", "rate 2000", "step 0.5 [ms]", "step 0.0005"}) {
    CAPTURE(statement);
    CHECK(checked(block(statement)).data.at(0).step == near(5e-4));
  }
}

TEST_CASE("every mistake in a block is reported at once") {
  std::string const shown = messages(
      "data d {\nrate -1 [Hz]\ninput x = f\ninput x = g hold linear\ninput u = h hold zoh\nmeasure y = y [mmm]\n"
      "split train = rows 10..5, train = rows 1..2\n}\n");
  for (char const* code : {"E4101", "E4107", "E4104", "E4106", "E2011", "E4108"})
    CHECK_MESSAGE(shown.find(code) != std::string::npos, code);
  CHECK(errors_in(shown) == 7);  // the rule that is missing is asked for where the block meets a model
}

TEST_CASE("inputs must all be bound, channels in part") {
  CHECK(fitted("time t\ninput x = x hold linear\nmeasure displacement = y").empty());
  CHECK(fitted("time t\ninput x = x hold linear\nmeasure displacement = y\nmeasure force = f").empty());
  std::string const shown = fitted("time t\nmeasure displacement = y");
  CHECK(errors_in(shown) == 1);
  CHECK(shown.find("error[E4109]: data block `d` does not provide input `x` of model `m`") != std::string::npos);
}

TEST_CASE("a block may serve several models: channels and inputs of another are no mistake") {
  std::string const shared =
      "time t\ninput x = x hold linear\ninput u = u hold linear\nmeasure displacement = y\nmeasure strain = s";
  CHECK(messages(model + "model n {\ninput u\nparameter k ~ normal(1, sd = 1)\nobserve strain ~ normal(k*u, sd = 1)\n}\n" +
                 block(shared) + "fit m to d with mh\n")
            .empty());
  // Of no model: a misspelt channel would else be left out of the likelihood without a word.
  CHECK(fitted(shared).find("error[E4111]: model `m` has no channel `strain`") != std::string::npos);
  std::string const shown = fitted("time t\ninput x = x hold linear\nmeasure displacment = y");
  CHECK(errors_in(shown) == 1);
  CHECK(shown.find("error[E4111]: model `m` has no channel `displacment`") != std::string::npos);
  CHECK(shown.find("did you mean `displacement`?") != std::string::npos);
}

TEST_CASE("an input that no model has is refused where it stands, and the input it may stand for is not missed") {
  std::string const shown = fitted("time t\ninput X = x hold linear\nmeasure displacement = y");
  CHECK(errors_in(shown) == 1);
  CHECK(shown.find("error[E4115]: model `m` has no input `X`") != std::string::npos);
  CHECK(shown.find("did you mean `x`?") != std::string::npos);
  CHECK(errors_in(fitted("time t\ninput x = x hold linear\ninput u = u hold linear\nmeasure displacement = y")) == 1);
  // A model that fails its own check may have it: nothing is said before that one is mended.
  std::string const beside =
      messages(model + "model n {\ninput u\nparameter k ~ normal(1, sd = 1)\nobserve strain ~ normal(k*v, sd = 1)\n}\n" +
               block("time t\ninput x = x hold linear\ninput u = u hold linear\nmeasure displacement = y\nmeasure strain = s") +
               "fit m to d with mh\n");
  CHECK(errors_in(beside) == 1);
  CHECK(beside.find("`v` is not declared") != std::string::npos);
}

TEST_CASE("an input of a model without inputs is declared there, in the unit of its column") {
  std::string const still = "model n {\nparameter k [N] ~ normal(1, sd = 1)\nobserve displacement [N] ~ normal(k, sd = 1)\n}\n";
  std::string const shown =
      messages(still + block("time t\ninput x = x [N] hold linear\nmeasure displacement = y") + "fit n to d with mh\n");
  CHECK(errors_in(shown) == 1);
  CHECK(shown.find("help: declare it in the model, `input x [N]`, and use it in an equation") != std::string::npos);
}

TEST_CASE("what nothing reads is warned of, once the file has no errors") {
  auto const unread = [](std::string const& statements) {
    std::string const shown = messages(
        "model m {\nstate y [m]\ninitial y = 0\nparameter k [1/s] ~ normal(1, sd = 1)\ny' = -k*y\n"
        "observe d ~ normal(y, sd = 1)\n" +
        statements + "\n}\n");
    std::size_t count = 0;
    for (std::size_t at = shown.find("warning[E3019]"); at != std::string::npos; at = shown.find("warning[E3019]", at + 1)) ++count;
    return count;
  };
  CHECK(unread("") == 0);
  CHECK(unread("parameter a ~ normal(0, sd = 1)") == 1);
  CHECK(unread("parameter a = 1") == 1);
  CHECK(unread("input x") == 1);
  CHECK(unread("parameter a ~ normal(0, sd = 1)\nparameter b ~ normal(a, sd = 1)") ==
        2);  // a prior that nothing reads reads nothing
  CHECK(unread("parameter a ~ normal(0, sd = 1)\nparameter b ~ normal(a, sd = 1)\nderive e = b") == 0);
  CHECK(unread("parameter a ~ normal(0, sd = 1)\nlet e = a") == 1);
  CHECK(unread("parameter a(3) ~ normal(0, sd = 1)\nderive e = a[2]") == 1);  // of its elements the first is named
  CHECK(unread("parameter a ~ normal(0, sd = 1)\nderive e = f") == 0);        // an error says enough
}

TEST_CASE("a coefficient whose term an argument of 0 takes out is read where the term stands") {
  auto const warned = [](std::string const& members) {
    return messages(
               "model m(cubic) {\nstate y [m]\ninitial y = 0\nparameter k [1/s] ~ normal(1, sd = 1)\n"
               "parameter k3 [m^-2/s] ~ normal(1, sd = 1)\ny' = -k*y - cubic*k3*y^3\nobserve d ~ normal(y, sd = 1)\n}\n"
               "candidates laws { " +
               members + " }\n")
               .find("warning[E3019]") != std::string::npos;
  };
  CHECK_FALSE(warned("m(cubic = 0..1)"));
  CHECK_FALSE(warned("m(cubic = 1)"));
  CHECK(warned("m(cubic = 0)"));
}

TEST_CASE("a column in a unit of another kind is refused, with both units") {
  std::string const shown = fitted("time t\ninput x = x [m] hold linear\nmeasure displacement = y [s]");
  CHECK(errors_in(shown) == 2);
  CHECK(shown.find("column `x` is in [m], but [N] is needed") != std::string::npos);
  CHECK(shown.find("column `y` is in [s], but [m] is needed") != std::string::npos);
}

TEST_CASE("cycles are not taken for radians, nor metres for a time") {
  std::string const rotor =
      "model m {\ninput w [rad/s]\nparameter k ~ normal(1, sd = 1)\nobserve displacement ~ normal(k*w, sd = 1)\n}\n";
  std::string const shown =
      messages(rotor + block("time t\ninput w = f [Hz] hold linear\nmeasure displacement = y") + "fit m to d with mh\n");
  CHECK(errors_in(shown) == 1);
  CHECK(shown.find("error[E4017]: column `f` is in [Hz], but [rad/s] is needed: one counts cycles, the other radians") !=
        std::string::npos);
  CHECK(messages(block("time t [m]")).find("error[E4114]: time cannot be in [m]") != std::string::npos);
  CHECK(messages(block("rate 9 [s]")).find("error[E2014]: the sampling rate is in [Hz], but this is in [s]") != std::string::npos);
}

TEST_CASE("a column of angles says so, and one that says how it counts is converted") {
  std::string const beam = "model m {\nparameter k [mrad] ~ normal(1, sd = 1)\nobserve tilt [mrad] ~ normal(k, sd = 1)\n}\n";
  auto const said = [&](std::string const& unit) {
    return messages(beam + block("time t\nmeasure tilt = y [" + unit + "]") + "fit m to d with mh\n");
  };
  CHECK(errors_in(said("mm/m")) == 0);
  CHECK(errors_in(said("mrad")) == 0);
  CHECK(errors_in(said("-")) == 1);
}

TEST_CASE("a quotient is read as a number with the unit behind it only where that unit fits") {
  CHECK(messages(block("step 1/50 [s]")).find("`0.02 [s]`") != std::string::npos);
  std::string const other = messages(block("step 1/50 [m]"));
  CHECK(errors_in(other) == 1);
  CHECK(other.find("0.02") == std::string::npos);
}

TEST_CASE("the derivative of an input is refused where the data hold it, wherever it stands") {
  for (char const* use :
       {"y' = x'", "let slope = x'\ny' = slope", "y' = x\nobserve second ~ normal(x', sd = 1)", "y' = x\nderive slope = x'"}) {
    CAPTURE(use);
    std::string const of_rate = std::string(
                                    "model m {\ninput x\nstate y\ninitial y = 0\nparameter k ~ normal(1, sd = 1)\n"
                                    "observe displacement ~ normal(k*y, sd = 1)\n") +
                                use + "\n}\n";
    std::string const held =
        of_rate + block("time t\ninput x = x hold zero_order\nmeasure displacement = y") + "fit m to d with mh\n";
    CHECK(errors_in(messages(held)) == 1);
    CHECK(messages(held).find("error[E4112]: `x'` does not exist: input `x` is held constant between its samples") !=
          std::string::npos);
    CHECK(messages(of_rate + block("time t\ninput x = x hold linear\nmeasure displacement = y") + "fit m to d with mh\n").empty());
  }
}

TEST_CASE("noise that differs from sample to sample comes as an input") {
  CheckedFile const file = checked(
      "model m {\ninput doubt [mm]\nparameter level [m] ~ normal(0, sd = 1)\nobserve position ~ normal(level, sd = 2*doubt)\n}\n"
      "data d {\nfile \"d.csv\"\ntime t\ninput doubt = sd_y [mm] hold zero_order\nmeasure position = y [mm]\n}\nfit m to d with "
      "mh\n");
  Model const& model = file.models.at(0);
  CHECK(at(model, model.channels[0].noise.arguments[1], {{"doubt", 3e-3}}) == near(6e-3));
}

TEST_CASE("a prediction binds the model of its fit to other data") {
  std::string const shown = messages(model + whole + "data e {\nfile \"e.csv\"\ntime t\nmeasure displacement = y\n}\n" +
                                     "f = fit m to d.train with mh\np = predict f on e\n");
  CHECK(errors_in(shown) == 1);
  CHECK(shown.find("data block `e` does not provide input `x`") != std::string::npos);
}
