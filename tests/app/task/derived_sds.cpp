// Standard deviations of derived quantities at an optimum: against closed forms of a linear model, against draws, and where there
// are none.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/running.hpp"
#include "relative.hpp"

using namespace sysid;
using nlohmann::json;

namespace {

// A line with noise of known size, y = a + b x: its posterior is normal, with the inverse covariance X'X/s^2 + 1/prior variance.
struct Line {
  static constexpr int rows = 40;
  static constexpr double noise = 0.5, prior = 100;
  double aa = 1 / (prior * prior), ab = 0, bb = 1 / (prior * prior);  // of the inverse covariance
  double va = 0, vb = 0, cab = 0;                                     // of the covariance
  std::string csv = "x,y\n";

  Line() {
    for (int i = 0; i < rows; ++i) {
      double const x = 0.1 * i, y = 3 + 2 * x + 0.4 * std::sin(37.0 * i);
      csv += fmt::format("{},{}\n", x, y);
      aa += 1 / (noise * noise), ab += x / (noise * noise), bb += x * x / (noise * noise);
    }
    double const determinant = aa * bb - ab * ab;
    va = bb / determinant, vb = aa / determinant, cab = -ab / determinant;
  }
  /// sqrt(g' C g).
  double sd(double by_a, double by_b) const { return std::sqrt(by_a * by_a * va + 2 * by_a * by_b * cab + by_b * by_b * vb); }
};

std::string line_text(std::string const& more, std::string const& backend = "map") {
  return R"(model line {
  input x [-]
  parameter a ~ normal(0, sd = 100)
  parameter b ~ normal(0, sd = 100)
)" + more +
         R"(  observe y ~ normal(a + b*x, sd = 0.5)
}
data record { file "line.csv"; input x = x; measure y = y }
best = fit line to record with )" +
         backend + ", seed = 1\n";
}

json fitted(std::string const& text, Line const& line) {
  return CaseRun(text, {{"line.csv", line.csv}}).summary("best").at("parameters");
}

double number(json const& parameters, std::string const& name, std::string const& what) {
  return parameters.at(name).at(what).get<double>();
}

}  // namespace

TEST_CASE("derived quantities of an optimum have the sds of the delta method") {
  Line const line;
  json const found = fitted(line_text("  derive ratio = a/b\n  derive product = a*b\n  derive sum = a + 2*b\n"), line);
  double const a = number(found, "a", "mean"), b = number(found, "b", "mean");
  CHECK(number(found, "a", "sd") == relative(std::sqrt(line.va), 1e-5));
  CHECK(number(found, "ratio", "sd") == relative(line.sd(1 / b, -a / (b * b)), 1e-4));
  CHECK(number(found, "product", "sd") == relative(line.sd(b, a), 1e-4));
  CHECK(number(found, "sum", "sd") == relative(line.sd(1, 2), 1e-4));
  CHECK(found.at("ratio").at("sd_by") == "delta_method");
  CHECK(found.at("a").at("sd_by") == "laplace");
  CHECK_FALSE(found.at("ratio").contains("without_sd"));
}

TEST_CASE("a derived quantity without a declared unit is shown in the unit that its formula has") {
  json const found =
      fitted(line_text("  parameter k [N/m] ~ normal(1, sd = 0.1)\n  derive square = k^2\n  derive share = k/(k + k)\n"
                       "  derive ratio = a/b\n"),
             Line());
  CHECK(found.at("square").at("unit") == "kg^2/s^4");
  CHECK(found.at("share").at("unit") == "");
  CHECK(found.at("ratio").at("unit") == "");
}

TEST_CASE("a derived quantity without a derivative at the optimum, or far from a line there, has no sd and says why") {
  Line const line;
  json const first = fitted(line_text(""), line);
  double const a = number(first, "a", "mean"), sd = number(first, "a", "sd");
  std::string const at = fmt::format("{:.17g}", a);
  json const found = fitted(line_text(fmt::format("  derive bent = abs(a - {0})\n  derive corner = a + max(0, 3*(a - {0}))\n"
                                                  "  derive square = (a - {0})^2\n  derive root = sqrt(a - {1:.17g})\n",
                                                  at, a - sd)),
                            line);
  for (char const* name : {"bent", "corner", "square", "root"}) {
    CAPTURE(name);
    CHECK(found.at(name).at("sd").is_null());
    CHECK_FALSE(found.at(name).contains("sd_by"));
    CHECK(found.at(name).at("without_sd").get<std::string>().size() > 10);
  }
  CHECK(found.at("corner").at("without_sd") == "it has no derivative at the optimum");
  CHECK(found.at("square").at("without_sd") == "it is too far from linear in the parameters within their sds");
}

TEST_CASE("the sd of what the data leave open is not stated, of what they determine beside it is") {
  Line const line;
  // Only p + q is determined, and `ml` has no prior for the rest.
  std::string const text = R"(model line {
  input x [-]
  parameter p ~ normal(0, sd = 10)
  parameter q ~ normal(0, sd = 10)
  derive slope = p + q
  derive other = p - q
  observe y ~ normal(3 + (p + q)*x, sd = 0.5)
}
data record { file "line.csv"; input x = x; measure y = y }
best = fit line to record with ml, seed = 1
)";
  json const found = fitted(text, line);
  double sum = 0;
  for (int i = 0; i < Line::rows; ++i) sum += 0.01 * i * i;
  CHECK(number(found, "slope", "sd") == relative(Line::noise / std::sqrt(sum), 0.01));
  CHECK(found.at("other").at("sd").is_null());
  CHECK(found.at("other").at("without_sd") == "it changes along a combination of parameters that the data do not determine");
}

TEST_CASE("of Duffing's oscillator the delta method gives the sd of draws, on the page and in the terminal") {
  std::filesystem::path const path = std::filesystem::path(SYSID_SOURCE_DIR) / "models/duffing/duffing.sysid";
  std::string const text = read_file(path);
  TemporaryFolder folder;
  auto const sd_by = [&](std::string const& backend) {
    RunOptions options;
    options.output = folder.path() / backend.substr(0, 2);
    RunResult const run = run_text(
        path, with(text, "with mh(samples = 25000, burn_in = 5000, thin = 10, chains = 4)", "with " + backend), options, {"fit"});
    if (backend == "ml") {
      CHECK(run.out.find("log likelihood 5573.72 at its maximum (5 parameters, 500 samples)") != std::string::npos);
      std::string const page = read_file(options.output / "posterior/report.html");
      CHECK(page.find("log likelihood 5573.72 at its maximum") != std::string::npos);
      CHECK(page.find("the delta method") != std::string::npos);
    }
    return number(json::parse(read_file(options.output / "posterior/summary.json")).at("parameters"), "fn", "sd");
  };
  double const by_draws = sd_by("mh(samples = 5000, burn_in = 1000, chains = 4)");
  // About 1500 independent draws: their sd is known to 2 %.
  CHECK(sd_by("map") == relative(by_draws, 0.06));
  CHECK(sd_by("ml") == relative(by_draws, 0.06));
}
