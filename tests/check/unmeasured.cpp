// What was not measured: disturbances, random initial values, errors of inputs, as leaves, states and numbers of the model.
#include "checking.hpp"

#include "model/input_errors.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

std::string const disturbed_oscillator =
    "input x [N]\nstate y [mm]\ninitial y = 0, y' = 0\nparameter k [N/m] ~ log_uniform(1e3, 1e5)\n"
    "1 [kg]*y'' + 20 [N s/m]*y' + k*y = x + w\nobserve displacement ~ normal(y, sd = 1e-4)\n";

std::string const noisy_data =
    "data bench {\nfile \"bench.csv\"\ntime t\ninput x = force [kN] hold linear error normal(sd = 0.5)\n"
    "measure displacement = y\n}\n"
    "data exact {\nfile \"bench.csv\"\ntime t\ninput x = force [kN] hold linear\nmeasure displacement = y\n}\n";

State const& component_of(Model const& model, std::string const& name) {
  for (State const& each : model.states)
    if (each.name == name) return each;
  FAIL("no state " << name);
  return model.states.front();
}

/// A file with the oscillator, disturbed or not, and tasks.
std::string with_tasks(std::string const& disturbance, std::string const& tasks) {
  std::string text = disturbed_oscillator;
  if (disturbance.empty()) text.replace(text.find(" + w"), 4, "");
  return "model m {\n" + disturbance + text + "}\n" + noisy_data + tasks + "\n";
}
FitTask fit_of(std::string const& disturbance, std::string const& task) {
  return std::get<FitTask>(checked(with_tasks(disturbance, task)).tasks.at(0).what);
}

}  // namespace

TEST_CASE("white noise is a leaf of the equations, its intensity is in units of SI") {
  Model const model = model_of("disturbance w [kN] ~ white(intensity = 4)\n" + disturbed_oscillator);
  REQUIRE(model.disturbances.size() == 1);
  Disturbance const& w = model.disturbances[0];
  CHECK(w.name == "w");
  CHECK(w.state == -1);
  CHECK_FALSE(w.held);
  CHECK(at(model, w.intensity, {}) == near(4e6));
  CHECK(model.states.size() == 2);
  CHECK(rate_of(model, "y'", {{"x", 0}, {"k", 1e3}, {"y", 0}, {"y'", 0}, {"noise(w)", 3}}) == near(3));
  CHECK(model.filtered());
  Model const estimated =
      model_of("parameter q [mN^2 s] ~ log_uniform(1, 10)\ndisturbance w [N] ~ white(intensity = q)\n" + disturbed_oscillator);
  CHECK(at(estimated, estimated.disturbances[0].intensity, {{"q", 5e-6}}) == near(5e-6));
}

TEST_CASE("a disturbance without a unit takes it from its law") {
  Model const white =
      model_of("parameter q [N^2 s] ~ log_uniform(1, 10)\ndisturbance w ~ white(intensity = q)\n" + disturbed_oscillator);
  CHECK(white.disturbances[0].unit.value().dimension == white.inputs[0].unit.value().dimension);
  CHECK(messages("model m {\ndisturbance w ~ ornstein_uhlenbeck(sd = 2 [V], time = 1 [s])\n" + disturbed_oscillator + "}\n")
            .find("[V]") != std::string::npos);
}

TEST_CASE("a disturbance with a memory is a stationary state of its standard deviation") {
  Model const model = model_of("disturbance w [N] ~ ornstein_uhlenbeck(sd = 2, time = 100 [ms])\n" + disturbed_oscillator);
  Disturbance const& w = model.disturbances.at(0);
  REQUIRE(w.state >= 0);
  State const& state = model.states[static_cast<std::size_t>(w.state)];
  CHECK(state.name == "w");
  CHECK(at(model, w.intensity, {}) == near(2 * 4 / 0.1));
  CHECK(at(model, state.initial, {}) == 0);
  CHECK(at(model, state.initial_variance.value(), {}) == near(4));
  CHECK(rate_of(model, "w", {{"w", 0.5}, {"noise(w)", 3}}) == near(3 - 5));
  CHECK(rate_of(model, "y'", {{"x", 0}, {"k", 1e3}, {"y", 0}, {"y'", 0}, {"w", 7}}) == near(7));
}

