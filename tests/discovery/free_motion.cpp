// Free runs as a discovery shows and keeps them: they are the runs whose errors it states, and end where they are lost.
#include "discovery/free_motion.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/numeric/random.hpp"
#include "discovery/discovered.hpp"
#include "report/file/stored_report.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

/// Over what is scored and measured.
double error_of(Prediction const& run, PredictedQuantity const& quantity) {
  double squares = 0;
  int count = 0;
  for (std::size_t i = 0; i < run.time.size(); ++i)
    if (run.scored[i] != 0 && std::isfinite(quantity.measured[i]))
      squares += std::pow(quantity.response.mean[i] - quantity.measured[i], 2), ++count;
  return std::sqrt(squares / count);
}

}  // namespace

TEST_CASE("the free run that is kept has the error that is stated") {
  Discovered const found(duffing);
  Report const report = read_result(found.place);
  REQUIRE(report.discovery->free_runs.size() == 1);
  Prediction const& run = report.discovery->free_runs[0];
  CHECK(run.experiment == "bench.test");
  nlohmann::json const& stated = found.summary.at("discovery").at("judged").at("structures").at(0).at("channels").at(0);
  CHECK(error_of(run, run.quantities.at(0)) == doctest::Approx(stated.at("free_run").get<double>()).epsilon(1e-12).scale(0));
  CHECK(std::count(run.scored.begin(), run.scored.end(), 0) ==
        found.summary.at("discovery").at("judged").at("start_rows").get<int>());
}

TEST_CASE("of a difference equation, too") {
  TemporaryFolder folder;
  Stream noise({7, Purpose::noise, 0, 0}), input({7, Purpose::input, 0, 0});
  std::string csv = "u,y\n";
  double y = 0, before = 0, u = 0;
  for (int i = 0; i < 600; ++i) {
    double const next = 0.6 * y - 0.25 * before + 0.5 * u - 0.1 * y * u + 0.05 * noise.normal();
    before = y, y = next, u = input.normal();
    csv += fmt::format("{:.17g},{:.17g}\n", u, y);
  }
  write_file(folder.path() / "made.csv", csv);
  RunOptions options;
  options.output = folder.path() / "results";
  run_text(folder.path() / "made.sysid",
           "dictionary narx { time discrete; input u; state y = position; target = y\n"
           "  terms = polynomial(lags(y, 1..2), lag(u, 1), degree = 2) }\n"
           "data bench { file \"made.csv\"; step 0.1 [s]; input u = u; measure position = y\n"
           "  split train = rows 1..400, test = rows 401..600 }\n"
           "found = discover narx from bench.train with spike_slab, seed = 1\n",
           options);
  Report const report = read_result(folder.path() / "results/found");
  REQUIRE(report.discovery->free_runs.size() == 1);
  Prediction const& run = report.discovery->free_runs[0];
  CHECK(run.time.size() == 200);
  REQUIRE(report.discovery->forecasts.at(0).free_run);
  CHECK(error_of(run, run.quantities.at(0)) == doctest::Approx(*report.discovery->forecasts[0].free_run).epsilon(1e-12).scale(0));
}

TEST_CASE("a run that leaves ten times the range of the samples ends there, in every channel") {
  Model measured;
  measured.channels.resize(2);
  measured.channels[0].name = "a";
  measured.channels[1].name = "b";
  Experiment experiment;
  experiment.name = "e";
  for (int i = 0; i < 8; ++i) experiment.time.push_back(0.5 * i);
  experiment.scored.assign(8, 1);
  experiment.measured = {{0, 1, 0, 1, 0, 1, 0, 1}, {}};
  FreeMotion const run{0, 2, 1, {{0, 1, 2, 5.4, 5.6, 0}, {1, 2, 3, 4, 5, 6}}};
  Prediction const shown = shown_motion(run, experiment, measured, std::vector<std::size_t>{0, 1});
  CHECK(shown.time.front() == 1);
  CHECK(shown.scored == std::vector<std::uint8_t>{0, 1, 1, 1, 1, 1});
  for (PredictedQuantity const& each : shown.quantities) {
    CHECK(std::isfinite(each.response.mean[3]));
    CHECK(std::isnan(each.response.mean[4]));
    CHECK(std::isnan(each.response.mean[5]));
  }
  CHECK(shown.quantities[0].measured == std::vector<double>{0, 1, 0, 1, 0, 1});
  CHECK(shown.quantities[1].measured.empty());
}
