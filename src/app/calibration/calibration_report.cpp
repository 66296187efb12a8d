// What the terminal and the page show of a calibration.
#include "app/calibration/calibration_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "app/session/provenance.hpp"
#include "app/session/reporting.hpp"
#include "core/text/number.hpp"
#include "data/start_rule.hpp"
#include "diagnostics/verdict.hpp"

namespace sysid {
namespace {

/// Large where an optimum lies at a bound, with an sd of nothing.
std::string number(double value) {
  return !std::isfinite(value) ? "-" : std::fabs(value) < 100 ? fmt::format("{:.2f}", value) : significant(value, 1);
}

/// "91.5 ± 2.1": percent, with the sd that a share which is right would have.
std::string coverage(double found, double expected, int n) {
  return fmt::format("{:.1f} ± {:.1f}", 100 * found, 100 * share_error(expected, n));
}

ReportTable quantity_table(CalibrationReport const& calibration) {
  int const n = calibration.with_draws();
  ReportTable table{
      "calibration",
      fmt::format("Over {} records. 50, 90, 95 %: percentage of the true values inside the central intervals of their posteriors, "
                  "± the standard error by chance. z = (posterior mean - true value)/posterior sd: its mean and sd are 0 and 1 if "
                  "the posterior is normal. Contraction: fraction of the prior variance that the data remove. p: tests that the "
                  "ranks are uniform, from the distribution of all ranks (Säilynoja et al. 2022) and by chi-square in {} groups; "
                  "the last column is the smaller of the two, corrected for all tests (Bonferroni).",
                  n, calibration.bins),
      {"quantity", "50 %", "90 %", "95 %", "mean z", "sd z", "contraction", "p ECDF", "p chi-square", "p together"},
      {}};
  for (CalibratedQuantity const& each : calibration.quantities)
    table.rows.push_back({each.name, coverage(each.covered_50, 0.5, n), coverage(each.covered_90, 0.9, n),
                          coverage(each.covered_95, 0.95, n), number(each.mean_z), number(each.sd_z), number(each.contraction),
                          fmt::format("{:.3g}", each.ecdf_p), fmt::format("{:.3g}", each.chi_squared_p),
                          fmt::format("{:.3g}", each.adjusted_p)});
  return table;
}

ReportTable check_table(CalibrationReport const& calibration) {
  ReportTable table{
      "checks of the fits",
      "In how many fits each check had a finding. The records are simulated with the model itself, so a finding about the "
      "model or the record is a false alarm.",
      {"check", "failed in", "warned in", "of"},
      {}};
  for (FiredCheck const& each : calibration.checks)
    table.rows.push_back(
        {each.code, std::to_string(each.failed), std::to_string(each.warned), std::to_string(calibration.with_draws())});
  return table;
}

/// Below it hardly anything is found but what is wrong by half.
constexpr int few_records = 100;

/// By how many percent one sd of five must be too small to be found more often than not: the table of docs/methods/calibration.md.
int shown_percent(int n) { return 5 * static_cast<int>(std::ceil(70 / std::sqrt(n))); }

std::string headline(CalibrationReport const& calibration, Findings const& findings) {
  Verdict const verdict = verdict_of(findings);
  bool uniform = true;
  for (CalibratedQuantity const& each : calibration.quantities) uniform = uniform && each.adjusted_p >= doubtful_p;
  if (!uniform) return verdict.pass ? "doubtful: ranks may not be uniform" : "not calibrated: ranks are not uniform";
  int const n = calibration.with_draws();
  if (n == 0) return "not known: no record has a fit";
  std::string const words =
      fmt::format("the ranks of {} look uniform", calibration.quantities.size() == 1
                                                      ? std::string("the parameter")
                                                      : fmt::format("all {} quantities", calibration.quantities.size()));
  std::string const found = fmt::format("nothing found in {} records: {}", n, words);
  if (!verdict.pass) return fmt::format("not known: {}, but too many records have no fit", words);
  return n < few_records
             ? found + "; so few records can reveal only gross errors"
             : fmt::format("{}; an sd that is too small by {} % would probably have been detected", found, shown_percent(n));
}

}  // namespace

Report calibration_report(Session const& session, CalibrationPlan const& plan, CalibrationReport calibration) {
  Model const& model = session.file.models[static_cast<std::size_t>(plan.what.model)];
  Report report = begin_report(session, *plan.task, plan.what.model,
                               fmt::format("calibration of fit {} to {} with {}", model.name,
                                           data_names(session.file, plan.what.experiments), plan.backend->name),
                               plan.seed);
  report.verb = "calibrate";
  add_repetition(session, *plan.task, report,
                 {"calibrate", fmt::format(" --task {} --replications {}", plan.task->name, calibration.replications)});
  add_prediction_rule(model, plan.what.prediction, report);
  report.settings = {{"backend", std::string(plan.backend->name)},
                     {"replications", static_cast<std::int64_t>(calibration.replications)},
                     {"ranked_among", static_cast<std::int64_t>(calibration.draws)}};
  for (auto const& [name, value] : plan.what.settings.all()) report.settings.emplace_back(name, value);
  report.settings.emplace_back("start_state", start_text(plan.what.start));
  report.findings = calibration_findings(calibration);
  report.verdict = headline(calibration, report.findings);
  for (Replication const& each : calibration.records) report.ledger.add_solves(each.solves);
  report.tables.push_back(quantity_table(calibration));
  if (!calibration.checks.empty()) report.tables.push_back(check_table(calibration));
  report.calibration = std::move(calibration);
  return report;
}

}  // namespace sysid
