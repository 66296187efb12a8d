// InferenceData in NetCDF-4 as xarray opens it, against the results it was made of: shared, vector-valued and per-experiment
// parameters, missing samples, an optimum, a selection, an unknown function.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>

#include "exchange/exported.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

/// Has xarray compare FILE.nc with its folder; further arguments as the script takes them.
void compare(std::filesystem::path const& file, std::string const& arguments) {
  Said const said = said_by_python("'" + (scripts / "read_netcdf.py").string() + "' '" + file.string() + "' '" +
                                   file.parent_path().string() + "' " + arguments);
  CHECK_MESSAGE(said.exit == 0, said.text);
  MESSAGE(said.text);
}

bool skipped() {
  if (has_xarray()) return false;
  MESSAGE("skipped: xarray or netCDF4 of " << python << " is not installed (python3-xarray, python3-netcdf4)");
  return true;
}

std::string quoted(std::string const& label, std::filesystem::path const& path) { return "'" + label + "=" + path.string() + "' "; }

std::string const vector_case = R"(
model bending "Two modes and a line" {
  input     u [V], w [V]
  parameter gain(2) [mm/V] ~ normal(0, sd = 10)
  parameter spread(2) [mm] ~ log_uniform(0.01, 10)
  parameter days  [days]   ~ log_uniform(1, 10)
  parameter chain          ~ normal(0, sd = 1)
  observe left  [mm] ~ normal(gain[1]*u + chain*0 [mm], sd = spread[1])
  observe right [mm] ~ normal(gain[2]*w + 0 [mm/day]*days, sd = spread[2])
}
data bench {
  file    "bench.csv"
  input   u = u [V]
  input   w = w [V]
  measure left = left [mm]
  measure right = right [mm]
  split   train = rows 1..30, test = rows 31..40
}
posterior = fit bending to bench.train with mh(samples = 400, burn_in = 100, thin = 1, chains = 3), seed = 3
best      = fit bending to bench.train with map, seed = 3
forecast  = predict posterior on bench.test with draws(90), seed = 3
short     = predict posterior on bench.test with draws(30), seed = 4
again     = predict posterior on bench.test with draws(90), seed = 5
)";

std::string bench() {
  std::string csv = "u,w,left,right\n";
  for (int i = 0; i < 40; ++i) {
    double const u = std::sin(0.7 * i), w = std::cos(1.3 * i * i);
    csv += fmt::format("{},{},{},{}\n", u, w, i % 9 == 4 ? std::string() : fmt::format("{}", 3 * u + 0.1 * std::sin(9.0 * i)),
                       -2 * w + 0.2 * std::cos(7.0 * i));
  }
  return csv;
}

}  // namespace

TEST_CASE("xarray finds the draws, bands and likelihoods of a fit to two experiments in the exported file") {
  std::string const text = read_file(models / "two_experiments/two_experiments.sysid");
  ExportedRun const run(models / "two_experiments/two_experiments.sysid",
                        with(text, "samples = 20000, burn_in = 5000, thin = 10", "samples = 1500, burn_in = 500, thin = 2"));
  std::string const said = run.export_all();
  CHECK(
      said.find("together.nc: posterior, sample_stats, observed_data, constant_data, log_likelihood, posterior_predictive, prior, "
                "prior_predictive, predictions, predictions_constant_data") != std::string::npos);
  CHECK(said.find("left out") == std::string::npos);
  auto const file = run.results() / "together/together.nc";
  std::string const bytes = read_file(file);
  run.export_all();
  CHECK(read_file(file) == bytes);
  if (skipped()) return;
  compare(file, quoted("[bare.test]", run.results() / "forecast/predict_bare_test.csv") +
                    quoted("[loaded.test]", run.results() / "forecast/predict_loaded_test.csv"));
}

TEST_CASE(
    "vectors become arrays, missing samples have no likelihood, units of time stay numbers, and names may be those of dimensions") {
  TemporaryFolder folder;
  write_file(folder.path() / "bench.csv", bench());
  ExportedRun const run(folder.path() / "bending.sysid", vector_case);
  CHECK(run.export_all(60).find("left out") == std::string::npos);
  if (skipped()) return;
  compare(run.results() / "best/best.nc", "");
  Said const said =
      said_by_python("-c \"import xarray as x; f = '" + (run.results() / "posterior/posterior.nc").string() +
                     "'\nd = x.open_dataset(f, group='posterior')\n"
                     "print(d.gain.dims, d.gain_dim_0.values, d.days.dtype, d.days.units, d['chain_'].attrs['long_name'])\n"
                     "l = x.open_dataset(f, group='log_likelihood')\nprint(l.left.shape, l.right.shape, l.draw.values[:2])\n"
                     "p = x.open_dataset(f, group='predictions')\nprint(sorted(p.data_vars))\nprint(p['right[again]'].shape)\n"
                     "print(x.open_dataset(f, group='predictions_short')['right[short]'].shape)\"");
  CHECK(said.text ==
        "('chain', 'draw', 'gain_dim_0') [1 2] float64 day chain\n(3, 20, 27) (3, 20, 30) [ 7 22]\n"
        "['left[again]', 'left[forecast]', 'left_response[again]', 'left_response[forecast]', 'right[again]', 'right[forecast]', "
        "'right_response[again]', 'right_response[forecast]']\n(1, 90, 10)\n(1, 30, 10)\n");
}

