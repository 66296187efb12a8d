// Both fits in one session, nothing of them kept but the comparison.
#include "app/calibration/crosscheck.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "app/calibration/chosen_fits.hpp"
#include "app/fit/fit.hpp"
#include "app/session/preconditions.hpp"
#include "app/session/provenance.hpp"
#include "app/session/reporting.hpp"
#include "app/session/resolved.hpp"
#include "app/session/results.hpp"
#include "core/numeric/random.hpp"
#include "core/ranks/ranks.hpp"
#include "core/system/files.hpp"
#include "core/system/interrupt.hpp"
#include "core/text/number.hpp"
#include "diagnostics/calibration/agreement.hpp"
#include "diagnostics/convergence.hpp"
#include "diagnostics/verdict.hpp"
#include "inference/table.hpp"

namespace sysid {
namespace {

/// Another way of sampling: trajectories where there were random moves, and moves where there were trajectories or none.
std::string other_than(std::string const& backend) { return backend == "mh" ? "nuts" : "mh"; }

UserError refused(std::string message, std::string help) {
  return UserError({Severity::error, "", std::move(message), std::nullopt, {}, std::move(help)});
}

/// Draws from the same random numbers would differ less than their errors say.
std::uint64_t other_seed(std::uint64_t seed) { return Stream({seed, Purpose::calibration, 0, 3}).bits() >> 11; }

std::vector<ComparedNumber> compared(Report const& first, Report const& second) {
  std::vector<ComparedNumber> all;
  for (std::size_t p = 0; p < static_cast<std::size_t>(first.draws.parameter_count); ++p) {
    Summary const& one = first.summary[p];
    if (one.coefficient) continue;
    std::vector<ComparedNumber> numbers =
        first.draws.is_optimum() ? compare_optimum(one.name, one.unit, chains_of(second.draws, p), one.mean, one.sd)
                                 : compare_draws(one.name, one.unit, chains_of(first.draws, p), chains_of(second.draws, p));
    all.insert(all.end(), numbers.begin(), numbers.end());
  }
  return all;
}

/// To two digits of its error.
std::string to_error(double value, double error) {
  if (!std::isfinite(value) || !std::isfinite(error)) return fmt::format("{:.4g}", value);
  double const digits = value == 0 || !(error > 0) ? 4 : std::ceil(std::log10(std::fabs(value) / error)) + 2;
  return significant(value, static_cast<int>(std::clamp(digits, 2.0, 12.0)));
}

ReportTable number_table(std::vector<ComparedNumber> const& numbers, std::string const& first, std::string const& second,
                         bool with_optimum) {
  ReportTable table{"both back ends",
                    with_optimum ? "z: the difference divided by a fifth of the posterior sd; below 1 it hardly matters."
                                 : "z: the difference divided by its Monte Carlo standard error.",
                    {"quantity", "unit", "", first, second, "error", "z"},
                    {}};
  for (ComparedNumber const& each : numbers)
    table.rows.push_back({each.quantity, each.unit, each.what, to_error(each.first, each.error), to_error(each.second, each.error),
                          std::isfinite(each.error) ? significant(each.error, 2) : "-",
                          std::isfinite(each.z()) ? fmt::format("{:.2f}", each.z()) : "-"});
  return table;
}

class Crosscheck {
 public:
  Crosscheck(Session& session, int index, std::string const& against)
      : session_(session),
        index_(index),
        task_(session.file.tasks[static_cast<std::size_t>(index)]),
        own_(std::get<FitTask>(task_.what)),
        against_(against) {
    if (own_.near) {
      own_.near.reset();
      left_out_ = search_text(session.file, std::get<FitTask>(task_.what));
    }
    require_exact();
    if (against_.empty()) return;
    require_another(own_.backend);
    std::string const help = "name a back end that samples with --against: mh, nuts or tempering";
    if (against_ == "auto") throw refused("`auto` stands for another back end, which may be that of the fit", help);
    if (find_backend(against_)->objective_kind != ObjectiveKind::posterior)
      throw refused(fmt::format("`{}` finds an optimum and does not sample: nothing can be checked against it", against_), help);
  }

  ExitCode run() {
    auto const began = std::chrono::steady_clock::now();
    if (!left_out_.empty())
      session_.notices << fmt::format("{}: `search = {}` is ignored: both fits search everywhere\n", task_.name, left_out_);
    std::uint64_t const seed = session_.seed(task_, own_.seed);
    std::optional<UnkeptFit> first, second;
    try {
      first = fit(own_, seed);
      if (first) second = fit(other_fit(first->backend), other_seed(seed));
    } catch (Interrupted const&) {
    }
    if (!second) {
      session_.notices << fmt::format("{}: interrupted; nothing is kept\n", task_.name);
      return ExitCode::interrupted;
    }
    Report report = compare(*first, *second, seed);
    std::chrono::duration<double> const wall = std::chrono::steady_clock::now() - began;
    report.timing.emplace_back("wall_seconds", wall.count());
    keep_result(session_, task_, report);
    remove_file(checkpoint_path(session_.result_folder(task_)));  // that of an earlier run, which this result replaces
    return verdict_of(report.findings).pass ? ExitCode::success : ExitCode::doubtful;
  }

