// Statistics of each quantity, then findings.
#include "diagnostics/calibration/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/numeric/statistics.hpp"
#include "core/text/words.hpp"
#include "diagnostics/calibration/ecdf_bands.hpp"

namespace sysid {
namespace {

constexpr double level = 0.95;

bool inside(double below, double share) { return std::fabs(below - 0.5) <= 0.5 * share; }

/// By which of its first two moments the distribution of ranks differs most from the uniform one, in standard errors.
RankShape shape_of(std::vector<int> const& ranks, int draws) {
  std::vector<double> u;
  for (int const rank : ranks) u.push_back((rank + 0.5) / (draws + 1));
  auto const n = static_cast<double>(u.size());
  double const shift = (mean(u) - 0.5) / std::sqrt(1.0 / 12 / n);
  double const spread = (squared_deviations(u, 0.5) / n - 1.0 / 12) / std::sqrt(1.0 / 180 / n);
  if (std::max(std::fabs(shift), std::fabs(spread)) < 2) return RankShape::other;
  if (std::fabs(spread) >= std::fabs(shift)) return spread > 0 ? RankShape::too_narrow : RankShape::too_wide;
  return shift > 0 ? RankShape::too_low : RankShape::too_high;
}

CalibratedQuantity calibrated(QuantityName const& quantity, std::size_t index, CalibrationReport const& calibration) {
  CalibratedQuantity out{quantity.name, quantity.unit, {}};
  std::vector<double> truth, variance, z;
  double n = 0;
  for (Replication const& each : calibration.records) {
    if (!each.has_draws()) continue;
    TruePlace const& place = each.places[index];
    out.ranks.push_back(place.rank);
    out.covered_50 += inside(place.below, 0.5);
    out.covered_90 += inside(place.below, 0.9);
    out.covered_95 += inside(place.below, 0.95);
    if (place.sd > 0 && std::isfinite(place.sd)) z.push_back((place.mean - place.truth) / place.sd);
    truth.push_back(place.truth);
    variance.push_back(place.sd * place.sd);
    ++n;
  }
  if (n == 0) return out;
  for (double* each : {&out.covered_50, &out.covered_90, &out.covered_95}) *each /= n;
  // The log likelihood of the true values is no normal variable around its posterior mean.
  if (z.size() > 1 && quantity.parameter) {
    out.mean_z = mean(z);
    out.sd_z = std::sqrt(sample_variance(z));
  }
  if (n > 1 && quantity.parameter) out.contraction = 1 - mean(variance) / sample_variance(truth);
  int const values = calibration.draws + 1;
  out.chi_squared_p = chi_squared_p_value(out.ranks, values, calibration.bins);
  out.ecdf_p = ecdf_p_value(out.ranks, values);
  return out;
}

std::vector<FiredCheck> fired_checks(std::vector<Replication> const& records) {
  std::map<std::string, FiredCheck> by_code;
  for (Replication const& each : records) {
    for (std::string const& code : each.failed) ++by_code[code].failed;
    for (std::string const& code : each.warned) ++by_code[code].warned;
  }
  std::vector<FiredCheck> checks;
  for (auto& [code, fired] : by_code) {
    fired.code = code;
    checks.push_back(fired);
  }
  std::stable_sort(checks.begin(), checks.end(),
                   [](FiredCheck const& a, FiredCheck const& b) { return a.failed + a.warned > b.failed + b.warned; });
  return checks;
}

Finding not_uniform(std::vector<CalibratedQuantity const*> const& wrong, std::size_t tested, int n) {
  CalibratedQuantity const& worst = *wrong.front();
  std::vector<std::string> names;
  for (CalibratedQuantity const* each : wrong) names.push_back(each->name);
  return {
      FindingCode::ranks_not_uniform, worst.adjusted_p < wrong_p ? Severity::error : Severity::warning, names,
      fmt::format("the ranks of the true values of {} among their posterior draws are not uniform over {} records ({}; p = {:.2g}, "
                  "for {} together){}",
                  worst.name, n, shape_words(worst.shape), worst.adjusted_p,
                  tested == 1 ? "1 quantity" : fmt::format("{} quantities", tested),
                  wrong.size() > 1 ? fmt::format("; the same holds for {} more", wrong.size() - 1) : std::string()),
      "run more replications or another seed to be sure; then see in the table which checks of the fits had findings, and fit with "
      "another back end, longer chains or a finer solver"};
}

}  // namespace

double share_error(double share, int n) { return n == 0 ? 1 : std::sqrt(share * (1 - share) / n); }

std::string_view shape_words(RankShape shape) {
  switch (shape) {
    case RankShape::too_narrow:
      return "posteriors too narrow: true values lie in their tails too often";
    case RankShape::too_wide:
      return "posteriors too wide: true values lie near their centre too often";
    case RankShape::too_low:
      return "posteriors too low: true values lie above them too often";
    case RankShape::too_high:
      return "posteriors too high: true values lie below them too often";
    case RankShape::other:
      return "neither a shift nor a width explains it";
    case RankShape::uniform:
      break;
  }
  return "uniform";
}

CalibrationReport calibration_of(std::vector<QuantityName> const& quantities, std::vector<Replication> records, int replications,
                                 int draws) {
  CalibrationReport out;
  out.replications = replications;
  out.draws = draws;
  out.records = std::move(records);
  std::sort(out.records.begin(), out.records.end(), [](Replication const& a, Replication const& b) { return a.number < b.number; });
  int const n = out.with_draws();
  out.bins = rank_bins(n, draws + 1);
  for (std::size_t q = 0; q < quantities.size(); ++q) out.quantities.push_back(calibrated(quantities[q], q, out));
  auto const tests = static_cast<double>(2 * out.quantities.size());
  for (CalibratedQuantity& each : out.quantities) {
    each.adjusted_p = std::min(1.0, tests * std::min(each.chi_squared_p, each.ecdf_p));
    each.shape = each.adjusted_p < doubtful_p ? shape_of(each.ranks, draws) : RankShape::uniform;
  }
  out.checks = fired_checks(out.records);
  if (n > 0) {
    CountBands const bands = ecdf_bands(n, draws + 1, level);
    for (std::size_t k = 0; k < bands.low.size(); ++k) {
      double const uniform = static_cast<double>(k + 1) / (draws + 1);
      out.band_low.push_back(static_cast<double>(bands.low[k]) / n - uniform);
      out.band_high.push_back(static_cast<double>(bands.high[k]) / n - uniform);
    }
  }
  return out;
}

Findings calibration_findings(CalibrationReport const& calibration) {
  Findings findings;
  int const all = static_cast<int>(calibration.records.size()), n = calibration.with_draws();
  if (all > n)
    findings.push_back(
        {FindingCode::replications_failed,
         20 * (all - n) > all ? Severity::error : Severity::warning,
         {},
         fmt::format("{} of {} simulated records have no fit (the first: {}); the test of the others may be too optimistic",
                     all - n, all,
                     std::find_if(calibration.records.begin(), calibration.records.end(),
                                  [](Replication const& each) { return !each.has_draws(); })
                         ->failure),
         "narrow the priors to what is possible, or choose a search and a solver that work in the whole prior"});
  std::vector<CalibratedQuantity const*> wrong;
  for (CalibratedQuantity const& each : calibration.quantities)
    if (each.adjusted_p < doubtful_p) wrong.push_back(&each);
  std::stable_sort(wrong.begin(), wrong.end(), [](auto const* a, auto const* b) { return a->adjusted_p < b->adjusted_p; });
  if (!wrong.empty()) findings.push_back(not_uniform(wrong, calibration.quantities.size(), n));
  auto const count = [&](auto const& holds) {
    return static_cast<int>(std::count_if(calibration.records.begin(), calibration.records.end(), holds));
  };
  if (int const failed = count([](Replication const& each) { return !each.failed.empty(); }); failed > 0)
    findings.push_back(
        {FindingCode::replications_fail_checks,
         20 * failed > all ? Severity::warning : Severity::note,
         {},
         fmt::format("{} of {} fits failed their own checks; their ranks are included in the test", failed, all),
         "see in the table which checks failed; in a real analysis the verdict of such a fit would have warned you"});
  if (int const few = count([&](Replication const& each) {
        return each.has_draws() && each.independent > 0 && each.independent < calibration.draws;
      });
      few > 0)
    findings.push_back(
        {FindingCode::ranks_of_dependent_draws,
         20 * few > all ? Severity::warning : Severity::note,
         {},
         fmt::format("{} of {} fits have fewer than {} independent draws, so ranks among their draws are too extreme", few, all,
                     calibration.draws),
         "run longer chains"});
  if (int const unsettled = count([](Replication const& each) { return !each.settled; }); unsettled > 0)
    findings.push_back({FindingCode::step_not_settled,
                        20 * unsettled > all ? Severity::warning : Severity::note,
                        {},
                        fmt::format("{} of {} records were simulated with a solver whose error may affect them", unsettled, all),
                        "narrow the priors, or state an adaptive or exact solver"});
  int redrawn = 0;
  for (Replication const& each : calibration.records) redrawn += each.redrawn;
  if (redrawn > 0)
    findings.push_back({FindingCode::prior_redrawn,
                        redrawn > all ? Severity::warning : Severity::note,
                        {},
                        fmt::format("{} of {} prior draws could not be simulated and were drawn again: the calibration holds for "
                                    "the prior without them",
                                    redrawn, redrawn + all),
                        "narrow the priors if such values are not possible (`sysid check` shows where they fail)"});
  return findings;
}

}  // namespace sysid
