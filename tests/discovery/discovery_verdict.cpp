// What a discovery comes to, from reports written by hand.
#include "discovery/discovery_verdict.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "discovery/validation_findings.hpp"

using namespace sysid;

namespace {

ValidatedCoefficient coefficient(std::string term, double value, double sd) {
  ValidatedCoefficient out;
  out.target = "x'";
  out.term = std::move(term);
  out.value = value;
  out.sd = sd;
  return out;
}

ValidatedStructure structure(std::string terms, double probability) {
  ValidatedStructure out;
  out.terms = std::move(terms);
  out.probability = probability;
  out.residual_over_noise = 1.02;
  out.coefficients = {coefficient("x", 2, 0.01), coefficient("x^2", -1, 0.02)};
  return out;
}

ValidationReport report(double probability, std::optional<double> free_run = 0.05, std::optional<double> far = 0.02) {
  ValidationReport out;
  out.structures = {structure("x, x^2", probability), structure("x, x^3", (1 - probability) * 0.9)};
  ValidatedChannel channel;
  channel.channel = "x";
  channel.sd = 1;
  channel.residual = channel.noise = 0.02;
  channel.horizon = far;
  channel.free_run = free_run;
  out.structures.front().channels = {channel};
  out.structures.front().follows = 3;
  out.held_out = "the last fifth of record";
  out.whole = true;
  return out;
}

Finding finding(FindingCode code, std::vector<std::string> names, Severity severity = Severity::warning) {
  return {code, severity, std::move(names), "x': a sentence", "a help"};
}

/// terms: of the concern; kept: those of the leading structure.
Severity tempered(ValidationReport const& validation, Finding each, std::vector<int> terms = {},
                  std::vector<int> const& kept = {}) {
  regression::Concern concern;
  concern.terms = std::move(terms);
  temper_by_form(validation, concern, kept, each);
  return each.severity;
}

}  // namespace

TEST_CASE("the verdict has a clause each for the form, the coefficients and other rows") {
  CHECK(verdict_clauses(report(0.98)) ==
        "the form is decided among the terms of the dictionary (probability 0.980), the coefficients have sds of 0.50 to 2.0 %, "
        "the equation holds on the last fifth "
        "of record "
        "(rms error of a free run: 2.5 times the noise)");
  CHECK(verdict_clauses(report(0.98, 0.3))
            .ends_with("the equation holds on the last fifth of record (rms error of a free run: 30 % of the sd)"));
  CHECK(verdict_clauses(report(0.85))
            .starts_with("the form is more probable than all others among the terms of the dictionary (probability 0.850), "));
  CHECK(
      verdict_clauses(report(0.6)).starts_with("the form is not decided, but more probable than all others (probability 0.600), "));
  CHECK(verdict_clauses(report(0.4)).starts_with("the form is not decided (probability 0.400), "));
  CHECK(verdict_clauses(report(0.98, 1.4, 1.2))
            .ends_with("the equation fails on the last fifth of record (rms error of a free run: 140 % of the sd)"));
  CHECK(verdict_clauses(report(0.98, 1.4, 0.1))
            .ends_with("on the last fifth of record the equation predicts no more than 3.0 s ahead"));
  CHECK(verdict_clauses(report(0.98, std::nullopt)).ends_with("not tested on other rows"));
  ValidationReport failed = report(0.98);
  failed.structures.front().failure = "it does not converge";
  CHECK(verdict_clauses(failed).empty());
}

TEST_CASE("a free run that is off by no more than noise holds, even where the motion has come to rest") {
  ValidationReport validation = report(0.98, 0.021, 0.021);
  validation.structures.front().channels.front().sd = 0.02;
  CHECK(free_run_of(validation) == FreeRun::follows);
  validation.structures.front().channels.front().free_run = 0.07;
  CHECK(free_run_of(validation) == FreeRun::lost);
}

