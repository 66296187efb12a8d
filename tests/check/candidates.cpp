// Candidate models: what a set expands to, what its probabilities are, and what a selection works from.
#include "check/expression/non_negative.hpp"
#include "checking.hpp"
#include "relative.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

std::string const models =
    "model linear {\ninput x [N]\nstate y [mm]\ninitial y = 0\nparameter c [N s/m] ~ log_uniform(1, 100)\n"
    "parameter k [N/mm] ~ log_uniform(1, 10)\nc*y' + k*y = x\nobserve displacement ~ normal(y, sd = 1)\n"
    "observe force [kN] ~ normal(k*y, sd = 1)\n}\n"
    "model power_law(n, p = 1) {\ninput x [N]\nstate y [m]\ninitial y = 0\nparameter c [N s/m] ~ log_uniform(1, 100)\n"
    "parameter k [N/m^n] ~ log_uniform(1, 10)\nobserve force ~ normal(k*abs(y)^(n-1)*y, sd = 1)\n"
    "c*y'*p + k*abs(y)^(n-1)*y = x\nobserve displacement ~ normal(y, sd = 1)\n}\n"
    "data d {\nfile \"d.csv\"\ntime t\ninput x = x hold linear\nmeasure displacement = y [mm]\nsplit a = rows 1..10, b = rows "
    "11..20\n}\n"
    "data both {\nfile \"d.csv\"\ntime t\ninput x = x hold linear\nmeasure force = f [N]; measure displacement = y [mm]\n}\n";

CandidateSet set(std::string const& statements) {
  return checked(models + "candidates laws \"which law?\" {\n" + statements + "\n}\n").candidates.at(0);
}
std::vector<std::string> names(CandidateSet const& set) {
  std::vector<std::string> all;
  for (CandidateModel const& each : set.models) all.push_back(each.name);
  return all;
}
std::vector<double> probabilities(CandidateSet const& set) {
  std::vector<double> all;
  for (CandidateModel const& each : set.models) all.push_back(each.probability);
  return all;
}
CheckedFile selection(std::string const& task) {
  return checked(models + "candidates laws { linear; power_law(n = 2..3) }\nselection = " + task + "\n");
}
SelectTask const& select_task(CheckedFile const& file) { return std::get<SelectTask>(file.tasks.at(0).what); }
std::string refused(std::string const& text) { return messages(models + text + "\n"); }

// An expression of a distance where the channel measured `sample` and the state is `y`, SI.
double value(CheckedFile const& file, SelectTask const& task, std::size_t candidate, std::size_t channel, double sample, double y) {
  Model const& model = file.models[static_cast<std::size_t>(task.fits[candidate].model)];
  return model.graph.evaluate(task.distance.expressions.at(candidate).at(channel), [&](NodeId id) {
    LeafKind const kind = model.graph[id].leaf_kind;
    return kind == LeafKind::measured ? sample : kind == LeafKind::state ? y : 2.0;  // a parameter is 2
  });
}

}  // namespace

TEST_CASE("ranges and lists stand for models, their product in order") {
  CandidateSet const laws = set("linear\npower_law(n = (3, 1), p = 1..2)");
  CHECK(laws.name == "laws");
  CHECK(laws.title == "which law?");
  CHECK(names(laws) == std::vector<std::string>{"linear", "power_law(n = 3, p = 1)", "power_law(n = 3, p = 2)",
                                                "power_law(n = 1, p = 1)", "power_law(n = 1, p = 2)"});
  CHECK(laws.models[1].model != laws.models[2].model);
}

TEST_CASE("a model of a module is a candidate") {
  auto const file = checked("use hysteresis\ncandidates laws { bouc_wen(n = 1..2) }\n");
  CHECK(names(file.candidates.at(0)) == std::vector<std::string>{"bouc_wen(n = 1)", "bouc_wen(n = 2)"});
}

TEST_CASE("models without a probability share what the others leave") {
  CHECK(probabilities(set("linear; power_law(n = 1..4)")) == std::vector<double>(5, 0.2));
  CHECK(probabilities(set("linear probability 0.5; power_law(n = 1..2) probability 0.25")) == std::vector<double>{0.5, 0.25, 0.25});
  CHECK(probabilities(set("linear probability 1/2; power_law(n = 1..4)")) == std::vector<double>{0.5, 0.125, 0.125, 0.125, 0.125});
  // Decimals that sum to 1 but for rounding are taken as they are meant.
  auto const thirds = probabilities(set("linear probability 0.3333333333; power_law(n = 1..2) probability 0.33333333335"));
  CHECK(thirds[0] + thirds[1] + thirds[2] == near(1));
  for (std::string const wrong : {"linear probability 0.5; power_law(n = 1..2) probability 0.2",
                                  "linear probability 0.5; power_law(n = 1..2) probability 0.25; power_law(n = 3)",
                                  "linear probability 0.5; power_law(n = 1..3) probability 0.25; power_law(n = 4)"})
    CHECK(refused("candidates laws { " + wrong + " }").find("error[E6502]") != std::string::npos);
  for (std::string const wrong : {"0", "-0.1", "1.5"})
    CHECK(errors_in(refused("candidates laws { linear; power_law(n = 1..2) probability " + wrong + " }")) == 1);
}

