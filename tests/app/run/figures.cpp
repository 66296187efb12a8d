// What figures need of a run: values that data were made with, inputs, restoring forces.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <sstream>

#include "app/run/report_results.hpp"
#include "app/running.hpp"
#include "app/stored_pages.hpp"
#include "experiment/true_parameters.hpp"
#include "mechanics/second_difference.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

std::string const drawn_oscillator = R"(
model spring {
  input   x [N]
  state   y [mm]
  initial y = 0, y' = 0
  parameter m  [kg]     ~ log_uniform(0.1, 10)
  parameter c  [N s/m]  ~ log_uniform(2, 200)
  parameter k  [N/m]    ~ log_uniform(1e3, 1e5)
  parameter k3 [N/m^3]  ~ log_uniform(5e8, 5e10)
  parameter sigma [m]   ~ log_uniform(1e-8, 1e-3)
  m*y'' + c*y' + k*y + k3*y^3 = x
  observe displacement ~ normal(y, sd = sigma)
}
data bench {
  file    "results/truth/made.csv"
  time    t [s]
  input   x = x [N] hold zero_order
  measure displacement = displacement [mm]
}
truth = simulate spring with values(m = 1, c = 20, k = 1e4, k3 = 5e9), input x = gaussian(sd = 10), noise = NOISE [percent],
    samples = 400, rate = 1000 [Hz], seed = 1, file = "made.csv"
best = fit spring to bench with map, seed = 1
)";

std::vector<std::vector<double>> block(std::string const& script, std::string const& name) {
  std::size_t const begin = script.find("$" + name + " << EOD\n");
  REQUIRE_MESSAGE(begin != std::string::npos, name);
  std::istringstream lines(script.substr(begin));
  std::string line;
  std::getline(lines, line);
  std::vector<std::vector<double>> rows;
  while (std::getline(lines, line) && line != "EOD") {
    std::istringstream cells(line);
    std::vector<double> row;
    for (std::string cell; cells >> cell;) row.push_back(cell == "NaN" ? std::nan("") : std::stod(cell));
    if (!row.empty()) rows.push_back(row);
  }
  return rows;
}

/// The error of the forces of a script's rows ("data" or "model") against force(place, speed), as a part of their size. SI of
/// lengths in mm.
double error(std::string const& script, std::string const& rows, std::function<double(double, double)> const& force) {
  auto const places = block(script, "displacement_" + rows), speeds = block(script, "velocity_" + rows);
  REQUIRE(places.size() > 100);
  REQUIRE(places.size() == speeds.size());
  double square = 0, size = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    double const right = force(1e-3 * places[i][0], 1e-3 * speeds[i][0]);
    square += (places[i][1] - right) * (places[i][1] - right);
    size += right * right;
  }
  return std::sqrt(square / size);
}

}  // namespace

TEST_CASE("the restoring force of a spring is the one it was made with, by the model and by the data") {
  CaseRun const run(with(drawn_oscillator, "NOISE", "1"), {});
  std::string const script = run.file("best/figures/loop_bench_y.gnuplot");
  for (char const* label : {"'restoring force [N]'", "'y [mm]'", "'y'' [mm/s]'"})
    REQUIRE_MESSAGE(script.find(label) != std::string::npos, label);
  auto const force = [](double y, double v) { return 1e4 * y + 5e9 * y * y * y + 20 * v; };
  CHECK(error(script, "model", force) < 0.05);  // the parameters are estimates
  // The noise that is left is a tenth of the force, what smoothing bends at most another.
  CHECK(error(script, "data", force) < 0.2);
  CHECK(std::filesystem::exists(run.folder.path() / "results/best/figures/surface_bench_y.gnuplot"));
  // All of it comes back from the folder.
  CHECK(test::broken_promises(run.folder.path() / "results") == "");
}

