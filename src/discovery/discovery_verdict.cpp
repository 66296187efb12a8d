// Limits and wording.
#include "discovery/discovery_verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "discovery/validation_findings.hpp"

namespace sysid {
namespace {

constexpr double decided_probability = 0.95;
constexpr double probable = 0.8;  // between one half and this, one structure in five is wrong
constexpr double majority = 0.5;
constexpr double as_probable = 0;  // log odds of an equation with terms that the dictionary lacks
constexpr double as_good = -1;     // its log likelihood, coefficients counted, against that of the dictionary's equation
constexpr double far_more_probable = 10, nearly_as_good = -3;  // of a much simpler one, that the record hardly speaks against
constexpr double settled_residual = 1.5;                       // of the noise
constexpr double few_noises = 3;
constexpr double shared_probability = 0.95;
constexpr std::size_t most_named = 4;

bool checked(ValidationReport const& validation) {
  return !validation.structures.empty() && validation.structures.front().failure.empty();
}

/// Of the leading structures that together have most of the probability.
std::vector<ValidatedStructure const*> sharing(ValidationReport const& validation) {
  std::vector<ValidatedStructure const*> leading;
  double sum = 0;
  for (ValidatedStructure const& each : validation.structures) {
    if (!each.failure.empty() || sum >= shared_probability || leading.size() >= most_named) break;
    sum += each.probability;
    leading.push_back(&each);
  }
  return leading;
}

bool is_rival(OutsideEquation const& outside) {
  return (outside.log_odds > as_probable && outside.criterion() > as_good) ||
         (outside.log_odds > far_more_probable && outside.criterion() > nearly_as_good);
}

/// "its log likelihood is 2.5 lower, with 1 coefficient fewer"
std::string likelihood_clause(OutsideEquation const& outside) {
  int const more = outside.coefficients;
  return fmt::format("its log likelihood is {} {}, with {}", significant(std::abs(outside.log_likelihood), 2),
                     outside.log_likelihood < 0 ? "lower" : "higher",
                     more == 0 ? "as many coefficients"
                               : fmt::format("{} {} {}", std::abs(more), std::abs(more) == 1 ? "coefficient" : "coefficients",
                                             more < 0 ? "fewer" : "more"));
}

std::string form_clause(ValidationReport const& validation) {
  double const probability = validation.structures.front().probability;
  if (probability >= probable && validation.outside && is_rival(*validation.outside))
    return fmt::format(
        "the form is {} among the terms of the dictionary (probability {}), but the record does not exclude other terms",
        probability >= decided_probability ? "decided" : "the most probable", probability_text(probability));
  bool const without_rival = validation.outside && !(validation.outside->log_odds > as_probable);
  return fmt::format("the form is {}{} (probability {})",
                     probability >= decided_probability ? "decided"
                     : probability >= probable          ? "more probable than all others"
                     : probability >= majority          ? "not decided, but more probable than all others"
                                                        : "not decided",
                     probability >= probable && !without_rival ? " among the terms of the dictionary" : "",
                     probability_text(probability));
}

/// sds in percent of the coefficients: the smallest and the largest.
std::string coefficients_clause(ValidatedStructure const& best) {
  std::vector<double> percent;
  for (ValidatedCoefficient const& each : best.coefficients)
    if (each.value != 0 && std::isfinite(each.sd)) percent.push_back(100 * each.sd / std::abs(each.value));
  if (percent.empty()) return "";
  auto const [low, high] = std::minmax_element(percent.begin(), percent.end());
  std::string const most = significant(*high, 2);
  return percent.size() == 1 || significant(*low, 2) == most
             ? fmt::format("the coefficients have sds of {} %", most)
             : fmt::format("the coefficients have sds of {} to {} %", significant(*low, 2), most);
}

std::string elsewhere_clause(ValidationReport const& validation) {
  ValidatedStructure const& best = validation.structures.front();
  std::optional<double> const free = best.percent(&ValidatedChannel::free_run);
  if (validation.held_out.empty() || !free) return "not tested on other rows";
  std::string const size = std::isfinite(*free) && *free <= 1e4 ? significant(*free, 2) : "more than 1e4";
  FreeRun const run = free_run_of(validation);
  if (run == FreeRun::follows) {
    double noises = 0;
    for (ValidatedChannel const& each : best.channels)
      if (each.free_run && each.residual > 0) noises = std::max(noises, *each.free_run / each.residual);
    return noises > 0 && noises <= few_noises
               ? fmt::format("the equation holds on {} (rms error of a free run: {} times {})", validation.held_out,
                             significant(noises, 2),
                             best.residual_over_noise <= settled_residual ? "the noise" : "the residual of the fitted rows")
               : fmt::format("the equation holds on {} (rms error of a free run: {} % of the sd)", validation.held_out, size);
  }
  if (run == FreeRun::chaotic)
    return fmt::format("on {} the equation predicts no more than {} s ahead", validation.held_out, significant(best.follows, 2));
  return fmt::format("the equation fails on {} (rms error of a free run: {} % of the sd)", validation.held_out, size);
}

/// Of a term that was left out as a combination of others: whether all of those are there.
bool others_are_kept(regression::Concern const& concern, std::vector<int> const& kept) {
  return std::all_of(concern.terms.begin() + std::min<std::ptrdiff_t>(1, std::ssize(concern.terms)), concern.terms.end(),
                     [&](int term) { return std::find(kept.begin(), kept.end(), term) != kept.end(); });
}

}  // namespace

bool is_settled(ValidationReport const& validation) {
  return checked(validation) && validation.structures.front().probability >= majority &&
         validation.structures.front().residual_over_noise <= settled_residual;
}

void temper_by_terms(regression::Concern const& concern, std::vector<int> const& kept, Finding& finding) {
  if (finding.code == FindingCode::terms_collinear && !others_are_kept(concern, kept)) finding.severity = Severity::note;
}

void temper_by_form(ValidationReport const& validation, regression::Concern const& concern, std::vector<int> const& kept,
                    Finding& finding) {
  if (!checked(validation)) return;
  switch (finding.code) {
    case FindingCode::terms_interchangeable:
    case FindingCode::terms_nearly_collinear:
      finding.severity = Severity::note;
      break;
    case FindingCode::terms_collinear:
      // Where all of the others are in the equation, the one that was left out makes an equation that is no longer.
      if (!others_are_kept(concern, kept)) finding.severity = Severity::note;
      break;
    case FindingCode::residual_correlated:
    case FindingCode::selection_not_settled:
      if (is_settled(validation)) finding.severity = Severity::note;
      break;
    default:
      break;
  }
}

Findings undecided_form(ValidationReport const& validation) {
  if (!checked(validation) || validation.structures.front().probability >= probable) return {};
  std::vector<std::string> names, listed;
  for (ValidatedStructure const* each : sharing(validation)) {
    names.push_back(each->terms);
    listed.push_back(fmt::format("`{}` {}", each->terms, probability_text(each->probability)));
  }
  return {{FindingCode::form_undecided, Severity::warning, std::move(names),
           fmt::format("the record does not decide the form; probabilities: {}", fmt::join(listed, ", ")),
           "add a record from another start or of another amplitude to the same discovery: `discover ... from first, second`"}};
}

Findings undecided_terms(regression::FoundEquation const& found, DiscoveredEquation const& equation) {
  double own = 0, sum = 0, known = 0;
  std::vector<std::string> names, listed;
  for (std::size_t s = 0; s < equation.supports.size(); ++s) {
    DiscoveredSupport const& each = equation.supports[s];
    known += each.probability;
    if (found.supports[s].terms == found.chosen.terms) own = each.probability;
    if (sum >= shared_probability || names.size() >= most_named) continue;
    sum += each.probability;
    names.push_back(each.terms.empty() ? "none" : fmt::format("{}", fmt::join(each.terms, ", ")));
    listed.push_back(fmt::format("`{}` {}", names.back(), probability_text(each.probability)));
  }
  if (known == 0 || own >= probable) return {};
  return {{FindingCode::form_undecided, Severity::warning, std::move(names),
           fmt::format("the record does not decide the terms of `{}`; probabilities: {}", equation.target, fmt::join(listed, ", ")),
           "add a record from another start or of another amplitude to the same discovery: `discover ... from first, second`"}};
}

Findings other_terms(ValidationReport const& validation) {
  if (!checked(validation) || !validation.outside || !(validation.outside->log_odds > as_probable)) return {};
  OutsideEquation const& outside = *validation.outside;
  bool const rival = is_rival(outside);
  return {{FindingCode::other_terms_fit,
           rival ? Severity::warning : Severity::note,
           {outside.text},
           rival ? fmt::format("an equation with terms outside the dictionary describes the record about as well or better, with a "
                               "penalty for each coefficient: `{}` ({}); the terms that were found may only imitate it",
                               outside.text, likelihood_clause(outside))
                 : fmt::format("an equation with terms outside the dictionary is as probable, but only because of the prior of "
                               "terms and coefficients; the record does not favour it: `{}` ({})",
                               outside.text, likelihood_clause(outside)),
           rival ? "if such terms are physically plausible, add them to the dictionary and run again; a record of another "
                   "amplitude may decide between the two"
                 : "nothing, unless such terms make sense: then add them to the dictionary and run again"}};
}

Findings merged(Findings const& findings) {
  Findings out;
  for (std::size_t i = 0; i < findings.size(); ++i) {
    auto const alike = [&](Finding const& each) { return each.code == findings[i].code && each.severity == findings[i].severity; };
    if (std::any_of(out.begin(), out.end(), alike)) continue;
    Finding whole = findings[i];
    std::size_t more = 0;
    std::vector<std::string> others;
    for (std::size_t j = i + 1; j < findings.size(); ++j) {
      if (!alike(findings[j])) continue;
      ++more;
      for (std::string const& name : findings[j].names) {
        if (std::find(whole.names.begin(), whole.names.end(), name) != whole.names.end()) continue;
        whole.names.push_back(name);
        others.push_back(name);
      }
    }
    if (more > 0) {
      bool const cut = others.size() > most_named;
      if (cut) others.resize(most_named);
      whole.message += fmt::format("; and {} more like this{}{}", more, others.empty() ? "" : ", with " + quoted(others),
                                   cut ? " and others" : "");
    }
    out.push_back(std::move(whole));
  }
  return out;
}

std::string verdict_clauses(ValidationReport const& validation) {
  if (!checked(validation)) return "";
  std::vector<std::string> clauses = {form_clause(validation), coefficients_clause(validation.structures.front()),
                                      elsewhere_clause(validation)};
  std::erase(clauses, "");
  return fmt::format("{}", fmt::join(clauses, ", "));
}

}  // namespace sysid
