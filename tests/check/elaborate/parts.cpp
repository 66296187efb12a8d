// Models with arguments and models as parts of others.
#include "check/checking.hpp"
#include "syntax/unparse.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

std::string const law =
    "model bouc_wen(n = 1) {\ninput displacement [m]\nstate z [N]\ninitial z = 0\nparameter A [N/m] ~ log_uniform(1, 1e6)\n"
    "parameter alpha [N^(1-n)/m] ~ normal(0, sd = 10)\nparameter beta [N^(1-n)/m] ~ normal(0, sd = 10)\n"
    "z' = A*displacement' - alpha*abs(displacement')*abs(z)^(n-1)*z - beta*displacement'*abs(z)^n\nderive force [N] = z\n"
    "parameter noise [N] ~ log_uniform(1e-3, 1)\nobserve load ~ normal(z, sd = noise)\n}\n";

std::string rig(std::string const& part, std::string const& more = "") {
  return law + "model rig {\ninput x [N]\nstate y [m]\ninitial y = 0, y' = 0\n" + part + "\n1 [kg]*y'' + joint.force = x\n" + more +
         "\nobserve position ~ normal(y, sd = 1e-4)\n}\n";
}

std::vector<std::string> parameter_names(Model const& model) {
  std::vector<std::string> names;
  for (Parameter const& each : model.parameters) names.push_back(each.name);
  return names;
}
Model const& named(CheckedFile const& file, std::string const& name) {
  for (Model const& model : file.models)
    if (model.name == name) return model;
  FAIL("no model " << name);
  return file.models.front();
}

}  // namespace

TEST_CASE("a part brings its states and free parameters under its name") {
  CheckedFile const file = checked(rig("part joint = bouc_wen(n = 3, displacement = y)"));
  Model const& model = named(file, "rig");
  CHECK(parameter_names(model) == std::vector<std::string>{"joint.A", "joint.alpha", "joint.beta"});
  REQUIRE(model.states.size() == 3);
  CHECK(model.states[2].name == "joint.z");
  CHECK(model.parameters[1].unit_text() == "N^-2/m");
  // Worden et al., Eq. (8.23) with n = 3, by hand
  Values const values = {{"y", 1},        {"y'", -0.7},         {"joint.z", 1.3},    {"x", 5},
                         {"joint.A", 11}, {"joint.alpha", 0.4}, {"joint.beta", -0.9}};
  CHECK(rate_of(model, "joint.z", values) == near(11 * -0.7 - 0.4 * 0.7 * 1.3 * 1.3 * 1.3 + 0.9 * -0.7 * 1.3 * 1.3 * 1.3));
  CHECK(rate_of(model, "y'", values) == near(5 - 1.3));
}

TEST_CASE("the noise of a part is left out, with the parameters that only it reads") {
  CheckedFile const file = checked(rig("part joint = bouc_wen(displacement = y)"));
  Model const& model = named(file, "rig");
  CHECK(model.channels.size() == 1);
  for (std::string const& name : parameter_names(model)) CHECK(name != "joint.noise");
}

TEST_CASE("what only the noise of a part reads is left out over definitions and priors, what anything else reads is not") {
  std::string const inner =
      "model inner {\ninput d [m]\nparameter k [N/m] ~ log_uniform(1, 100)\nparameter tau [N] ~ half_normal(1)\n"
      "parameter s(2) [N] ~ half_normal(tau)\nparameter floor [N] ~ half_normal(1)\nlet wide = 2*s\nlet width = wide[1] + floor\n"
      "derive f [N] = k*d\nobserve force ~ normal(f, sd = width)\n}\n";
  auto const names = [&](std::string const& more) {
    return parameter_names(named(checked(inner + "model whole {\ninput x [N]\nstate y [m]\ninitial y = 0, y' = 0\n" + more +
                                         "1 [kg]*y'' + j.f = x\nobserve position ~ normal(y, sd = 1e-4)\n}\n"),
                                 "whole"));
  };
  using Names = std::vector<std::string>;
  CHECK(names("part j = inner(d = y)\n") == Names{"j.k"});
  CHECK(names("part j = inner(d = y)\nderive e [N] = j.floor\n") == Names{"j.k", "j.floor"});
  CHECK(names("part j = inner(d = y)\nderive e [N] = j.s[2]\n") == Names{"j.k", "j.tau", "j.s[2]"});
  CHECK(names("part j = inner(d = y)\nlet w = j.width\nderive e [N] = w\n") == Names{"j.k", "j.tau", "j.s[1]", "j.floor"});
  // What the whole declares itself stays, and is warned of.
  CHECK(names("parameter mine [N] ~ half_normal(1)\npart j = inner(d = y, floor = mine)\n") == Names{"mine", "j.k"});
}

TEST_CASE("parameters of a part are shared, fixed or made of others") {
  CheckedFile const file =
      checked(rig("parameter k [N/mm] ~ log_uniform(1, 100)\npart joint = bouc_wen(displacement = y, A = 2*k, alpha = 0)"));
  Model const& model = named(file, "rig");
  CHECK(parameter_names(model) == std::vector<std::string>{"k", "joint.beta"});
  Values const values = {{"y", 0}, {"y'", 1}, {"joint.z", 0}, {"x", 0}, {"k", 3000}, {"joint.beta", 0}};
  CHECK(rate_of(model, "joint.z", values) == near(6000));
}