TEST_CASE("shared parameters have one unit and one prior") {
  CHECK(set("linear; power_law(n = 1..3); shared c").shared == std::vector<std::string>{"c"});
  CHECK(set("power_law(n = 1); power_law(n = 1, p = 2); shared c, k, c").shared == std::vector<std::string>{"c", "k"});
  CHECK(refused("candidates laws { linear; power_law(n = 1); shared k }").find("error[E6505]") !=
        std::string::npos);  // 1..10 N/mm, N/m
  CHECK(refused("candidates laws { linear; power_law(n = 2); shared k }").find("does not have the same unit") != std::string::npos);
}

TEST_CASE("each candidate of a selection is what a fit of it alone would be") {
  auto const file =
      selection("select laws to d.a, d.b with abc_smc(particles = 500, schedule = (100, 10)), seed = 3, substeps = 4");
  SelectTask const& task = select_task(file);
  CHECK(task.candidates == 0);
  CHECK(task.backend == "abc_smc");
  CHECK(task.settings.integer("particles") == 500);
  CHECK(task.settings.real("quantile") == 0.2);
  CHECK(task.settings.numbers("schedule") == std::vector<double>{100, 10});
  CHECK(task.seed == std::uint64_t{3});
  REQUIRE(task.fits.size() == 3);
  for (std::size_t c = 0; c < 3; ++c) {
    CHECK(task.fits[c].model == file.candidates[0].models[c].model);
    REQUIRE(task.fits[c].experiments.size() == 2);
    CHECK(task.fits[c].experiments[1].name == "d.b");
    CHECK(task.fits[c].solver == SolverSettings{.substeps = 4});
    CHECK_FALSE(task.fits[c].refine_solver);
  }
  CHECK(task.distance.kind == DistanceRule::Kind::nmse);
  CHECK(task.distance.channels == std::vector<std::string>{"displacement"});
  CHECK(task.distance.weights == std::vector<double>{1});
  CHECK(task.distance.text == "nmse");
}

TEST_CASE("a model may stand where a set of candidates may") {
  auto const file = checked(models + "selection = select power_law(n = 3) to d with abc_smc\n");
  REQUIRE(file.candidates.size() == 1);
  CHECK(file.candidates[0].models.at(0).name == "power_law(n = 3, p = 1)");
  CHECK(file.candidates[0].models.at(0).probability == 1);
  CHECK(select_task(file).fits.size() == 1);
}

TEST_CASE("channels are those that the data measure, in the order of the first candidate") {
  auto const file = selection("select laws to both with abc_smc, weights(force = 2)");
  CHECK(select_task(file).distance.channels == std::vector<std::string>{"displacement", "force"});
  CHECK(select_task(file).distance.weights == std::vector<double>{1, 2});
}

TEST_CASE("a distance of the user's means the same in every candidate") {
  // The bare number is in the unit of the first candidate's channel, kN; the others have N.
  auto const file = selection(
      "select laws to both with abc_smc, distance = (max(abs(residual(force)) - 0.5, 0)/1 [N], "
      "(residual(displacement)/1 [mm])^2)");
  SelectTask const& task = select_task(file);
  CHECK(task.distance.kind == DistanceRule::Kind::expression);
  REQUIRE(task.distance.expressions.size() == 3);
  for (std::size_t c = 0; c < 3; ++c) CHECK(value(file, task, c, 0, 0.005, 0.002) == near(9));
  // Of the force: |f - k y| - 500 N with k = 2, then k y^2 and k y^3.
  CHECK(value(file, task, 0, 1, 1000, 3) == near(494));
  CHECK(value(file, task, 1, 1, 1000, 3) == near(482));
  CHECK(value(file, task, 2, 1, 1000, 3) == near(446));
  CHECK(value(file, task, 2, 1, 400, 3) == 0);
}