TEST_CASE("disturbances are vectors, and parts bring theirs") {
  Model const vector = model_of(
      "state q(3) [m]\ninitial q = 0\nparameter s(3) [m/s] ~ half_normal(sd = 1)\n"
      "disturbance w(3) [m/s] ~ ornstein_uhlenbeck(sd = s, time = (1, 2, 3))\nq' = w\nobserve d ~ normal(q[1], sd = 1 [mm])\n");
  REQUIRE(vector.disturbances.size() == 3);
  CHECK(vector.disturbances[2].name == "w[3]");
  CHECK(at(vector, vector.disturbances[2].intensity, {{"s[3]", 3}}) == near(6));
  Model const whole = checked(
                          "model shaken {\ninput x [N]\nstate v [m/s]\ninitial v = 0\nparameter q [N^2 s] ~ log_uniform(1, 10)\n"
                          "disturbance w [N] ~ white(intensity = q)\n1 [kg]*v' = x + w\n}\n"
                          "model m {\ninput x [N]\npart front = shaken(x = x)\npart back = shaken(x = -x, q = 2 [N^2 s])\n"
                          "observe speed [m/s] ~ normal(front.v + back.v, sd = 1)\n}\n")
                          .models.at(1);
  REQUIRE(whole.disturbances.size() == 2);
  CHECK(whole.disturbances[0].name == "front.w");
  CHECK(at(whole, whole.disturbances[0].intensity, {{"front.q", 5}}) == near(5));
  CHECK(at(whole, whole.disturbances[1].intensity, {}) == near(2));
}

TEST_CASE("in discrete time a disturbance is a state of one sample, lags of it are states, too") {
  Model const model = model_of(
      "time discrete 0.1 [s]\ninput u\nstate y\ninitial y = 0\nparameter a ~ uniform(-1, 1)\nparameter b ~ uniform(-1, "
      "1)\nparameter c ~ uniform(-1, 1)\n"
      "disturbance w [mV] ~ normal(0, variance = 9)\n"
      "y = a*lag(y, 1) + b*u + w/1 [mV] + c*lag(w, 1)/1 [mV]\nobserve output ~ normal(y, sd = 0.1)\n");
  REQUIRE(model.disturbances.size() == 1);
  Disturbance const& w = model.disturbances[0];
  CHECK(at(model, w.intensity, {}) == near(9e-6));
  CHECK(component_of(model, "w").initial_variance.has_value());
  CHECK(rate_of(model, "w", {{"noise(w)", 3}}) == near(3));
  State const& past = component_of(model, "lag(w, 1)");
  CHECK(at(model, past.derivative, {{"w", 3}}) == near(3));
  CHECK(at(model, past.initial_variance.value(), {}) == near(9e-6));
  NodeId const predicted = model.channels[0].noise.arguments[0];
  CHECK(at(model, predicted, {{"a", 0.5}, {"b", 2}, {"c", 0.25}, {"lag(y, 1)", 3}, {"u", 1}, {"w", 1e-3}, {"lag(w, 1)", 2e-3}}) ==
        near(0.5 * 3 + 2 + 1 + 0.5));
}

TEST_CASE("a random initial value has a mean and a variance") {
  std::string text = disturbed_oscillator;
  text.replace(text.find("y = 0, y' = 0"), 13, "y ~ normal(3, sd = 2), y' = 0");
  text.replace(text.find(" + w"), 4, "");
  Model const model = model_of(text);
  CHECK(initial_of(model, "y") == near(3e-3));
  CHECK(at(model, component_of(model, "y").initial_variance.value(), {}) == near(4e-6));
  CHECK_FALSE(component_of(model, "y'").initial_variance);
  CHECK(model.disturbances.empty());
  CHECK(model.filtered());
}

