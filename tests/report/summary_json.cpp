// summary.json: complete, strict and the same twice.
#include "report/file/summary_json.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "example.hpp"

using namespace sysid;

TEST_CASE("the summary holds each parameter with unit and diagnostics, exactly") {
  Report const report = example::duffing(50);
  auto const json = nlohmann::json::parse(summary_json(report));
  CHECK(json["parameters"].size() == 5);
  auto const& k3 = json["parameters"]["k3"];
  CHECK(k3["unit"] == "N/m^3");
  CHECK(k3["mean"] == report.summary[3].mean);
  CHECK(k3["mcse_mean"] == report.summary[3].mcse_mean);
  for (char const* key : {"median", "sd", "mad", "q5", "q95", "rhat", "ess_bulk", "ess_tail"}) CHECK_MESSAGE(k3.contains(key), key);
  CHECK(json["verb"] == "fit");
  CHECK(json["prediction_rule"] == "");
  CHECK(json["measured_past"] == false);
  CHECK(json["lags"] == 0);
  CHECK(json["seed"] == 1);
  CHECK(json["settings"]["samples"] == 25000);
  CHECK(json["settings"]["proposal"] == "adaptive");
  CHECK(json["data"][0]["file"] == "duffing.csv");
  CHECK(json["data"][0]["rows"] == 1500);
  CHECK(json["data"][0]["scored_rows"] == "1..500");
  CHECK(json["fit"]["nmse"] == 0.0104);
  CHECK(json["fit"]["channels"]["bench.train"]["displacement"].contains("coverage_95"));
  CHECK(json["fit"]["channels"]["bench.train"]["displacement"]["chi_squared_per_sample"] == 1.01);
  CHECK(json["modes"][0]["values"]["k"] == 1e4);
  CHECK(json["ledger"]["failed"] == 3);
  CHECK(json["ledger"]["failures"][0]["example"]["m"] == 1);
  CHECK(json["verdict"]["pass"] == true);
  CHECK(json["findings"][0]["severity"] == "note");
}

TEST_CASE("values of modes and of failures have the names of what was sampled, whatever else has draws") {
  Report report = example::duffing(20);
  report.sampled_names = {"c", "k", "k3", "beta"};  // m is integrated out
  report.modes[0].declared = {20, 1e4, 5e9, 1e7};
  report.modes[0].sd = {0.1, 1, 1e6, 1e4};
  report.ledger = {};
  report.ledger.add_failure(FailureClass::non_finite, "k3*y^3 at duffing.sysid:12", 0.0125, {20, 1e4, 5e9, 1e7}, 3);
  auto const json = nlohmann::json::parse(summary_json(report));
  CHECK(json["modes"][0]["values"] == nlohmann::json{{"c", 20}, {"k", 1e4}, {"k3", 5e9}, {"beta", 1e7}});
  CHECK(json["modes"][0]["sd"] == nlohmann::json{{"c", 0.1}, {"k", 1}, {"k3", 1e6}, {"beta", 1e4}});
  CHECK(json["ledger"]["failures"][0]["example"]["c"] == 20);
}

TEST_CASE("a failed diagnostic fails the verdict") {
  Report report = example::duffing(20);
  report.findings.push_back({FindingCode::chains_disagree, Severity::error, {}, "the chains disagree on m", "run longer"});
  auto const json = nlohmann::json::parse(summary_json(report));
  CHECK(json["verdict"]["pass"] == false);
}

TEST_CASE("what is not finite is null: the file is strict JSON") {
  Report report = example::duffing(20);
  report.summary[0].rhat = std::nan("");
  report.fit[0].scores[0].value = INFINITY;
  std::string const text = summary_json(report);
  auto const json = nlohmann::json::parse(text);
  CHECK(json["parameters"]["m"]["rhat"].is_null());
  CHECK(json["fit"]["nmse"].is_null());
}

TEST_CASE("the same report gives the same bytes, and times do not enter them") {
  Report report = example::duffing(20);
  std::string const text = summary_json(report);
  report.timing = {{"wall_s", 99.0}};
  CHECK(summary_json(report) == text);
  CHECK(text.find("wall_s") == std::string::npos);
  CHECK(nlohmann::json::parse(timing_json(report))["wall_s"] == 99.0);
}

TEST_CASE("parameters keep the user's order") {
  std::string const text = summary_json(example::duffing(20));
  std::size_t last = text.find("\"parameters\"");
  for (char const* name : {"\"m\": {", "\"c\": {", "\"k\": {", "\"k3\": {", "\"beta\": {"}) {
    std::size_t const at = text.find(name, last);
    REQUIRE(at != std::string::npos);
    last = at;
  }
}
