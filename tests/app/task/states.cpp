// A fit of a model with a disturbance writes what the record says of its states.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/running.hpp"
#include "app/tables.hpp"
#include "core/numeric/random.hpp"
#include "relative.hpp"
#include "report/file/stored_report.hpp"
#include "report/file/task_folder.hpp"

using namespace sysid;

namespace {

constexpr int state_rows = 150;

/// 1 kg on a spring of 50 N/m under a known force and white noise of 0.02 N^2 s, seen at every 0.05 s.
struct ShakenRecord {
  std::string csv = "t,x,y\n";
  std::vector<double> displacement, velocity, force;  // force: its mean up to the next row
};

ShakenRecord shaken_record() {
  ShakenRecord record;
  Stream stream({3, Purpose::test, 0, 0});
  constexpr int parts = 50;
  constexpr double step = 0.05, h = step / parts;
  double y = 0, v = 0;
  for (int i = 0; i < state_rows; ++i) {
    double const x = std::sin(0.4 * i);
    record.csv += fmt::format("{},{},{}\n", i * step, x, y + 0.002 * stream.normal());
    record.displacement.push_back(y);
    record.velocity.push_back(v);
    double sum = 0;
    for (int part = 0; part < parts; ++part) {
      double const w = std::sqrt(0.02 / h) * stream.normal();
      v += h * (x + w - 0.8 * v - 50 * y);
      y += h * v;
      sum += w / parts;
    }
    record.force.push_back(sum);
  }
  return record;
}

std::string const shaken_text = R"(
model shaken {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter c [N s/m] ~ log_uniform(0.01, 10)
  parameter k [N/m] ~ log_uniform(5, 500)
  parameter q [N^2 s] ~ log_uniform(1e-4, 1)
  disturbance w [N] ~ white(intensity = q)
  1 [kg]*y'' + c*y' + k*y = x + w
  observe displacement [m] ~ normal(y, sd = 2 [mm])
  derive spring [N] = k*y
}
data bench { file "bench.csv"; time t [s]; input x = x [N] hold zero_order; measure displacement = y [m] }
)";

double share_inside(std::string const& csv, std::string const& name, std::vector<double> const& truth, double scale = 1) {
  std::vector<double> const low = column(csv, name + "_q2.5"), high = column(csv, name + "_q97.5");
  double inside = 0;
  for (std::size_t i = 1; i + 1 < truth.size(); ++i) inside += low[i] <= scale * truth[i] && scale * truth[i] <= high[i] ? 1 : 0;
  return inside / static_cast<double>(truth.size() - 2);
}

}  // namespace

TEST_CASE("a fit of a model with a disturbance writes its states, and the force that acted") {
  ShakenRecord const record = shaken_record();
  CaseRun const run(shaken_text + "posterior = fit shaken to bench with mh(samples = 1000, burn_in = 500, chains = 4), seed = 1\n",
                    {{"bench.csv", record.csv}});
  std::string const csv = run.file("posterior/states.csv");
  CHECK(column(csv, "t").size() == state_rows);
  // Of one record neighbouring samples are wrong together.
  CHECK(share_inside(csv, "y", record.displacement) > 0.85);
  CHECK(share_inside(csv, "y'", record.velocity) > 0.85);
  CHECK(share_inside(csv, "w", record.force) > 0.85);
  CHECK(share_inside(csv, "spring", record.displacement, 50) > 0.8);
  CHECK(std::isnan(column(csv, "w_mean").back()));
  CHECK(column(csv, "y_sd")[0] == 0);  // the start is known
  auto const states = run.summary("posterior").at("states").at("bench");
  CHECK(states.at("file") == "states.csv");
  CHECK(states.at("draws") == 100);
  CHECK(states.at("quantities").at("w").at("mean_between_samples") == true);
  CHECK(states.at("quantities").at("w").at("unit") == "N");
  CHECK(states.at("quantities").at("y").at("rms").get<double>() > 5 * states.at("quantities").at("y").at("sd").get<double>());
  CHECK(run.result.out.find("\nStates and disturbances\n") != std::string::npos);
  CHECK(run.result.out.find("w, mean between samples") != std::string::npos);
  for (char const* name : {"smoothed_bench_y.gnuplot", "smoothed_bench_w.gnuplot"})
    CHECK(std::filesystem::exists(run.folder.path() / "results/posterior/figures" / name));
  CHECK(run.file("posterior/report.html").find("States and disturbances") != std::string::npos);

  // What is stored makes the same page again.
  Report const stored = read_result(run.folder.path() / "results/posterior");
  REQUIRE(stored.states.size() == 1);
  CHECK(stored.states[0].smoothed);
  REQUIRE(stored.states[0].quantities.size() == 4);
  CHECK(stored.states[0].quantities[2].average);
  CHECK(stored.states[0].quantities[0].response.mean == column(csv, "y_mean"));
  write_result(stored, run.folder.path() / "again", {});
  CHECK(read_file(run.folder.path() / "again/states.csv") == csv);
  CHECK(read_file(run.folder.path() / "again/report.html") == run.file("posterior/report.html"));
}

TEST_CASE("an optimum has bands of its states, and a model without disturbances has no table") {
  ShakenRecord const record = shaken_record();
  CaseRun const run(shaken_text + "mode = fit shaken to bench with map, seed = 1\n", {{"bench.csv", record.csv}});
  std::string const csv = run.file("mode/states.csv");
  CHECK(column(csv, "y_q97.5")[70] - column(csv, "y_q2.5")[70] == relative(2 * 1.959963984540054 * column(csv, "y_sd")[70], 1e-9));
  std::string quiet = with(without(shaken_text, "  disturbance w [N] ~ white(intensity = q)\n"), "x + w", "x");
  quiet = without(quiet, "  parameter q [N^2 s] ~ log_uniform(1e-4, 1)\n");
  CaseRun const known(quiet + "mode = fit shaken to bench with map, seed = 1\n", {{"bench.csv", record.csv}});
  CHECK_FALSE(std::filesystem::exists(known.folder.path() / "results/mode/states.csv"));
  CHECK_FALSE(known.summary("mode").contains("states"));
  CHECK(known.result.out.find("States and disturbances") == std::string::npos);
}