TEST_CASE("the noise of a disturbance may be multiplied by anything but white noise") {
  std::string text = disturbed_oscillator;
  text.replace(text.find(" + w"), 4, " + abs(y')/1 [m/s]*w + k*y*w/1 [N]");
  CHECK(messages("model m {\ndisturbance w [N] ~ white(intensity = 4)\n" + text + "}\n").empty());
  // A memory frees a disturbance of what holds for white noise.
  text.replace(text.find("+ abs"), std::string::npos,
               "+ w^2/1 [N]\nobserve load [N] ~ normal(w, sd = 1)\nderive most [N] = max(0, w)\n");
  CHECK(messages("model m {\ndisturbance w [N] ~ ornstein_uhlenbeck(sd = 1, time = 1)\n" + text + "}\n").empty());
}

TEST_CASE("the error of an input is a disturbance of the model that is fitted") {
  FitTask const task = fit_of("", "f = fit m to bench with mh");
  REQUIRE(task.input_errors.size() == 1);
  CHECK(task.input_errors[0] == near(500));
  CHECK(fit_of("", "f = fit m to exact with mh").input_errors.empty());
  Model const model = checked(with_tasks("", "f = fit m to bench with mh")).models.at(0);
  CHECK_FALSE(model.filtered());
  auto const fitted = with_input_errors(model, task.input_errors);
  REQUIRE(std::holds_alternative<Model>(fitted));
  Model const& whole = std::get<Model>(fitted);
  REQUIRE(whole.disturbances.size() == 1);
  CHECK(whole.disturbances[0].held);
  CHECK(at(whole, whole.disturbances[0].intensity, {}) == near(500.0 * 500));
  CHECK(rate_of(whole, "y'", {{"x", 2}, {"k", 1e3}, {"y", 0}, {"y'", 0}, {"noise(error of x)", 3}}) == near(5));
}

TEST_CASE("a fit says how its likelihood is computed") {
  std::string const white = "disturbance w [N] ~ white(intensity = 4)\n";
  CHECK(fit_of(white, "f = fit m to exact with mh").filter == FilterRule::automatic);
  CHECK(fit_of(white, "f = fit m to exact with mh, filter = unscented").filter == FilterRule::unscented);
  CHECK(fit_of(white, "f = fit m to exact with mh, filter = kalman").filter == FilterRule::kalman);
  CHECK(messages(with_tasks(white, "f = fit m to exact with mh, filter = ekf")).find("E6006") != std::string::npos);
}

TEST_CASE("particles are for back ends that sample with estimates, and chosen for noise that is not normal") {
  std::string const white = "disturbance w [N] ~ white(intensity = 4)\n";
  auto const of_heavy_tails = [&](std::string const& task) {
    std::string text = with_tasks(white, task);
    std::string const normal = "normal(y, sd = 1e-4)";
    auto const at = text.find(normal);
    REQUIRE(at != std::string::npos);
    return text.replace(at, normal.size(), "student_t(y, 4, scale = 1e-4)");
  };
  auto const refused = [&](std::string const& text, std::string const& code) {
    return messages(text).find(code) != std::string::npos;
  };
  FitTask const stated = fit_of(white, "f = fit m to exact with mh, filter = particle, particles = 200");
  CHECK(stated.filter == FilterRule::particle);
  CHECK(stated.particles == 200);
  CHECK(stated.particles_because.empty());
  CHECK(fit_of(white, "f = fit m to exact with mh, filter = particle, particles = automatic").particles == 0);
  CHECK(fit_of(white, "f = fit m to exact with auto, filter = particle").filter == FilterRule::particle);
  for (std::string const backend : {"nuts", "tempering", "map", "ml"})
    CHECK(refused(with_tasks(white, "f = fit m to exact with " + backend + ", filter = particle"), "E3319"));
  CHECK(refused(with_tasks(white, "f = fit m to exact with mh, filter = particle, start = estimated(rows = 5)"), "E3319"));
  CHECK(refused(with_tasks(white, "f = fit m to exact with mh, particles = 100"), "E3321"));
  CHECK(refused(with_tasks(white, "f = fit m to exact with mh, filter = particle, particles = 3"), "E6005"));
  CheckedFile const chosen = checked(of_heavy_tails("f = fit m to exact with mh"));
  auto const& fit = std::get<FitTask>(chosen.tasks.back().what);
  CHECK(fit.filter == FilterRule::particle);
  CHECK(fit.particles_because == "no other filter supports the noise of `displacement`, which is `student_t`");
  for (std::string const backend : {"nuts", "map", "mh, filter = unscented", "mh, start = estimated(rows = 5)"})
    CHECK(refused(of_heavy_tails("f = fit m to exact with " + backend), "E3314"));
}