TEST_CASE("an input of a part is an expression, and its rate that expression's") {
  std::string const text = law +
                           "model rig {\ninput x [N]\nstate q(2) [m]\ninitial q = 0, q' = 0\nlet gap = 2*(q[2] - q[1])^2/1 [m]\n"
                           "part joint = bouc_wen(displacement = gap, A = 1, alpha = 0, beta = 0)\n"
                           "1 [kg]*q'' + (joint.force, x) = 0\nobserve position ~ normal(q[1], sd = 1e-4)\n}\n";
  CheckedFile const file = checked(text);
  Values const values = {{"q[1]", 1}, {"q[2]", 4}, {"q[1]'", 0.5}, {"q[2]'", 0.2}, {"joint.z", 0}, {"x", 0}};
  CHECK(rate_of(named(file, "rig"), "joint.z", values) == near(2 * 2 * (4 - 1) * (0.2 - 0.5)));
}

TEST_CASE("the whole may state the initial value of a part's state") {
  CheckedFile const file = checked(rig("part joint = bouc_wen(displacement = y)", "initial joint.z = 7"));
  CHECK(initial_of(named(file, "rig"), "joint.z") == 7);
}

TEST_CASE("parts in parts, with vectors and whole numbers handed down") {
  std::string const text =
      "model spring(n) {\ninput d\nparameter k(n) ~ log_uniform(1, 2)\nlet f = k[n]*d\n}\n"
      "model pair(n) {\ninput d\nparameter a ~ log_uniform(1, 2)\npart first = spring(n = n, d = d)\npart second = spring(n = n + "
      "1, d = a*d)\n"
      "let f = first.f + second.f\n}\n"
      "model whole {\nstate y\ninitial y = 0\npart both = pair(n = 2, d = y)\ny' = -both.f\nobserve o ~ normal(y, sd = 1)\n}\n";
  CheckedFile const file = checked(text);
  Model const& model = named(file, "whole");
  CHECK(parameter_names(model) == std::vector<std::string>{"both.a", "both.first.k[1]", "both.first.k[2]", "both.second.k[1]",
                                                           "both.second.k[2]", "both.second.k[3]"});
  Values const values = {{"y", 2}, {"both.a", 3}, {"both.first.k[2]", 5}, {"both.second.k[3]", 7}};
  CHECK(rate_of(model, "y", values) == near(-(5 * 2 + 7 * 3 * 2)));
}

TEST_CASE("a task uses a model with arguments, and its name says which") {
  std::string const tasks =
      "data bench { file \"b.csv\"; rate 1000 [Hz]; input displacement = y hold linear; measure load = f }\n"
      "second = fit bouc_wen(n = 2) to bench with map\nfit bouc_wen to bench with map\n"
      "made = simulate bouc_wen(n = 2) with values(A = 1, alpha = 1, beta = 1, noise = 1), input displacement = sine(amplitude = "
      "1, frequency = 1), "
      "samples = 10, rate = 10 [Hz], seed = 1\n";
  CheckedFile const file = checked(law + tasks);
  REQUIRE(file.models.size() == 2);
  CHECK(file.models[0].name == "bouc_wen(n = 2)");
  CHECK(file.models[1].name == "bouc_wen(n = 1)");
  CHECK(file.tasks[1].name == "fit_bouc_wen_n1");
  CHECK(std::get<FitTask>(file.tasks[0].what).model == std::get<SimulateTask>(file.tasks[2].what).model);
}

TEST_CASE("values and inputs of a task are given for a whole vector") {
  CheckedFile const file = checked(
      "model m {\ninput u(2)\nstate q(2)\ninitial q = 0\nparameter k(2) ~ log_uniform(1, 10)\nq' = -diagonal(k)*q + u\n"
      "observe y(2) ~ normal(q, sd = 1)\n}\n"
      "made = simulate m with values(k = (3, 4)), input u = gaussian(sd = 1), samples = 10, rate = 1 [Hz], seed = 1\n"
      "other = simulate m with values(k[1] = 3, k[ 2 ] = 5), input u[1] = gaussian(sd = 1), input u[2] = constant(value = 0), "
      "samples = 10, rate = 1 [Hz], seed = 1\n");
  auto const& made = std::get<SimulateTask>(file.tasks[0].what);
  CHECK(made.values == std::vector<std::optional<double>>{3, 4});
  CHECK(std::get<SimulateTask>(file.tasks[1].what).values[1] == 5);
}

TEST_CASE("a mistake in a part is said once, where it stands, and not for the whole again") {
  std::string text = rig("part joint = bouc_wen(n = 2, displacement = y)");
  text.replace(text.find("A*displacement'"), 1, "B");
  std::string const said = messages(text);
  CHECK(errors_in(said) == 1);
  CHECK(said.find("test.sysid:8:6: error[E2001]") != std::string::npos);
}

TEST_CASE("a model with arguments that nothing uses is checked with 1, 2 and 3") {
  std::string const said = messages("model m(n) {\nstate q(n)\ninitial q = 0\nq' = -q[3]*q\n}\n");
  CHECK(errors_in(said) == 1);
  CHECK(said.find("`q` is a vector of 1") != std::string::npos);
  CHECK(messages("model m(n) {\nstate q(n)\ninitial q = 0\nq' = -q[n]*q\n}\n").empty());
}

TEST_CASE("a path that leads nowhere is met with a guess") {
  std::string text = rig("part joint = bouc_wen(displacement = y)");
  text.replace(text.find("joint.force"), 11, "joint.forse");
  CHECK(messages(text).find("did you mean `joint.force`") != std::string::npos);
}

TEST_CASE("the number of parts is bounded") {
  std::string text = "model m0 {\ninput u\nlet v = u\n}\n";
  for (int i = 1; i < 30; ++i) {
    std::string const inner = "m" + std::to_string(i - 1);
    text += "model m" + std::to_string(i) + " {\ninput u\npart a = " + inner + "(u = u)\npart b = " + inner +
            "(u = u)\nlet v = a.v + b.v\n}\n";
  }
  CHECK(messages(text).find("error[E2709]") != std::string::npos);
}
