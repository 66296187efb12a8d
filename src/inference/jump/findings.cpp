// One finding for each kind of doubt; models of one kind are named together.
#include "inference/jump/findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numeric/hypotenuse.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/text/words.hpp"
#include "inference/jump/tally.hpp"

namespace sysid::jump {
namespace {

constexpr double covering = 0.01;   // worth of proposals
constexpr double rarely = 0.05;     // of the jumps accepted
constexpr double imprecise = 0.05;  // standard error of a probability
constexpr double different = 4;     // standard errors
constexpr double of_nats = 0.1;     // that a log evidence may differ by whatever its error

constexpr double log_negligible = -14;  // a probability of 1e-6

constexpr char const* more_samples = "use more `samples`, and a longer `pilot` if jumps are rarely accepted";

/// Whether the weights of the proposals say that the model has hardly any probability.
bool negligible(SelectionResult const& result, std::size_t model) {
  double best = -infinity;
  for (JumpRecord::OfModel const& each : result.jumps->models)
    if (std::isfinite(each.log_evidence)) best = std::max(best, each.log_evidence);
  JumpRecord::OfModel const& own = result.jumps->models[model];
  return std::isfinite(own.log_evidence) && own.log_evidence + different * own.evidence_error < best + log_negligible;
}

void add_not_visited(SelectionResult const& result, std::vector<std::string> const& excluded, Findings& findings) {
  for (std::size_t m = 0; m < result.models.size(); ++m) {
    std::string const& name = result.models[m].name;
    if (!excluded[m].empty())
      findings.push_back({FindingCode::model_not_visited,
                          Severity::warning,
                          {name},
                          fmt::format("`{}` is left out, and its probability is given as 0: {}", name, excluded[m]),
                          "check its equations and priors, or fit it on its own to see where simulations fail"});
    else if (!std::isfinite(result.jumps->models[m].log_bayes_factor))
      findings.push_back({FindingCode::model_not_visited,
                          negligible(result, m) ? Severity::warning : Severity::error,
                          {name},
                          fmt::format("no chain went to `{}` and came back, so its probability is not known", name),
                          more_samples});
  }
}

void add_rarely_accepted(SelectionResult const& result, Findings& findings) {
  auto const visited = std::count_if(result.jumps->models.begin(), result.jumps->models.end(),
                                     [](JumpRecord::OfModel const& each) { return std::isfinite(each.log_bayes_factor); });
  if (visited < 2) return;  // there is nowhere to jump to
  std::vector<std::string> names;
  double least = 1;
  for (std::size_t m = 0; m < result.models.size(); ++m) {
    JumpRecord::OfModel const& model = result.jumps->models[m];
    if (!std::isfinite(model.log_bayes_factor) || !(model.accepted_in < rarely || model.accepted_out < rarely)) continue;
    names.push_back(result.models[m].name);
    least = std::min({least, model.accepted_in, model.accepted_out});
  }
  if (names.empty()) return;
  std::string const message = fmt::format(
      "jumps to or from {} are rarely accepted (rate {:.2g}): the proposals do not cover the posterior of one of the models",
      quoted(names), least);
  findings.push_back({FindingCode::jumps_rarely_accepted, Severity::warning, std::move(names), message,
                      "use a longer `pilot`; if that does not help, the posterior has narrow or curved parts: compare with the "
                      "evidences of `fit`"});
}

void add_not_covered(SelectionResult const& result, Findings& findings) {
  std::vector<std::string> names;
  double least = 1;
  for (std::size_t m = 0; m < result.models.size(); ++m) {
    JumpRecord::OfModel const& model = result.jumps->models[m];
    if (!std::isfinite(model.log_bayes_factor) || !(model.worth < covering)) continue;
    names.push_back(result.models[m].name);
    least = std::min(least, model.worth);
  }
  if (names.empty()) return;
  std::string const message = fmt::format(
      "each proposal of {} is equivalent to only {:.1g} independent draws of its posterior: a part of the posterior is hardly ever "
      "reached",
      quoted(names), least);
  findings.push_back({FindingCode::posterior_not_covered, Severity::error, std::move(names), message,
                      "use a `pilot` ten times as long; if that does not help, the posterior has narrow or curved parts: remove "
                      "parameters that the data do not determine, or compare evidences of `fit`"});
}

/// Chains against each other, and jumps against the evidences of the same proposals.
void add_disagreements(SelectionResult const& result, std::size_t lead, Findings& findings) {
  std::vector<std::string> names;
  JumpRecord::OfModel const& best = result.jumps->models[lead];
  for (std::size_t m = 0; m < result.models.size(); ++m) {
    JumpRecord::OfModel const& model = result.jumps->models[m];
    if (!std::isfinite(model.log_bayes_factor)) continue;
    if (model.spread > disagreement && model.error > 0.01) names.push_back(result.models[m].name);
  }
  if (!names.empty()) {
    std::string const message = fmt::format("the chains disagree about the probability of {}", quoted(names));
    findings.push_back({FindingCode::visits_disagree, Severity::error, std::move(names), message, more_samples});
  }
  for (std::size_t m = 0; m < result.models.size(); ++m) {
    JumpRecord::OfModel const& model = result.jumps->models[m];
    if (m == lead || !std::isfinite(model.log_bayes_factor)) continue;
    if (result.models[m].probability < 1e-6 && negligible(result, m)) continue;
    double const by_evidence = model.log_evidence - best.log_evidence, off = model.log_bayes_factor - by_evidence;
    double const error = hypotenuse(model.factor_error, hypotenuse(model.evidence_error, best.evidence_error));
    if (!(std::fabs(off) > different * error + of_nats)) continue;
    findings.push_back(
        {FindingCode::visits_disagree,
         Severity::error,
         {result.models[m].name},
         fmt::format("the log Bayes factor of `{}` is {:.2f} by the jumps and {:.2f} by the weights of their proposals",
                     result.models[m].name, model.log_bayes_factor, by_evidence),
         more_samples});
  }
}

void add_imprecise(SelectionResult const& result, Findings& findings) {
  std::vector<std::string> names;
  double largest = 0;
  for (std::size_t m = 0; m < result.models.size(); ++m) {
    double const error = result.jumps->models[m].error;
    if (!(error > imprecise)) continue;
    names.push_back(result.models[m].name);
    largest = std::max(largest, error);
  }
  if (names.empty()) return;
  std::string const message =
      fmt::format("the probability of {} is known to {:.2g} only (one standard error)", quoted(names), largest);
  findings.push_back({FindingCode::probabilities_imprecise, Severity::warning, std::move(names), message, more_samples});
}

}  // namespace

Findings check_jumps(SelectionResult const& result, std::vector<std::string> const& excluded) {
  Findings findings;
  auto const lead = std::max_element(result.models.begin(), result.models.end(),
                                     [](auto const& a, auto const& b) { return a.probability < b.probability; });
  add_not_visited(result, excluded, findings);
  add_rarely_accepted(result, findings);
  add_not_covered(result, findings);
  add_disagreements(result, static_cast<std::size_t>(lead - result.models.begin()), findings);
  add_imprecise(result, findings);
  return findings;
}

}  // namespace sysid::jump
