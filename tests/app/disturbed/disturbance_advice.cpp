// When a higher evidence is no reason to prefer a disturbance.
#include "app/disturbed/disturbance_advice.hpp"

#include <doctest/doctest.h>

using namespace sysid;

namespace {

constexpr auto size_of_evidence = "log Bayes factor +22.2";

Findings warning_of(FindingCode code) { return {{code, Severity::warning, {}, "what was found", ""}}; }

std::string advised(FoundByBoth const& found, ExplainedShares const& shares = {0.98, 0.97}) {
  return advice_on_disturbance(size_of_evidence, found, shares);
}

bool says(std::string const& text, std::string const& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("a disturbance is preferred where nothing else explains the residuals") {
  CHECK(advised({}) == "the record prefers the model with the disturbance: log Bayes factor +22.2\n");
  CHECK(says(advised({warning_of(FindingCode::residuals_not_white), {}}), "the record prefers"));
  CHECK(says(advised({}, {std::nullopt, std::nullopt}), "the record prefers"));
}

TEST_CASE("a disturbance is not preferred where it may stand in for a fault of the record") {
  for (FindingCode const code : {FindingCode::sensor_stuck, FindingCode::time_gap, FindingCode::looks_missing}) {
    std::string const said = advised({warning_of(code), {}});
    INFO(said);
    CHECK_FALSE(says(said, "prefers"));
    CHECK(says(said, "`" + std::string(word(code)) + "`"));
    CHECK(says(said, size_of_evidence));
  }
  for (FindingCode const code : {FindingCode::input_timing, FindingCode::input_rule, FindingCode::residual_offset})
    CHECK_FALSE(says(advised({warning_of(code), warning_of(code)}), "prefers"));
}

TEST_CASE("a delay that is found without the disturbance alone is mentioned beside the preference") {
  std::string const said = advised({warning_of(FindingCode::input_timing), {}});
  CHECK(says(said, "the record prefers the model with the disturbance: log Bayes factor +22.2; "));
  CHECK(says(said, "`input_timing`"));
}

TEST_CASE("a disturbance that takes the place of the measured force is not preferred") {
  // The clock of a channel that is 1 % off: mass and stiffness grow to 4.7 times their values.
  std::string const said = advised({}, {0.80, 0.28});
  CHECK_FALSE(says(said, "prefers"));
  CHECK(says(said, "explain 28 % of the variance"));
  CHECK(says(said, "80 % with those of the fit without it"));
  CHECK(says(advised({}, {0.80, 0.70}), "prefers"));
  CHECK(says(advised({}, {0.05, 0.001}), "prefers"));  // moved by the disturbance nearly alone
}

TEST_CASE("a disturbance that follows the states names the missing term") {
  std::string const said = advised({{}, warning_of(FindingCode::disturbance_follows_states)});
  CHECK(says(said, "the disturbance stands in for a missing term (log Bayes factor +22.2)"));
  CHECK(says(said, "what was found"));
}
