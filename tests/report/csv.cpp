// CSV files read back by the simplest reader there is.
#include "report/file/csv.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <sstream>

#include "example.hpp"

using namespace sysid;

namespace {

struct Table {
  std::vector<std::string> comments, header;
  std::vector<std::vector<std::string>> rows;
};

std::vector<std::string> split(std::string const& line) {
  std::vector<std::string> out;
  std::stringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) out.push_back(cell);
  return out;
}

Table read(std::string const& text) {
  Table out;
  std::stringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with('#')) {
      REQUIRE(out.header.empty());  // comments stand in the head alone
      out.comments.push_back(line);
    } else if (out.header.empty()) {
      out.header = split(line);
    } else {
      out.rows.push_back(split(line));
      REQUIRE(out.rows.back().size() == out.header.size());
    }
  }
  return out;
}

}  // namespace

TEST_CASE("draws are written as Stan does, under the user's names, and read back exactly") {
  Report const report = example::duffing(50);
  Table const table = read(draws_csv(report, 2));
  CHECK(table.header ==
        std::vector<std::string>{"lp__", "accept_stat__", "log_prior__", "log_likelihood__", "m", "c", "k", "k3", "beta"});
  REQUIRE(table.rows.size() == 50);
  Chain const& chain = report.draws.chains[2];
  for (std::size_t d = 0; d < 50; ++d) {
    CHECK(std::stod(table.rows[d][0]) == chain.log_density[d]);
    CHECK(std::stod(table.rows[d][2]) == chain.log_prior[d]);
    for (std::size_t p = 0; p < 5; ++p) CHECK(std::stod(table.rows[d][4 + p]) == chain.values[d][p]);
  }
}

TEST_CASE("the head of the draws says what made them") {
  std::string const text = draws_csv(example::duffing(5), 0);
  for (char const* line : {"# program = sysid\n", "# sysid_version = 0.1.0\n", "# model = duffing\n", "# seed = 1\n", "# id = 1\n",
                           "# num_samples = 5\n", "# setting target = 0.234\n", "# units = m [kg], c [N s/m]"})
    CHECK_MESSAGE(text.find(line) != std::string::npos, line);
  CHECK(text.find("sha256 9f86d081884c7d65") != std::string::npos);
}

TEST_CASE("NaN has one spelling in the draws") {
  Report report = example::duffing(5);
  report.draws.chains[0].values[1][0] = -std::nan("");
  report.draws.chains[0].acceptance.clear();  // not recorded
  Table const table = read(draws_csv(report, 0));
  CHECK(table.rows[1][4] == "NaN");
  CHECK(table.rows[1][1] == "NaN");
}

TEST_CASE("a line break in a task's text cannot end the comment") {
  Report report = example::duffing(5);
  report.what = "fit\n1,2,3";
  CHECK(read(draws_csv(report, 0)).header[0] == "lp__");
}

TEST_CASE("a name with a comma is quoted where Stan has no other name for it") {
  Report report = example::duffing(2);
  report.draws.names[0] = "m[1, 2]";
  CHECK(draws_csv(report, 0).find(",m.1.2,c,") != std::string::npos);
  CHECK(csv_field("m[1, 2]") == "\"m[1, 2]\"");
}

TEST_CASE("a prediction has bands with and without noise, what was measured, and which rows are scored") {
  Report report = example::duffing(20);
  report.predictions[0].scored[3] = 0;
  report.predictions[0].quantities[0].measured[4] = std::nan("");
  Table const table = read(predict_csv(report, report.predictions[0]));
  CHECK(table.header == std::vector<std::string>{"t", "displacement_mean", "displacement_sd", "displacement_q2.5",
                                                 "displacement_q97.5", "displacement_noisy_mean", "displacement_noisy_sd",
                                                 "displacement_noisy_q2.5", "displacement_noisy_q97.5", "displacement_measured",
                                                 "y'_mean", "y'_sd", "y'_q2.5", "y'_q97.5", "scored"});
  REQUIRE(table.rows.size() == 500);
  CHECK(table.rows[3].back() == "0");
  CHECK(table.rows[4].back() == "1");
  CHECK(table.rows[4][9] == "NaN");
  CHECK(std::stod(table.rows[7][0]) == report.predictions[0].time[7]);
  CHECK(std::stod(table.rows[7][3]) == report.predictions[0].quantities[0].response.lower[7]);
}

TEST_CASE("elements and parts go by Stan's names in draws") {
  CHECK(stan_name("sigma") == "sigma");
  CHECK(stan_name("k[2]") == "k.2");
  CHECK(stan_name("M[1, 2]") == "M.1.2");
  CHECK(stan_name("rig.joint.k[3]") == "rig:joint:k.3");
}