TEST_CASE("a form that is not decided is one warning with the structures that share the probability") {
  CHECK(undecided_form(report(0.81)).empty());
  CHECK(undecided_form(report(0.79)).size() == 1);
  Findings const undecided = undecided_form(report(0.4));
  REQUIRE(undecided.size() == 1);
  CHECK(undecided.front().code == FindingCode::form_undecided);
  CHECK(undecided.front().names == std::vector<std::string>{"x, x^2", "x, x^3"});
  CHECK(undecided.front().help.find("from first, second") != std::string::npos);
}

TEST_CASE("sets of terms that share the probability of a regression are one warning, where none is simulated") {
  DiscoveredEquation equation;
  regression::FoundEquation chosen;
  equation.target = "y";
  chosen.chosen.terms = {0, 1};
  CHECK(undecided_terms(chosen, equation).empty());  // a selector without probabilities
  equation.supports = {{{"lag(y, 1)", "lag(u, 1)"}, 0.5}, {{"lag(y, 1)", "lag(u, 1)", "lag(u, 1)^2"}, 0.4}, {{"lag(y, 1)"}, 0.08}};
  chosen.supports.resize(3);
  chosen.supports[0].terms = {0, 1};
  chosen.supports[1].terms = {0, 1, 2};
  chosen.supports[2].terms = {0};
  Findings const found = undecided_terms(chosen, equation);
  REQUIRE(found.size() == 1);
  CHECK(found.front().code == FindingCode::form_undecided);
  CHECK(found.front().names.size() == 3);
  equation.supports.front().probability = 0.9;
  CHECK(undecided_terms(chosen, equation).empty());
  // What is kept is not the most probable.
  chosen.chosen.terms = {0, 1, 2};
  CHECK(undecided_terms(chosen, equation).size() == 1);
}

TEST_CASE("a term that others make up is a note, unless all of these are in the equation") {
  auto const severity = [&](std::vector<int> terms) {
    regression::Concern concern{.kind = regression::Concern::Kind::collinear, .terms = std::move(terms)};
    Finding each = finding(FindingCode::terms_collinear, {});
    temper_by_terms(concern, {0}, each);
    return each.severity;
  };
  CHECK(severity({1, 0, 2}) == Severity::note);
  CHECK(severity({1, 0}) == Severity::warning);
}

TEST_CASE("other terms are a warning where the record is described as well by them, with their coefficients counted") {
  ValidationReport validation = report(0.98);
  CHECK(other_terms(validation).empty());
  // log odds, log likelihood, coefficients more; 300 samples: a coefficient costs 2.85
  validation.outside = OutsideEquation{"x': x, exp(-x)", 1.5, 0.7, 0, 300};
  Findings const rival = other_terms(validation);
  REQUIRE(rival.size() == 1);
  CHECK(rival.front().severity == Severity::warning);
  CHECK(rival.front().names == std::vector<std::string>{"x': x, exp(-x)"});
  CHECK(rival.front().message.find("(its log likelihood is 0.70 higher, with as many coefficients)") != std::string::npos);
  CHECK(verdict_clauses(validation).find("but the record does not exclude other terms") != std::string::npos);
  validation.outside->log_likelihood = -2.5;  // the prior favours it, the record does not
  Findings const usual = other_terms(validation);
  REQUIRE(usual.size() == 1);
  CHECK(usual.front().severity == Severity::note);
  CHECK(verdict_clauses(validation).starts_with("the form is decided among the terms of the dictionary (probability 0.980)"));
  validation.outside->coefficients = -1;
  CHECK(other_terms(validation).front().severity == Severity::warning);
  CHECK(other_terms(validation).front().message.find("2.5 lower, with 1 coefficient fewer") != std::string::npos);
  validation.outside->coefficients = 2;
  validation.outside->log_likelihood = 4.5;
  CHECK(other_terms(validation).front().severity == Severity::note);
  validation.outside->log_odds = -0.1;
  CHECK(other_terms(validation).empty());
}

TEST_CASE("what the regression cannot tell apart is a note where simulation compares the structures") {
  Finding const alike = finding(FindingCode::terms_interchangeable, {"x^2", "x^3"});
  CHECK(tempered(report(0.99), alike) == Severity::note);
  CHECK(tempered(report(0.3), alike) == Severity::note);  // `form_undecided` warns
  ValidationReport failed = report(0.99);
  failed.structures.front().failure = "it does not converge";
  CHECK(tempered(failed, alike) == Severity::warning);
  Finding const correlated = finding(FindingCode::residual_correlated, {});
  CHECK(tempered(report(0.99), correlated) == Severity::note);
  CHECK(tempered(report(0.3), correlated) == Severity::warning);
}