TEST_CASE("a spring on a moving ground pulls back, too: the sign of its input is turned") {
  std::string text = with(drawn_oscillator, "NOISE", "1");
  for (std::size_t at = 0; (at = text.find("= x\n", at)) != std::string::npos; at += 5) text.replace(at, 4, "= -x\n");
  REQUIRE(text.find("= -x\n") != std::string::npos);
  CaseRun const run(text, {});
  std::string const script = run.file("best/figures/loop_bench_y.gnuplot");
  for (char const* rows : {"displacement_model", "displacement_data"}) {
    double together = 0, square = 0, size = 0;
    for (auto const& row : block(script, rows)) {
      double const y = 1e-3 * row[0], spring = 1e4 * y + 5e9 * y * y * y;
      together += row[1] * y;
      square += (row[1] - spring) * (row[1] - spring);
      size += spring * spring;
    }
    CHECK(together > 0);
    CHECK(std::sqrt(square / size) < 0.5);  // the damper's part, smoothing and noise
  }
}

TEST_CASE("figures are drawn anew from the folder of their results") {
  REQUIRE(can_draw(FigureFormat::pdf));
  CaseRun const run(with(drawn_oscillator, "NOISE", "1"), {});
  std::filesystem::path const results = run.folder.path() / "results", figures = results / "best/figures";
  redraw_figures(results, {FigureFormat::text, FigureFormat::pdf});
  CHECK(std::filesystem::exists(figures / "loop_bench_y.txt"));
  CHECK(read_file(figures / "surface_bench_y.pdf").starts_with("%PDF"));
  CHECK_FALSE(std::filesystem::exists(figures / "loop_bench_y.svg"));
  CHECK_THROWS_AS(redraw_figures(run.folder.path() / "nowhere", {FigureFormat::svg}), IoError);
}

TEST_CASE("data that are noise once they are differentiated twice are left out") {
  CaseRun const run(with(drawn_oscillator, "NOISE", "60"), {});
  std::string const script = run.file("best/figures/loop_bench_y.gnuplot");
  CHECK(script.find("$displacement_data") == std::string::npos);
  CHECK(script.find("$displacement_model") != std::string::npos);
}

TEST_CASE("without an input the force is that of one unit of mass") {
  CaseRun const run(R"(
model decay {
  state   angle [rad]
  initial angle = first, angle' = 0
  parameter w     [1/s] ~ log_uniform(1, 10)
  parameter d     [1/s] ~ log_uniform(0.01, 1)
  parameter first [rad] ~ uniform(0.1, 3)
  parameter sigma [rad] ~ log_uniform(1e-6, 1)
  angle'' + d*angle' + w^2*sin(angle) = 0
  observe measured_angle ~ normal(angle, sd = sigma)
}
data bench {
  file    "results/truth/made.csv"
  time    t [s]
  measure measured_angle = measured_angle [rad]
}
truth = simulate decay with values(w = 3, d = 0.2, first = 2.5), noise = 1 [percent], samples = 400, rate = 50 [Hz], seed = 1,
    file = "made.csv"
best = fit decay to bench with map, seed = 1
)",
                    {});
  std::string const script = run.file("best/figures/loop_bench_angle.gnuplot");
  CHECK(script.find("'force per mass [rad/s²]'") != std::string::npos);
  auto const places = block(script, "displacement_model"), speeds = block(script, "velocity_model");
  REQUIRE(places.size() == speeds.size());
  REQUIRE(places.size() > 100);
  for (std::size_t i = 0; i < places.size(); ++i)
    CHECK(places[i][1] == doctest::Approx(9 * std::sin(places[i][0]) + 0.2 * speeds[i][0]).epsilon(0.01).scale(9));
}

TEST_CASE("a hysteresis has loops and no surface") {
  std::string hysteresis = with(drawn_oscillator, "NOISE", "1");
  hysteresis = with(hysteresis, "state   y [mm]", "state   y [mm], z [N]");
  hysteresis = with(hysteresis, "y' = 0", "y' = 0, z = 0");
  hysteresis = with(hysteresis, "  m*y'' + c*y' + k*y + k3*y^3 = x", "  m*y'' + c*y' + z = x\n  z' = k*y' - k3/area*abs(y')*z");
  hysteresis = with(hysteresis, "  parameter sigma", "  parameter area [N/m^2] = 1e7\n  parameter sigma");
  CaseRun const run(hysteresis, {});
  std::filesystem::path const figures = run.folder.path() / "results/best/figures";
  CHECK(std::filesystem::exists(figures / "loop_bench_y.gnuplot"));
  CHECK_FALSE(std::filesystem::exists(figures / "surface_bench_y.gnuplot"));
}

