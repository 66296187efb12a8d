// The page for stdout.
#include "report/page/terminal.hpp"

#include <doctest/doctest.h>

#include "example.hpp"
#include "report/page/html_parts.hpp"

using namespace sysid;

TEST_CASE("the terminal shows aligned columns under the user's names, failures and the verdict") {
  Report report = example::duffing(20);
  report.summary = {{"m", "kg", 1.00045, 1, 0.00063, 0.0006, 0.9994, 1.0015, 1.001, 734, 890, 2.3e-5},
                    {"k3", "N/m^3", 4.986e9, 4.98e9, 3.27e7, 3e7, 4.932e9, 5.04e9, 1.002, 701.4, 650, 1.2e6}};
  report.predictions.clear();
  report.findings = {{FindingCode::second_mode, Severity::warning, {}, "a second mode holds 2 %", "look at the starts"}};
  CHECK(terminal_summary(report) ==
        "posterior: fit duffing to bench.train with mh\n"
        "4 chains of 20 draws, seed 1\n"
        "\n"
        "    unit      mean       sd       q5      q95   rhat  ess_bulk  ess_tail\n"
        "m   kg     1.00045  0.00063  0.99940  1.00150  1.001       734       890\n"
        "k3  N/m^3  4.986e9  0.033e9  4.932e9  5.040e9  1.002       701       650\n"
        "\n"
        "displacement on bench.train: nmse 0.01040 [%], chi_squared_per_sample 1.010\n"
        "100000 simulations, 3 failed\n"
        "  3 x non-finite: k3*y^3 at duffing.sysid:12 (first at t = 0.01250 s)\n"
        "\n"
        "verdict: use with care: 1 warning\n"
        "  warning[second_mode]: a second mode holds 2 %\n"
        "    what to do: look at the starts\n"
        "  more: sysid explain second_mode\n");
}

TEST_CASE("a simulation of rows that no time orders fails at no time") {
  Report report = example::duffing(20);
  CHECK(terminal_summary(report).find("3 x non-finite: k3*y^3 at duffing.sysid:12 (first at t = ") != std::string::npos);
  CHECK(simulations_html(report).find("first at t [") != std::string::npos);
  for (Prediction& each : report.predictions) each.rows = true;
  CHECK(terminal_summary(report).find("3 x non-finite: k3*y^3 at duffing.sysid:12\n") != std::string::npos);
  CHECK(simulations_html(report).find("first at t") == std::string::npos);
}

TEST_CASE("each channel of each experiment has one line of scores, with the unit of its rmse and each score once") {
  Report report = example::duffing(20);
  std::string const one = terminal_summary(report);
  CHECK(one.find("all channels") == std::string::npos);
  CHECK(one.find("displacement on bench.train: nmse 0.01040 [%], chi_squared_per_sample 1.010, rmse 0.0") != std::string::npos);
  CHECK(one.find(" [mm], coverage_95") != std::string::npos);
  report.predictions[0].quantities.push_back(report.predictions[0].quantities[0]);
  report.predictions[0].quantities.back().name = "force";
  std::string const two = terminal_summary(report);
  CHECK(two.find("\ndisplacement on bench.train: nmse 0.01040 [%], chi_squared_per_sample 1.010, rmse 0.0") != std::string::npos);
  CHECK(two.find("\nforce on bench.train: nmse") != std::string::npos);
  report.predictions.push_back(report.predictions[0]);
  report.predictions.back().experiment = "hall";
  std::string const four = terminal_summary(report);
  CHECK(four.find("\ndisplacement on hall: nmse") != std::string::npos);
  CHECK(four.find("all channels") == std::string::npos);
}

TEST_CASE("a task without draws or findings has no verdict") {
  Report report;
  report.task = "truth";
  report.what = "simulate duffing";
  report.seed = 3;
  CHECK(terminal_summary(report) == "truth: simulate duffing\nseed 3\n");
}

TEST_CASE("further tables stand under their titles") {
  Report report;
  report.task = "selection";
  report.tables = {{"models", "", {"model", "probability"}, {{"linear", "0.00"}, {"bouc_wen(n = 2)", "0.97"}}}};
  CHECK(terminal_summary(report).find(
            "\nmodels\nmodel            probability\nlinear                  0.00\nbouc_wen(n = 2)         0.97\n") !=
        std::string::npos);
}
