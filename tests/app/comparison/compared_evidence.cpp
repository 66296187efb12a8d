// Odds of models with errors, and the widths of priors, on numbers worked out by hand.
#include "app/comparison/compared_evidence.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "relative.hpp"

using namespace sysid;
using json = nlohmann::json;

namespace {

ComparedFit fit(std::string name, double log_evidence, std::optional<double> error) {
  ComparedFit result;
  result.name = std::move(name);
  result.log_evidence = log_evidence;
  result.error = error;
  return result;
}

json widths(std::string const& name, double half, json twice) {
  json evidence;
  evidence["prior_widths"]["factors"] = {0.5, 2};
  evidence["prior_widths"]["parameters"][name]["change"] = {json(half), std::move(twice)};
  return evidence;
}

}  // namespace

TEST_CASE("errors of evidences are carried through to probabilities and Bayes factors") {
  std::vector<ComparedFit> fits = {fit("cubic", 10, 0.1), fit("linear", 8, 0.2), fit("again", 9.9, 0.3), fit("none", 0, 0)};
  fits[3].log_evidence.reset();
  weigh_models({"a", "b", "a", "c"}, fits);
  double const p = 1 / (1 + std::exp(-2.0));
  CHECK(*fits[0].probability == doctest::Approx(p));
  CHECK(*fits[2].probability == *fits[0].probability);  // of one model, which counts once
  CHECK(*fits[0].probability + *fits[1].probability == doctest::Approx(1));
  // Of two models dP = P (1 - P) d(log Z - log Z').
  CHECK(*fits[0].probability_error == relative(p * (1 - p) * std::hypot(0.1, 0.2), 1e-12));
  CHECK(*fits[1].probability_error == relative(p * (1 - p) * std::hypot(0.1, 0.2), 1e-12));
  CHECK(*fits[1].log_bayes_factor == doctest::Approx(-2));
  CHECK(*fits[1].bayes_factor_error == relative(std::hypot(0.1, 0.2), 1e-12));
  CHECK(fits[1].strength == "positive");
  CHECK(fits[0].strength.empty());
  CHECK(*fits[0].log_bayes_factor == 0);
  CHECK_FALSE(fits[3].probability);
  CHECK_FALSE(fits[3].log_bayes_factor);
  std::vector<ComparedFit> alone = {fit("proper", 10, 0.1), fit("improper", 0, 0)};
  alone[1].log_evidence.reset();
  weigh_models({"a", "b"}, alone);
  CHECK_FALSE(alone[0].probability);
  CHECK_FALSE(alone[0].log_bayes_factor);
  // Of several fits of one model the best known evidence counts, in any order.
  ComparedFit unsure = fit("unsure", 12, 0.01);
  unsure.not_confirmed = "its error is 0.50, above 0.3";
  for (bool const first : {true, false}) {
    std::vector<ComparedFit> twice = {fit("cubic", 10, 0.1), unsure, fit("linear", 11, 0.1)};
    if (first) std::swap(twice[0], twice[1]);
    std::vector<std::string> const models = {"a", "a", "b"};
    weigh_models(models, twice);
    CHECK(*twice[0].log_bayes_factor == doctest::Approx(-1));
    CHECK(*twice[1].log_bayes_factor == doctest::Approx(-1));
    REQUIRE(disagreements(models, twice).size() == 1);
    CHECK(disagreements(models, twice)[0] ==
          "unsure and cubic are fits of one model, but their evidences differ by 2.0: that of cubic is used");
  }
  // One error that is not known leaves the others unknown.
  std::vector<ComparedFit> of_map = {fit("cubic", 10, 0.1), fit("linear", 8, {})};
  weigh_models({"a", "b"}, of_map);
  CHECK(*of_map[0].probability == doctest::Approx(p));
  CHECK_FALSE(of_map[0].probability_error);
  CHECK_FALSE(of_map[1].bayes_factor_error);
}

TEST_CASE("the strength of a Bayes factor is in the words of Kass and Raftery, at 3, 20 and 150 to one") {
  CHECK(evidence_strength(-0.9) == "hardly any");
  CHECK(evidence_strength(2.9) == "positive");
  CHECK(evidence_strength(-4.9) == "strong");
  CHECK(evidence_strength(-5.1) == "very strong");
}

TEST_CASE("a Bayes factor is given over half and twice the widths of the priors of both models") {
  std::vector<ComparedFit> fits = {fit("cubic", 10, 0), fit("linear", 8, 0)};
  auto const notes = prior_width_notes({"a", "b"}, fits, {widths("k3", 0.6, -0.7), widths("k", 0.3, -0.4)});
  REQUIRE(notes.size() == 1);
  CHECK(notes[0] ==
        "linear against cubic: the log Bayes factor lies between -2.6 and -1.3 if one prior or all priors are "
        "half or twice as wide; the prior of `k3` changes it most");
  // A prior that both have is widened in both.
  auto const shared = prior_width_notes({"a", "b"}, fits, {widths("k", 0.6, -0.7), widths("k", 0.6, -0.7)});
  CHECK(shared[0] == "linear against cubic: the log Bayes factor stays -2.0 if one prior or all priors are half or twice as wide");
  auto const unknown = prior_width_notes({"a", "b"}, fits, {widths("k", 0.6, nullptr), widths("k", 0.6, -0.7)});
  CHECK(unknown[0] == "linear against cubic: the draws do not show how the log Bayes factor depends on the prior of `k`");
  // Half of what a prior does is in no range.
  json half = widths("k", 9, nullptr);
  half["prior_widths"]["parameters"]["k3"]["change"] = {0.1, -0.1};
  half["prior_widths"]["all"]["change"] = {json(nullptr), json(nullptr)};
  auto const partly = prior_width_notes({"a", "b"}, fits, {half, widths("k", 0.3, -0.4)});
  CHECK(partly[0].find("between -2.1 and -1.9 if one prior is half or twice as wide") != std::string::npos);
  CHECK(partly[0].find("this does not include the prior of `k`, whose effect the draws do not show") != std::string::npos);
  fits[1].log_evidence = -30;
  CHECK(prior_width_notes({"a", "b"}, fits, {widths("k3", 0.6, -0.7), widths("k", 0.3, -0.4)}).empty());
  CHECK(prior_width_notes({"a", "a"}, fits, {widths("k3", 0.6, -0.7), widths("k", 0.3, -0.4)}).empty());
}