TEST_CASE("a model of first order has no restoring force") {
  std::string first = with(drawn_oscillator, "NOISE", "1");
  first = with(first, "initial y = 0, y' = 0", "initial y = 0");
  first = with(first, "  parameter m  [kg]     ~ log_uniform(0.1, 10)\n", "");
  first = with(first, "m = 1, ", "");
  first = with(first, "  m*y'' + c*y' + k*y + k3*y^3 = x", "  c*y' + k*y + k3*y^3 = x");
  CaseRun const run(first, {});
  for (auto const& entry : std::filesystem::directory_iterator(run.folder.path() / "results/best/figures"))
    CHECK_MESSAGE(!entry.path().filename().string().starts_with("loop"), entry.path().filename());
}

namespace {

/// The spring with a second mass of twice the size on it, pushed at that; ground: what holds the second to the ground.
std::string chain(std::string const& ground) {
  std::string text = with(drawn_oscillator, "NOISE", "1");
  text = with(text, "state   y [mm]", "state   y [mm], w [mm]");
  text = with(text, "y' = 0", "y' = 0, w = 0, w' = 0");
  text = with(
      text, "  m*y'' + c*y' + k*y + k3*y^3 = x",
      "  m*y'' + c*y' + k*y + k3*y^3 - k*(w - y) - c*(w' - y') = 0 [N]\n  2*m*w'' + c*(w' - y') + k*(w - y)" + ground + " = x");
  text = with(text, "normal(y, sd = sigma)", "normal(y, sd = sigma)\n  observe outer ~ normal(w, sd = sigma)");
  return with(text, "displacement [mm]\n", "displacement [mm]\n  measure outer = outer [mm]\n");
}

}  // namespace

TEST_CASE("each spring between coupled masses has its force, over its elongation, by the model and by the data") {
  CaseRun const run(chain(""), {});
  std::string const inner = run.file("best/figures/loop_bench_y.gnuplot"), outer = run.file("best/figures/loop_bench_w_y.gnuplot");
  auto const at_ground = [](double y, double v) { return 1e4 * y + 5e9 * y * y * y + 20 * v; };
  auto const between = [](double d, double v) { return 1e4 * d + 20 * v; };
  CHECK(error(inner, "model", at_ground) < 0.05);
  CHECK(error(outer, "model", between) < 0.05);
  CHECK(error(inner, "data", at_ground) < 0.25);
  CHECK(error(outer, "data", between) < 0.25);
  CHECK(outer.find("'w − y [mm]'") != std::string::npos);
  CHECK(outer.find("'restoring force [N]'") != std::string::npos);
  CHECK(std::filesystem::exists(run.folder.path() / "results/best/figures/surface_bench_w_y.gnuplot"));
  CHECK(test::broken_promises(run.folder.path() / "results") == "");
}

TEST_CASE("what pulls at one mass alone is no link: an actuator that follows, a mass carried along, in any order of the states") {
  // w reads y, which does not read w: y has the force of its spring, w none by the data.
  std::string text = chain("");
  text = with(text, " - k*(w - y) - c*(w' - y') = 0 [N]", " = x");
  CaseRun const carried(text, {});
  CaseRun const other_order(with(text, "state   y [mm], w [mm]", "state   w [mm], y [mm]"), {});
  auto const loops = [](CaseRun const& run) {
    std::set<std::string> names;
    for (auto const& entry : std::filesystem::directory_iterator(run.folder.path() / "results/best/figures"))
      if (entry.path().filename().string().starts_with("loop_")) names.insert(entry.path().filename().string());
    return names;
  };
  CHECK(loops(carried).contains("loop_bench_y.gnuplot"));
  CHECK(loops(other_order) == loops(carried));
  // A ring in one sense: w reads v directly, v reads y, y reads w; v follows w in turn.
  std::string ring = with(chain(" + 0.1*k*(w - v)"), "state   y [mm], w [mm]", "state   v [mm], y [mm], w [mm]");
  ring = with(ring, "y' = 0, w", "y' = 0, v = 0, v' = 0, w");
  ring = with(ring, " = 0 [N]\n", " + k*(y - v) = 0 [N]\n  m*v'' + c*v' + k*(v - y) = 0 [N]\n");
  CaseRun const actuated(ring, {});
  CHECK(actuated.result.exit <= 1);
  CHECK(loops(actuated).contains("loop_bench_w_y.gnuplot"));
}

