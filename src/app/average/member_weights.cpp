// Probabilities and stacking weights of a comparison, one for each fit; of fits of one model one has them all.
#include "app/average/member_weights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "app/comparison/compare.hpp"
#include "core/text/diagnostic.hpp"
#include "core/text/number.hpp"

namespace sysid {
namespace {

UserError without_weight(std::string const& fit, AverageWeights by, std::string const& reason) {
  return UserError({Severity::error,
                    "E6704",
                    fmt::format("`{}` cannot be given a weight by {}: {}", fit, title(by), reason),
                    std::nullopt,
                    {},
                    by == AverageWeights::evidence
                        ? "write `weights = stacking`, or `weights = equal`, which needs neither evidences nor scores"
                        : "write `weights = evidence`, or `weights = equal`, which needs neither evidences nor scores"});
}

/// From the names of results to those of the fits.
using Names = std::map<std::string, std::string>;

void weigh_by_evidence(Comparison const& comparison, Names const& names, MemberWeights& out) {
  for (std::size_t k = 0; k < out.members.size(); ++k) {
    ComparedFit const& fit = comparison.fits[k];
    AveragedMember& member = out.members[k];
    if (!fit.probability) throw without_weight(member.fit, AverageWeights::evidence, fit.without);
    if (!fit.counted.empty()) {
      member.counted = names.at(fit.counted);
      continue;
    }
    member.weight = *fit.probability;
    member.error = fit.probability_error;
    if (fit.not_confirmed.empty() && !fit.rough) continue;
    out.findings.push_back(
        {FindingCode::weights_not_confirmed,
         Severity::warning,
         {member.fit},
         fmt::format("the evidence of `{}`, which determines its weight, is not confirmed: {}", member.fit,
                     fit.rough ? fmt::format("{} gives a log evidence that differs by {:.1f}",
                                             fit.rough_by_draws ? "the estimate by weighted draws"
                                                                : "integration along the axes of its modes",
                                             *fit.rough)
                               : fit.not_confirmed),
         "compute it by draws in the fit, `evidence = importance`, `bridge` or `smc`; or write `weights = stacking`"});
  }
}

void weigh_by_scores(Comparison const& comparison, Names const& names, AverageWeights by, MemberWeights& out) {
  for (std::size_t k = 0; k < out.members.size(); ++k) {
    AveragedMember& member = out.members[k];
    std::string const& result = comparison.fits[k].name;
    auto const& all = comparison.scores.fits;
    auto const score = std::find_if(all.begin(), all.end(), [&](ComparedScore const& each) { return each.name == result; });
    auto const& apart = comparison.scores.left_out;
    if (score == all.end())
      throw without_weight(member.fit, by,
                           std::find(apart.begin(), apart.end(), result) != apart.end()
                               ? "its scored samples are not those of the first fit"
                           : all.empty() ? "no two of the fits have predictive scores on the same samples"
                                         : "it has no predictive scores");
    if (!score->counted.empty()) {
      member.counted = names.at(score->counted);
      continue;
    }
    member.weight = by == AverageWeights::stacking ? score->stacking : score->pseudo_bma;
    if (score->doubtful == 0 || comparison.scores.future) continue;
    out.findings.push_back(
        {FindingCode::weights_not_confirmed,
         Severity::warning,
         {member.fit},
         fmt::format("the scores of `{}`, which determine its weight, are not reliable: {} samples have a Pareto k "
                     "that is too large",
                     member.fit, score->doubtful),
         "check these samples of the fit in its `pointwise.csv` (often outliers); or write `weights = evidence`"});
  }
}

/// Weights sum to 1 but for rounding, and notes say what they are.
void finish(AverageWeights by, MemberWeights& out) {
  double sum = 0;
  for (AveragedMember const& member : out.members) sum += member.weight;
  if (!(sum > 0)) throw without_weight(out.members.front().fit, by, "under every fit the density of some sample is zero");
  std::vector<std::string> shares, fits;
  for (AveragedMember& member : out.members) {
    member.weight /= sum;
    fits.push_back(member.fit);
    if (member.counted.empty())
      shares.push_back(fmt::format("`{}` {}", member.fit, significant(member.weight, 3)));
    else
      out.findings.push_back({FindingCode::counted_once,
                              Severity::note,
                              {member.fit, member.counted},
                              fmt::format("`{}` and `{}` are fits of one model, which counts once: the draws of `{}` are used",
                                          member.fit, member.counted, member.counted),
                              ""});
  }
  out.findings.push_back(
      {FindingCode::averaged_over_models, Severity::note, std::move(fits),
       fmt::format("{}{}: {}", by == AverageWeights::equal ? "" : "weights by ", title(by), fmt::join(shares, ", ")), ""});
}

}  // namespace

MemberWeights weights_of(Comparison const& comparison, std::vector<std::string> const& fits, AverageWeights by) {
  MemberWeights out;
  Names names;
  for (std::size_t k = 0; k < fits.size(); ++k) {
    out.members.push_back({fits[k], by == AverageWeights::equal ? std::string() : comparison.fits[k].model, 0, {}, {}, 0});
    if (by == AverageWeights::equal)
      out.members.back().weight = 1;
    else
      names.emplace(comparison.fits[k].name, fits[k]);
  }
  if (by == AverageWeights::evidence) weigh_by_evidence(comparison, names, out);
  if (by == AverageWeights::stacking || by == AverageWeights::pseudo_bma) weigh_by_scores(comparison, names, by, out);
  finish(by, out);
  if (by == AverageWeights::evidence) out.notes = comparison.notes;
  return out;
}

MemberWeights weigh_members(Session& session, Task const& task, PredictTask const& what) {
  std::vector<std::string> fits;
  std::vector<std::filesystem::path> folders;
  for (PredictTask const& member : what.members) {
    Task const& fit = session.file.tasks[static_cast<std::size_t>(member.fit)];
    fits.push_back(fit.name);
    folders.push_back(session.result_folder(fit));
  }
  try {
    return weights_of(what.weights == AverageWeights::equal ? Comparison() : compare(folders), fits, what.weights);
  } catch (UserError const& error) {
    Diagnostic diagnostic = error.diagnostic();
    if (diagnostic.code.empty())
      diagnostic.code = "E6705";  // what `compare` says without a code: other samples, or unreadable ones
    diagnostic.primary = Label{task.span, {}};
    throw UserError(std::move(diagnostic));
  }
}

}  // namespace sysid