 private:
  void require_exact() const {
    if (own_.filter == FilterRule::particle)
      throw refused(
          fmt::format("`{}` estimates its likelihood by particles, and no other back end can use such estimates", task_.name),
          "compare with a fit of the same model and `filter = unscented`, or with other seeds");
  }
  void require_another(std::string const& backend) const {
    if (against_ == backend)
      throw refused(fmt::format("`{}` is fitted by `{}` already", task_.name, backend), "name another back end with --against");
  }

  /// backend: that has fitted, where `auto` has chosen it too.
  FitTask const& other_fit(std::string const& backend) {
    require_another(backend);
    other_ = own_;
    other_.backend = against_.empty() ? other_than(backend) : against_;
    other_.settings = Settings(find_backend(other_.backend)->settings);
    return other_;
  }

  std::optional<UnkeptFit> fit(FitTask const& what, std::uint64_t seed) {
    session_.notices << fmt::format("{}: fitting with {}\n", task_.name, what.backend);
    return fit_unkept(session_, index_, task_, what, seed, {}, find_backend(what.backend));
  }

  Report compare(UnkeptFit const& first, UnkeptFit const& second, std::uint64_t seed) {
    Model const& model = session_.file.models[static_cast<std::size_t>(own_.model)];
    Report report = begin_report(session_, task_, own_.model,
                                 fmt::format("fit {} to {} by {} and {}", model.name, data_names(session_.file, own_.experiments),
                                             first.backend, second.backend),
                                 seed);
    report.verb = "crosscheck";
    add_repetition(session_, task_, report, {"crosscheck", fmt::format(" --task {} --against {}", task_.name, other_.backend)});
    report.data = first.report.data;
    for (UnkeptFit const* each : {&first, &second}) {
      report.settings.emplace_back(each->backend + " seed", static_cast<std::int64_t>(each->report.seed));
      for (auto const& [name, value] : each->report.settings) report.settings.emplace_back(each->backend + " " + name, value);
    }
    if (!left_out_.empty()) report.settings.emplace_back("left_out", "search = " + left_out_);
    bool const with_optimum = first.report.draws.is_optimum();
    std::vector<ComparedNumber> const numbers = compared(first.report, second.report);
    report.tables.push_back(number_table(numbers, first.backend, second.backend, with_optimum));
    report.findings = agreement_findings(numbers, first.backend, second.backend, with_optimum);
    bool const agree = report.findings.empty();
    // What either fit found of itself, once.
    for (UnkeptFit const* each : {&first, &second})
      for (Finding finding : each->report.findings) {
        if (finding.severity == Severity::note) continue;
        bool const known = std::any_of(report.findings.begin(), report.findings.end(), [&](Finding const& other) {
          return other.code == finding.code && other.names == finding.names;
        });
        if (known) continue;
        finding.message = fmt::format("{}: {}", each->backend, finding.message);
        report.findings.push_back(std::move(finding));
      }
    report.ledger = first.report.ledger;
    report.ledger.merge(second.report.ledger);
    double largest = 0;
    for (ComparedNumber const& each : numbers) largest = std::max(largest, std::fabs(each.z()));
    report.verdict =
        !agree         ? fmt::format("{} and {} differ", first.backend, second.backend)
        : with_optimum ? fmt::format("the optimum and sds by {} agree with the posterior by {} to within a fifth of a posterior sd",
                                     first.backend, second.backend)
                       : fmt::format("{} and {} agree: the largest of {} differences is {:.1f} standard errors", first.backend,
                                     second.backend, numbers.size(), largest);
    if (agree && !verdict_of(report.findings).pass) report.verdict += ", but a fit failed its own checks";
    return report;
  }

  Session& session_;
  int index_;
  Task const& task_;
  FitTask own_, other_;
  std::string left_out_;  // a search near another result, which is not kept beside this one
  std::string against_;   // as it was asked for; empty: what suits
};

/// All that can be refused is refused before the first fit.
ExitCode crosscheck_all(Session& session, std::vector<int> const& fits, std::string const& against) {
  ranks::wait_for_all();  // before anything is written where another rank reads
  ClaimedFolders claimed;
  std::vector<std::unique_ptr<Crosscheck>> all;
  for (int const index : fits) {
    auto const folder = session.result_folder(session.file.tasks[static_cast<std::size_t>(index)]);
    // There is nothing that could be resumed.
    if (!session.options.force && std::filesystem::exists(checkpoint_path(folder)))
      throw UserError(result_error("", fmt::format("`{}` contains an interrupted run", folder.string()), replace_results()));
    claimed.folders.emplace_back(folder, session.options);
    all.push_back(std::make_unique<Crosscheck>(session, index, against));
  }
  ExitCode worst = ExitCode::success;
  for (auto const& each : all) {
    ExitCode const code = each->run();
    if (code == ExitCode::interrupted) return code;
    worst = std::max(worst, code);
  }
  return worst;
}

}  // namespace

ExitCode crosscheck(Session& session, CrosscheckOptions const& options) {
  std::vector<int> const fits = chosen_fits(session, options.task, "crosscheck");
  try {
    check_preconditions(session, [&](Task const& task) {
      auto const index = static_cast<int>(&task - session.file.tasks.data());
      return std::find(fits.begin(), fits.end(), index) != fits.end();
    }).require();
    return crosscheck_all(session, fits, options.against);
  } catch (Interrupted const&) {
    session.notices << "interrupted while the data were read\n";
    return ExitCode::interrupted;
  }
}

}  // namespace sysid
