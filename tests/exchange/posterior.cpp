// Draws in the form of Stan's CSV, read by R's read.csv and summarised by the package `posterior`, against summary.json.
#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "exchange/exported.hpp"
#include "report/file/csv.hpp"

using namespace sysid;
using namespace sysid::testing;
using json = nlohmann::json;

namespace {

constexpr std::array columns = {"mean", "median", "sd", "mad", "q5", "q95", "rhat", "ess_bulk", "ess_tail", "mcse_mean"};

/// Per variable of the CSV its numbers, in the order of `columns`.
std::map<std::string, std::vector<double>> of_posterior(std::filesystem::path const& folder) {
  Said const said = said_by("Rscript --vanilla '" + (scripts / "summarise.R").string() + "' '" + folder.string() + "'");
  REQUIRE_MESSAGE(said.exit == 0, said.text);
  std::map<std::string, std::vector<double>> all;
  std::istringstream lines(said.text);
  for (std::string line, cell; std::getline(lines, line);) {
    std::istringstream cells(line);
    std::string name;
    if (!std::getline(cells, name, '\t')) continue;
    while (std::getline(cells, cell, '\t')) all[name].push_back(cell == "NA" ? std::nan("") : std::stod(cell));
  }
  return all;
}

/// Numbers that are sums or picks of draws agree to the last bit, or the one beside it where R's wider type rounds once less. A sd
/// is rounded three times by R, its sum of squares, the part of n - 1 and the root, and ours is what exact fractions give; a
/// quantile between two draws is rounded more than once by both, and the exact one lies between them. Autocovariances are sums in
/// another order. Of mcse_mean `posterior` takes the variance between the means of the chains, whose own rounding shows where their
/// spread is small beside the value: hence the tolerance of the published comparisons.
double allowed(std::string const& column, double value) {
  if (column == "mcse_mean") return 1e-10 * std::fabs(value);
  if (column.starts_with("ess")) return 1e-13 * std::fabs(value);
  double const last_bit = std::nextafter(std::fabs(value), INFINITY) - std::fabs(value);
  return column == "sd" || column.starts_with("q") ? 2 * last_bit : last_bit;
}

void compare(json const& ours, std::map<std::string, std::vector<double>> const& theirs) {
  for (auto const& [name, summary] : ours.items()) {
    CAPTURE(name);
    REQUIRE(theirs.contains(stan_name(name)));
    std::vector<double> const& numbers = theirs.at(stan_name(name));
    REQUIRE(numbers.size() == columns.size());
    for (std::size_t k = 0; k < columns.size(); ++k) {
      CAPTURE(std::string(columns[k]));
      double const value = summary.at(columns[k]).get<double>();
      CAPTURE(value);
      CAPTURE(numbers[k]);
      CHECK(std::fabs(value - numbers[k]) <= allowed(columns[k], value));
    }
  }
}

}  // namespace

TEST_CASE("the R package posterior says of the draws what summary.json says") {
  if (!has_posterior()) {
    MESSAGE("skipped: R or its package posterior is not installed (r-base-core, r-cran-posterior)");
    return;
  }
  std::string const text = read_file(models / "two_experiments/two_experiments.sysid");
  ExportedRun const run(models / "two_experiments/two_experiments.sysid",
                        with(text, "samples = 20000, burn_in = 5000, thin = 10", "samples = 1500, burn_in = 500, thin = 1"));
  json const summary = run.summary("together");
  CHECK_FALSE(summary.contains("kept_draws"));
  compare(summary.at("parameters"), of_posterior(run.results() / "together"));
}

TEST_CASE("of thinned draws summary.json says what they tell themselves, beside what all iterations tell") {
  std::string const text = read_file(models / "regression/regression.sysid");
  ExportedRun const run(models / "regression/regression.sysid", text);
  json const summary = run.summary("posterior");
  REQUIRE(summary.contains("kept_draws"));
  CHECK(summary["kept_draws"]["a"]["mean"] != summary["parameters"]["a"]["mean"]);
  if (!has_posterior()) {
    MESSAGE("skipped: R or its package posterior is not installed (r-base-core, r-cran-posterior)");
    return;
  }
  compare(summary.at("kept_draws"), of_posterior(run.results() / "posterior"));
}