TEST_CASE("without the model's text a file holds what the results hold themselves") {
  TemporaryFolder folder;
  write_file(folder.path() / "bench.csv", bench());
  ExportedRun const run(folder.path() / "bending.sysid", vector_case);
  CHECK(run.export_all(0).find("posterior.nc: posterior, sample_stats\n") != std::string::npos);
}

TEST_CASE("each living candidate of a selection has a file with its particles, weighted and resampled") {
  auto const model = models / "bouc_wen/bouc_wen.sysid";
  std::string text = with(read_file(model), "bouc_wen(n = 1..4)", "bouc_wen(n = 1..2)");
  text = with(text, "particles = 1000, quantile = 0.2, polish = yes", "particles = 200, target = 30");
  ExportedRun const run(model, text);
  std::string const said = run.export_all();
  auto const file = run.results() / "selection/selection_bouc_wen(n=2).nc";
  CHECK(said.find("posterior, weighted_posterior, weighted_sample_stats, observed_data, constant_data, predictions, "
                  "predictions_constant_data") != std::string::npos);
  REQUIRE(std::filesystem::exists(file));
  if (skipped()) return;
  Said const read = said_by_python(
      "-c \"import xarray as x, json, csv\nf = '" + file.string() +
      "'\nw = x.open_dataset(f, group='weighted_posterior'); s = x.open_dataset(f, group='weighted_sample_stats')\n"
      "p = x.open_dataset(f, group='posterior'); j = json.load(open('" +
      (run.results() / "selection/summary.json").string() +
      "'))['models']['bouc_wen(n = 2)']['parameters']\n"
      "c = list(csv.DictReader(l for l in open('" +
      (run.results() / "selection/particles_bouc_wen(n=2).csv").string() +
      "') if l[0] != '#'))\n"
      "assert [float(r['weight__']) for r in c] == list(s.weight.values[0])\n"
      "assert [float(r['distance__']) for r in c] == list(s.distance.values[0])\n"
      "for k in j:\n  assert [float(r[k]) for r in c] == list(w[k].values[0]), k\n"
      "  mean = float((w[k] * s.weight).sum() / s.weight.sum()); assert abs(mean - j[k]['mean']) < 1e-12 * abs(mean), k\n"
      "  assert set(p[k].values[0]) <= set(w[k].values[0]), k\nprint(len(j), p.sizes['draw'] == len(c), "
      "abs(float(s.weight.sum()) - 1) < 1e-12)\"");
  CHECK(read.text == "5 True True\n");
  // The trajectories of all candidates are those of the bands.
  Said const predicted = said_by_python(
      "-c \"import xarray as x, netCDF4, numpy as n, csv, glob\nr = '" + run.results().string() +
      "'\na = [x.open_dataset(f, group='predictions').displacement_response.values[0] for f in glob.glob(r + '/selection/*.nc') "
      "if 'predictions' in netCDF4.Dataset(f).groups]\n"
      "c = list(csv.DictReader(l for l in open(r + '/forecast/predict.csv') if l[0] != '#'))\n"
      "m = n.array([float(l['displacement_mean']) for l in c if l['scored'] == '1'])\n"
      "print(len(a) > 1, n.allclose(n.concatenate(a).mean(0), m, rtol=1e-11, atol=0))\"");
  CHECK(predicted.text == "True True\n");
}

TEST_CASE("of an unknown function over the rows there are trajectories; what has no group is left out with the reason") {
  auto const model = models / "bridge/bridge.sysid";
  ExportedRun const run(model, read_file(model));
  std::string const said = run.export_all();
  CHECK(said.find("line_curved.nc: posterior, sample_stats, observed_data, constant_data, posterior_predictive, predictions, "
                  "predictions_constant_data") != std::string::npos);
  CHECK(said.find("left out: log_likelihood, prior, prior_predictive: ") != std::string::npos);
  if (skipped()) return;
  compare(run.results() / "line_curved/line_curved.nc", quoted("", run.results() / "line_curved_winter/predict.csv"));
}

TEST_CASE("constants of data blocks stand beside the inputs, with their units") {
  std::string const text = read_file(models / "two_experiments/two_experiments.sysid");
  ExportedRun const run(models / "two_experiments/two_experiments.sysid",
                        with(text, "samples = 20000, burn_in = 5000, thin = 10", "samples = 200, burn_in = 100, thin = 1"));
  run.export_all(10);
  if (skipped()) return;
  Said const said = said_by_python(
      "-c \"import xarray as x\nfor g in 'constant_data', 'predictions_constant_data':\n"
      "  d = x.open_dataset('" +
      (run.results() / "together/together.nc").string() +
      "', group=g)\n"
      "  print(sorted((n, float(v), v.units) for n, v in d.data_vars.items() if v.ndim == 0))\"");
  CHECK(said.text == "[('added[loaded.train]', 0.5, 'kg')]\n[('added[loaded.test]', 0.5, 'kg')]\n");
}

TEST_CASE("predictions of a folder that was renamed are left out with the reason") {
  TemporaryFolder folder;
  write_file(folder.path() / "bench.csv", bench());
  ExportedRun const run(folder.path() / "bending.sysid", vector_case);
  std::filesystem::copy(run.results() / "posterior", run.results() / "kept", std::filesystem::copy_options::recursive);
  std::string const said = run.export_all(30, "kept");
  CHECK(said.find("kept/posterior.nc: posterior, sample_stats, observed_data, constant_data, log_likelihood, posterior_predictive, "
                  "prior, prior_predictive\n") != std::string::npos);
  CHECK(said.find("left out: predictions: `kept` is a copy, and the predictions stored beside it were made from `posterior`\n") !=
        std::string::npos);
}