TEST_CASE("a prediction has the errors of its own data, and samples correct its states by a rule") {
  std::string const fitted = "f = fit m to exact with mh\n";
  auto const prediction = [&](std::string const& task) {
    return std::get<PredictTask>(checked(with_tasks("", fitted + task)).tasks.at(1).what);
  };
  CHECK(prediction("p = predict f on exact").input_errors.empty());
  PredictTask const noisy = prediction("p = predict f on bench with prediction = one_step");
  REQUIRE(noisy.input_errors.size() == 1);
  CHECK(noisy.input_errors[0] == near(500));
  CHECK(noisy.prediction == PredictionRule::one_step);
  CHECK(messages(with_tasks("", fitted + "p = predict f on exact with prediction = one_step")).find("E6016") != std::string::npos);
  std::string const white = "disturbance w [N] ~ white(intensity = 4)\n";
  for (char const* rule : {"one_step", "free_run", "as_written"})
    CHECK(messages(with_tasks(white, fitted + "p = predict f on exact with prediction = " + rule)).empty());
  // Beside a model that samples correct, one runs freely that they do not.
  std::string mixed = with_tasks(white, "");
  std::string quiet = with_tasks("", "");
  quiet = quiet.substr(0, quiet.find(noisy_data));
  quiet.replace(quiet.find("model m"), 7, "model n");
  mixed += quiet + "f = fit m to exact with mh\ng = fit n to exact with mh\np = predict f, g on exact with prediction = one_step\n";
  CHECK(messages(mixed).empty());
  CHECK(messages(with_tasks("", fitted + "p = predict f on bench, exact")).find("E3317") != std::string::npos);
}

TEST_CASE("selection by likelihood and by distance take what is random") {
  std::string const white = "disturbance w [N] ~ white(intensity = 4)\n";
  CHECK(messages(with_tasks(white, "s = select m to exact with reversible_jump(samples = 1000)")).empty());
  CHECK(messages(with_tasks(white, "s = select m to exact with abc_smc")).empty());
  CHECK(messages(with_tasks("", "s = select m to bench with abc_smc")).empty());
  // Each simulation of a distance draws its states; a likelihood has the start that rows determine.
  std::string const estimated = ", start = estimated(rows = 5)";
  CHECK(messages(with_tasks(white, "s = select m to exact with reversible_jump(samples = 1000)" + estimated)).empty());
  CHECK(messages(with_tasks(white, "s = select m to exact with abc_smc" + estimated)).find("E3309") != std::string::npos);
  CHECK(messages(with_tasks("", "s = select m to bench with abc_smc" + estimated)).find("E3309") != std::string::npos);
  CHECK(messages(with_tasks("", "s = select m to exact with abc_smc" + estimated)).empty());
  CHECK(messages(with_tasks("", "s = select m to exact with abc_smc")).empty());
}