TEST_CASE("where both masses are held by the ground, too, the model alone tells the forces apart") {
  CaseRun const run(chain(" + 2*k*w"), {});
  for (auto const& [name, stiffness] : {std::pair("w_y", 1e4), std::pair("w", 2e4)}) {
    std::string const script = run.file(std::string("best/figures/loop_bench_") + name + ".gnuplot");
    CHECK(script.find("$displacement_data") == std::string::npos);
    bool const link = std::string(name) == "w_y";
    CHECK(error(script, "model", [&](double d, double v) { return stiffness * d + (link ? 20 * v : 0); }) < 0.05);
  }
}

TEST_CASE("an accelerometer shows the force without any differentiation") {
  std::string text = with(drawn_oscillator, "NOISE", "1");
  text = with(text, "observe displacement ~ normal(y, sd = sigma)", "observe felt ~ normal(y'', sd = 1e6*sigma/area)");
  text = with(text, "  parameter sigma", "  parameter area [s^2] = 1\n  parameter sigma");
  text = with(text, "measure displacement = displacement [mm]", "measure felt = felt [mm/s^2]");
  CaseRun const run(text, {});
  std::string const script = run.file("best/figures/loop_bench_y.gnuplot");
  CHECK(error(script, "data", [](double y, double v) { return 1e4 * y + 5e9 * y * y * y + 20 * v; }) < 0.1);
}

TEST_CASE("values that data were made with come with their unit, and only from what simulate wrote") {
  std::vector<std::string> const head = {
      "made by sysid 0.1.0: truth of model m, seed 1", "k = 18.6 [N/mm]", "c = 60 [kg]", "other = 1 [N]", "n = 2 [-]",
      "column x [N]: zero_order between samples"};
  Model model;
  for (char const* name : {"k", "c", "n"}) {
    Parameter parameter;
    parameter.name = name;
    model.parameters.push_back(parameter);
  }
  model.parameters[0].unit = divide(*unit_atom("N"), *unit_atom("m"));
  model.parameters[0].unit->text = "N/m";
  model.parameters[0].per_experiment = true;
  model.parameters[1].unit = *unit_atom("N");
  std::vector<TrueValue> const values = true_values(head, model, "first");
  REQUIRE(values.size() == 2);  // of c the dimension is another
  CHECK(values[0].name == "k[first]");
  CHECK(values[0].value == doctest::Approx(18600).epsilon(1e-12));
  CHECK(values[0].unit == "N/m");
  CHECK(values[1].name == "n");
  CHECK(true_values({"k = 18.6 [N/mm]"}, model, "first").empty());
}

TEST_CASE("the second difference is exact for parabolas and smooths by weights of sum one") {
  for (int const half_width : {2, 5, 11}) {
    SecondDifference const difference(half_width);
    REQUIRE(difference.weights.size() == static_cast<std::size_t>(2 * half_width + 1));
    REQUIRE(difference.smoothing.size() == static_cast<std::size_t>(2 * half_width - 1));
    double curvature = 0, sum = 0, noise = 0, again = 0;
    auto const y = [](int k) { return 3 - 2 * k + 0.5 * 7 * k * k + 0.3 * k * k * k; };
    for (int k = -half_width; k <= half_width; ++k) {
      curvature += difference.weights[static_cast<std::size_t>(k + half_width)] * y(k);
      noise += std::pow(difference.weights[static_cast<std::size_t>(k + half_width)], 2);
    }
    for (int k = 1 - half_width; k < half_width; ++k) {
      double const weight = difference.smoothing[static_cast<std::size_t>(k + half_width - 1)];
      sum += weight;
      again += weight * (y(k + 1) - 2 * y(k) + y(k - 1));
    }
    CHECK(curvature == doctest::Approx(7).epsilon(1e-10));
    CHECK(sum == doctest::Approx(1).epsilon(1e-10));
    CHECK(again == doctest::Approx(7).epsilon(1e-10));
    CHECK(difference.noise == relative(std::sqrt(noise), 1e-12));
  }
}