TEST_CASE("a term left out as a combination of others warns where it makes another equation of as many terms") {
  // Terms x, x^2, x^3, sin(x), of which the first two are in the leading structure.
  Finding const collinear = finding(FindingCode::terms_collinear, {"sin(x)", "x"});
  CHECK(tempered(report(0.99), collinear, {3, 0, 1}, {0, 1}) == Severity::warning);
  CHECK(tempered(report(0.99), collinear, {3, 0}, {0, 1}) == Severity::warning);
  CHECK(tempered(report(0.99), collinear, {3, 0, 2}, {0, 1}) == Severity::note);
  CHECK(tempered(report(0.99), collinear, {0, 2, 3}, {0, 1}) == Severity::note);
  CHECK(tempered(report(0.99), collinear, {3, 0}, {}) == Severity::note);
}

TEST_CASE("findings of one code are one, with all names") {
  Findings const all = {finding(FindingCode::terms_collinear, {"a", "b"}), finding(FindingCode::term_idle, {"c"}),
                        finding(FindingCode::terms_collinear, {"b", "d"}), finding(FindingCode::terms_collinear, {"e"}),
                        finding(FindingCode::terms_collinear, {"f"}, Severity::note)};
  Findings const fewer = merged(all);
  REQUIRE(fewer.size() == 3);
  CHECK(fewer[0].names == std::vector<std::string>{"a", "b", "d", "e"});
  CHECK(fewer[0].message == "x': a sentence; and 2 more like this, with `d` and `e`");
  CHECK(fewer[1].code == FindingCode::term_idle);
  CHECK(fewer[2].severity == Severity::note);
  CHECK(fewer[2].message == "x': a sentence");
}

TEST_CASE("another first structure of the regression is a note where simulation has settled the form") {
  ValidationReport validation = report(0.98);
  validation.structures[0].of_regression = 2;
  validation.structures[1].of_regression = 1;
  for (auto const& [probability, severity] : {std::pair(0.98, Severity::note), {0.4, Severity::warning}}) {
    validation.structures[0].probability = probability;
    Findings const findings = validation_findings(validation);
    auto const prefers = std::find_if(findings.begin(), findings.end(),
                                      [](Finding const& each) { return each.code == FindingCode::simulation_prefers; });
    REQUIRE(prefers != findings.end());
    CHECK(prefers->severity == severity);
  }
  for (ValidatedStructure& each : validation.structures) each.failure = "its fit does not converge";
  Findings const failed = validation_findings(validation);  // nothing was simulated, so simulation prefers nothing
  REQUIRE(failed.size() == 1);
  CHECK(failed.front().code == FindingCode::not_refitted);
}

TEST_CASE("a coefficient less than two sds from zero is called idle, but one of the target is not") {
  ValidationReport validation = report(0.99);
  auto const codes = [&] {
    std::vector<FindingCode> all;
    for (Finding const& each : validation_findings(validation)) all.push_back(each.code);
    return all;
  };
  for (ValidatedStructure& each : validation.structures) each.of_regression = 1;
  CHECK(codes().empty());
  std::vector<ValidatedCoefficient>& coefficients = validation.structures.front().coefficients;
  coefficients.push_back(coefficient("1", -0.019, 0.01));
  coefficients.push_back(coefficient("x^3", 0.021, 0.01));
  coefficients.push_back(coefficient("x''", 0.001, 0.01));
  coefficients.back().of_target = true;
  Findings const findings = validation_findings(validation);
  REQUIRE(codes() == std::vector{FindingCode::term_idle});
  CHECK(findings.front().severity == Severity::warning);
  CHECK(findings.front().names == std::vector<std::string>{"1"});
  CHECK(findings.front().message == "in the fit by simulation the coefficient of `1` is less than two sds from zero");
}
