// Weights of the members of an average against what a comparison says.
#include "app/average/member_weights.hpp"

#include <doctest/doctest.h>

#include "app/comparison/compared_evidence.hpp"
#include "core/text/diagnostic.hpp"
#include "relative.hpp"

using namespace sysid;

namespace {

ComparedFit fit(std::string const& name, double log_evidence, double error = 0.05) {
  ComparedFit out;
  out.name = name;
  out.model = "model_of_" + name;
  out.log_evidence = log_evidence;
  out.error = error;
  return out;
}

ComparedScore score(std::string const& name, double stacking, double pseudo_bma) {
  ComparedScore out{name, "model_of_" + name};
  out.stacking = stacking;
  out.pseudo_bma = pseudo_bma;
  return out;
}

Comparison compared(std::vector<ComparedFit> fits, std::vector<std::string> const& models) {
  Comparison comparison;
  comparison.fits = std::move(fits);
  weigh_models(models, comparison.fits);
  return comparison;
}

bool found(Findings const& findings, FindingCode code) {
  for (Finding const& each : findings)
    if (each.code == code) return true;
  return false;
}

std::string refusal(Comparison const& comparison, std::vector<std::string> const& fits, AverageWeights by) {
  try {
    weights_of(comparison, fits, by);
  } catch (UserError const& error) {
    return error.diagnostic().code + " " + error.diagnostic().message;
  }
  return "";
}

}  // namespace

TEST_CASE("weights by evidence are the probabilities of a comparison") {
  Comparison const comparison = compared({fit("a", -10), fit("b", -10 + std::log(3.0))}, {"1", "2"});
  MemberWeights const weighed = weights_of(comparison, {"a", "b"}, AverageWeights::evidence);
  REQUIRE(weighed.members.size() == 2);
  CHECK(weighed.members[0].weight == relative(0.25, 1e-12));
  CHECK(weighed.members[1].weight == doctest::Approx(0.75));
  CHECK(*weighed.members[0].error == relative(*comparison.fits[0].probability_error, 1e-12));
  CHECK(found(weighed.findings, FindingCode::averaged_over_models));
  CHECK_FALSE(found(weighed.findings, FindingCode::counted_once));
  CHECK_FALSE(found(weighed.findings, FindingCode::weights_not_confirmed));
}

TEST_CASE("a model that was fitted twice has the weight of one, with the fit whose evidence is known best") {
  Comparison const comparison = compared({fit("a", -10, 0.3), fit("again", -10, 0.1), fit("b", -10)}, {"1", "1", "2"});
  MemberWeights const weighed = weights_of(comparison, {"first", "again", "b"}, AverageWeights::evidence);
  CHECK(weighed.members[0].weight == 0);
  CHECK(weighed.members[0].counted == "again");
  CHECK(weighed.members[1].weight == doctest::Approx(0.5));
  CHECK(weighed.members[1].counted.empty());
  CHECK(weighed.members[2].weight == doctest::Approx(0.5));
  CHECK(found(weighed.findings, FindingCode::counted_once));
}

TEST_CASE("stacking and pseudo-BMA+ weights are found by the names of results, and scale to 1") {
  Comparison comparison = compared({fit("a", -10), fit("b", -12)}, {"1", "2"});
  comparison.scores.fits = {score("b", 0.6, 0.2), score("a", 0.3999999, 0.8)};
  MemberWeights const stacked = weights_of(comparison, {"first", "second"}, AverageWeights::stacking);
  CHECK(stacked.members[0].weight + stacked.members[1].weight == doctest::Approx(1).epsilon(1e-15));
  CHECK(stacked.members[1].weight == doctest::Approx(0.6));
  CHECK(weights_of(comparison, {"first", "second"}, AverageWeights::pseudo_bma).members[0].weight == doctest::Approx(0.8));
}

TEST_CASE("equal weights need no comparison") {
  MemberWeights const weighed = weights_of({}, {"a", "b", "c"}, AverageWeights::equal);
  for (AveragedMember const& member : weighed.members) CHECK(member.weight == doctest::Approx(1.0 / 3));
}

TEST_CASE("a fit without an evidence or without scores is refused by name, with its reason") {
  Comparison comparison = compared({fit("a", -10), fit("b", -12)}, {"1", "2"});
  comparison.fits[1].probability.reset();
  comparison.fits[1].without = "the prior of `k` is improper";
  CHECK(refusal(comparison, {"a", "b"}, AverageWeights::evidence) ==
        "E6704 `b` cannot be given a weight by evidence: the prior of `k` is improper");
  CHECK(refusal(comparison, {"a", "b"}, AverageWeights::stacking) ==
        "E6704 `a` cannot be given a weight by stacking: no two of the fits have predictive scores on the same samples");
  comparison.scores.fits = {score("a", 0.5, 0.5), score("c", 0.5, 0.5)};
  CHECK(refusal(comparison, {"a", "b"}, AverageWeights::pseudo_bma) ==
        "E6704 `b` cannot be given a weight by pseudo-BMA+: it has no predictive scores");
}

TEST_CASE("evidences that are not confirmed and unreliable scores are warned of") {
  Comparison comparison = compared({fit("a", -10), fit("b", -12)}, {"1", "2"});
  comparison.fits[0].not_confirmed = "two estimates differ";
  CHECK(found(weights_of(comparison, {"a", "b"}, AverageWeights::evidence).findings, FindingCode::weights_not_confirmed));
  comparison.scores.fits = {score("a", 0.5, 0.5), score("b", 0.5, 0.5)};
  CHECK_FALSE(found(weights_of(comparison, {"a", "b"}, AverageWeights::stacking).findings, FindingCode::weights_not_confirmed));
  comparison.scores.fits[1].doubtful = 3;
  CHECK(found(weights_of(comparison, {"a", "b"}, AverageWeights::stacking).findings, FindingCode::weights_not_confirmed));
}