TEST_CASE("a distance of absolute temperatures means the same whatever their zero points, which differences do not have") {
  auto const text = [](std::string const& unit) {
    return "model a { input u [delta_degC]; parameter c [degC] ~ uniform(0, 9)\nobserve d [degC] ~ normal(c + u, sd = 1) }\n"
           "model b { input u [delta_degC]; parameter c [" +
           unit + "] ~ uniform(273, 282)\nobserve d [" + unit +
           "] ~ normal(c + u, sd = 1) }\ncandidates both { a; b }\n"
           "data room { file \"d.csv\"; input u = u; measure d = T }\n"
           "s = select both to room with abc_smc, distance = (residual(d)/measured(d))^2\n";
  };
  auto const file = checked(text("K"));
  SelectTask const& task = select_task(file);
  auto const distance = [&](std::size_t candidate, double measured, double parameter) {
    Model const& model = file.models[static_cast<std::size_t>(task.fits[candidate].model)];
    return model.graph.evaluate(task.distance.expressions.at(candidate).at(0), [&](NodeId id) {
      LeafKind const kind = model.graph[id].leaf_kind;
      return kind == LeafKind::measured ? measured : kind == LeafKind::parameter ? parameter : 0.0;
    });
  };
  CHECK(distance(0, 20, 15) == near(0.0625));
  CHECK(distance(1, 293.15, 288.15) == relative(0.0625, 1e-9));
  CHECK(messages(text("delta_degC")).find("error[E6508]: `d` is not the same quantity in `a` and in `b`") != std::string::npos);
}

TEST_CASE("distances of two units are shown side by side") {
  std::string const shown =
      refused("select linear to both with abc_smc, distance = (abs(residual(displacement)), residual(force)^2)");
  CHECK(errors_in(shown) == 1);
  CHECK(shown.find("error[E6513]") != std::string::npos);
  CHECK(shown.find(" in [mm]\n") != std::string::npos);
  CHECK(shown.find(" in [kg^2 m^2/s^4]\n") != std::string::npos);
}

TEST_CASE("a channel without weight needs no expression") {
  auto const file = selection("select laws to both with abc_smc, distance = abs(residual(force)), weights(displacement = 0)");
  SelectTask const& task = select_task(file);
  Graph const& graph = file.models[static_cast<std::size_t>(task.fits[0].model)].graph;
  CHECK(graph.is_constant(task.distance.expressions[0][0], 0));
}

TEST_CASE("a prediction from a selection has the experiments of each candidate") {
  auto const file = checked(models +
                            "candidates laws { linear; power_law(n = 2..3) }\nselection = select laws to d.a with abc_smc\n"
                            "forecast = predict selection on d.b with draws(50)\n");
  auto const& task = std::get<PredictTask>(file.tasks.at(1).what);
  CHECK(task.fit == 0);
  CHECK(task.draws == 50);
  CHECK(task.candidate_experiments.size() == 3);
  REQUIRE(task.experiments.size() == 1);
  CHECK(task.fitted == std::vector<int>{0});
}

TEST_CASE("what is wrong with the data of a selection is said once, not for each candidate") {
  std::string const shown = refused(
      "data e { file \"d.csv\"; time t; measure displacement = y }\n"
      "candidates laws { linear; power_law(n = 2..3) }\nselect laws to e with abc_smc");
  CHECK(errors_in(shown) == 1);
  CHECK(shown.find("error[E4109]") != std::string::npos);
}

TEST_CASE("a set with a wrong model is not looked at again in its tasks") {
  CHECK(errors_in(refused("candidates laws { linear; power_law(m = 2) }\nselect laws to d with abc_smc\n"
                          "predict select_laws on d")) == 1);
  CHECK(errors_in(refused("model bad { state y; y' = z; initial y = 0; observe displacement ~ normal(y, sd = 1) }\n"
                          "candidates laws { linear; bad }\nselect laws to d with abc_smc")) == 1);
}

TEST_CASE("an expression is seen not to be negative by its structure") {
  Graph graph;
  NodeId const x = graph.leaf(LeafKind::measured, 0), y = graph.leaf(LeafKind::measured, 1);
  NodeId const square = graph.power(x, graph.constant(2)), size = graph.unary(Operation::absolute, y);
  for (NodeId const good :
       {square, size, graph.multiply(x, x), graph.add(square, size), graph.divide(size, square),
        graph.binary(Operation::maximum, x, graph.constant(0)), graph.power(size, graph.constant(1.5)),
        graph.unary(Operation::square_root, x), graph.select(graph.binary(Operation::less, x, y), square, size)})
    CHECK(non_negative(graph, good));
  for (NodeId const doubtful : {x, graph.subtract(square, size), graph.multiply(x, y), graph.power(x, graph.constant(3)),
                                graph.negate(square), graph.binary(Operation::minimum, x, square), graph.add(square, x),
                                graph.select(graph.binary(Operation::less, x, y), square, x)})
    CHECK_FALSE(non_negative(graph, doubtful));
}
