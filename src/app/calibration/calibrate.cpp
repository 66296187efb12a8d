// Replications in parallel, each kept as it ends; then ranks, tests and the page.
#include "app/calibration/calibrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <span>

#include "app/calibration/calibration_report.hpp"
#include "app/calibration/chosen_fits.hpp"
#include "app/calibration/replicate.hpp"
#include "app/session/exact_steps.hpp"
#include "app/session/preconditions.hpp"
#include "app/session/provenance.hpp"
#include "app/session/reporting.hpp"
#include "app/session/results.hpp"
#include "app/session/task_checkpoint.hpp"
#include "core/ranks/ranks.hpp"
#include "core/system/files.hpp"
#include "core/system/interrupt.hpp"
#include "diagnostics/verdict.hpp"
#include "inference/table.hpp"
#include "report/file/replacement.hpp"
#include "report/file/stored_files.hpp"
#include "report/file/stored_report.hpp"
#include "simulate/thread_pool.hpp"

namespace sysid {
namespace {

using json = nlohmann::json;

/// Of the file; else of the result that a resumed calibration goes on from, which was drawn.
std::optional<std::uint64_t> seed_in_force(Session const& session, Task const& task) {
  std::optional<std::uint64_t> const stated = std::get<FitTask>(task.what).seed;
  auto const folder = session.result_folder(task);
  if (stated || !session.options.resume || !complete(folder)) return stated;
  auto const summary = json::parse(read_whole_summary(folder));
  return interpreted(folder / "summary.json", [&] { return summary.at("seed").get<std::uint64_t>(); });
}

class Calibration {
 public:
  Calibration(Session& session, int index, CalibrateOptions const& options)
      : session_(session),
        task_(session.file.tasks[static_cast<std::size_t>(index)]),
        checkpoint_(session, task_, seed_in_force(session, task_), "calibrate"),
        replications_(options.replications) {
    plan_.index = index;
    plan_.task = &task_;
    plan_.what = std::get<FitTask>(task_.what);
    plan_.what.near.reset();
    plan_.backend = options.backend != nullptr ? options.backend : find_backend(plan_.what.backend);
    if (plan_.what.filter == FilterRule::particle && plan_.backend->needs.exact_likelihood)
      throw UserError({Severity::error,
                       "E6210",
                       fmt::format("`{}` cannot be calibrated with `{}`: its likelihood is estimated by particles", task_.name,
                                   plan_.backend->name),
                       Label{task_.span, {}},
                       {},
                       "calibrate with `mh`"});
    plan_.seed = checkpoint_.seed();
    data_ = load_experiments(session, plan_.what.experiments, model(), plan_.what.start, plan_.what.prediction, plan_.what.solver);
    // Values that the usual steps do not follow are drawn, too, and fitted by what follows them.
    if (SuitedTask suited = with_exact_steps(plan_.what, model(), data_); suited.growing > 0) plan_.what = std::move(suited.task);
    checkpoint_.of_data(data_);
  }

  /// What is stored, and whether the prior can be simulated: UserError where that is refused.
  void prepare() {
    restore();
    require_prior();
  }

  ExitCode run() {
    began_ = saved_ = std::chrono::steady_clock::now();
    begin_progress();
    if (!run_replications()) {
      session_.progress.end(false);
      if (!done_.empty()) save();
      session_.notices << fmt::format("{}: interrupted after {} of {} replications; {}\n", task_.name, done_.size(), replications_,
                                      after_interruption());
      return ExitCode::interrupted;
    }
    session_.progress.end();
    return conclude();
  }

 private:
  Model const& model() const { return session_.file.models[static_cast<std::size_t>(plan_.what.model)]; }

  std::string after_interruption() const {
    if (done_.empty() && complete(session_.result_folder(task_))) return "its earlier results are kept";
    return fmt::format("{} {}", to_resume(session_.options.surface), done_.empty() ? "starts it again" : "continues from there");
  }

  // Of an interrupted run; else of a complete one of fewer or more replications, which have the same numbers.
  void restore() {
    std::shared_ptr<json const> const stored = checkpoint_.stored();
    if (!stored) return take_over();
    checkpoint_.reading([&] {
      std::size_t const quantities = ranked_quantities(session_, plan_).size();
      for (json const& each : stored->at("replications")) {
        Replication replication = restore_replication(each);
        bool const fits = !replication.has_draws() || (replication.places.size() == quantities && in_order(replication));
        if (!fits || replication.number < 0) throw json::other_error::create(501, "a replication of other quantities", &each);
        if (replication.number < replications_) done_.emplace(replication.number, std::move(replication));
      }
    });
    session_.notices << fmt::format("{}: continuing after {} of {} replications\n", task_.name, done_.size(), replications_);
  }

  void take_over() {
    auto const folder = session_.result_folder(task_);
    if (!session_.options.resume || !complete(folder)) return;
    Report const report = read_result(folder);
    if (!report.calibration || report.seed != plan_.seed) return;
    for (Replication const& each : report.calibration->records)
      if (each.number < replications_) done_.emplace(each.number, each);
    session_.notices << fmt::format("{}: continuing after {} of {} replications\n", task_.name, done_.size(), replications_);
  }

  bool in_order(Replication const& replication) const {
    return std::all_of(replication.places.begin(), replication.places.end(),
                       [&](TruePlace const& each) { return each.rank >= 0 && each.rank <= plan_.draws; });
  }

  // Before hours of fits: a prior of which little can be simulated says little of the fit.
  void require_prior() {
    Replicator replicator(session_, plan_);
    Replicator::Tried const tried = replicator.try_prior(std::min(replications_, 10));
    if (10 * tried.failed <= 9 * tried.draws) return;
    throw UserError({Severity::error,
                     "E6210",
                     fmt::format("`{}` cannot be calibrated: {} of {} draws of its prior cannot be simulated", task_.name,
                                 tried.failed, tried.draws),
                     Label{task_.span, {}},
                     {},
                     "narrow the priors to what is possible, or use a solver that can integrate the fastest motions of the prior "
                     "(`sysid check` shows where simulations fail)"});
  }

  void begin_progress() {
    session_.progress.begin(fmt::format("{}: calibrating", task_.name), static_cast<std::uint64_t>(replications_));
    session_.progress.advance(done_.size(), "");
  }

  // False: interrupted.
  bool run_replications() {
    std::vector<int> open;
    for (int number = 0; number < replications_; ++number)
      if (!done_.contains(number)) open.push_back(number);
    // Replications take the threads, each fit has one.
    int const ranks = ranks::size(), most = (static_cast<int>(open.size()) + ranks - 1) / ranks;
    int const threads = std::max(1, std::min(session_.threads(), most));
    for (int t = 0; t < threads; ++t) idle_.push_back(std::make_unique<Replicator>(session_, plan_));
    ThreadPool pool(threads);
    bool const stopped = ranks > 1 ? stopped_in_rounds(open, pool)
                                   : stopped_among(pool, open, [&](Replication replication) { keep(std::move(replication)); });
    idle_.clear();
    return !stopped || done_.size() == static_cast<std::size_t>(replications_);
  }

  /// On this rank; keep: called in order of their ends, one at a time. True: it was stopped before their last.
  bool stopped_among(ThreadPool& pool, std::span<int const> numbers, std::function<void(Replication)> const& keep) {
    bool stopped = false;
    pool.run(static_cast<int>(numbers.size()), [&](int i) {
      ranks::Own const own;
      std::unique_ptr<Replicator> replicator;
      {
        std::lock_guard const lock(mutex_);
        stopped = stopped || interrupt_requested();
        if (stopped) return;
        replicator = std::move(idle_.back());
        idle_.pop_back();
      }
      std::optional<Replication> replication = replicator->run(numbers[static_cast<std::size_t>(i)]);
      std::lock_guard const lock(mutex_);
      idle_.push_back(std::move(replicator));
      stopped = stopped || !replication;
      if (replication) keep(std::move(*replication));
      if (ranks::size() == 1) stopped = session_.interrupted() || stopped;  // counts for tests
    });
    return stopped;
  }

  /// Each rank some, then all have all. Rounds become longer until one takes some seconds, as a rank that is done early waits.
  bool stopped_in_rounds(std::span<int const> open, ThreadPool& pool) {
    constexpr double long_enough = 5;  // [s]
    auto const ranks = static_cast<std::size_t>(ranks::size()), own = static_cast<std::size_t>(ranks::rank());
    bool stopped = false;
    for (std::size_t each = static_cast<std::size_t>(pool.threads()); !open.empty() && !stopped;) {
      std::span<int const> const round = open.first(std::min(open.size(), each * ranks));
      open = open.subspan(round.size());
      std::vector<int> mine;
      for (std::size_t i = own; i < round.size(); i += ranks) mine.push_back(round[i]);
      auto const began = std::chrono::steady_clock::now();
      json finished = json::array();
      bool const given_up = stopped_among(pool, mine, [&](Replication replication) { finished.push_back(store(replication)); });
      std::chrono::duration<double> const took = std::chrono::steady_clock::now() - began;
      std::vector<std::uint8_t> const bytes = json::to_cbor(json::array({took.count(), given_up, std::move(finished)}));
      double longest = 0;
      std::map<int, Replication> all;
      for (std::string const& one : ranks::gather({reinterpret_cast<char const*>(bytes.data()), bytes.size()})) {
        json const of_rank = json::from_cbor(one);
        longest = std::max(longest, of_rank.at(0).get<double>());
        stopped = stopped || of_rank.at(1).get<bool>();
        for (json const& stored : of_rank.at(2)) {
          Replication replication = restore_replication(stored);
          all.emplace(replication.number, std::move(replication));
        }
      }
      for (auto& [number, replication] : all) {
        keep(std::move(replication));
        stopped = session_.interrupted() || stopped;  // counts for tests
      }
      if (longest < long_enough) each *= 2;
    }
    return stopped;
  }

  void keep(Replication replication) {
    failed_ += !replication.has_draws();
    done_.emplace(replication.number, std::move(replication));
    session_.progress.advance(done_.size(), failed_ == 0 ? "" : fmt::format("{} without a fit", failed_));
    std::chrono::duration<double> const since = std::chrono::steady_clock::now() - saved_;
    if (done_.size() < static_cast<std::size_t>(replications_) && since.count() > session_.options.checkpoint_interval) save();
  }

  void save() {
    json all = json::array();
    for (auto const& [number, replication] : done_) all.push_back(store(replication));
    checkpoint_.save({{"replications", std::move(all)}});
    saved_ = std::chrono::steady_clock::now();
  }

  ExitCode conclude() {
    std::vector<Replication> records;
    for (auto& [number, replication] : done_) records.push_back(std::move(replication));
    Report report = calibration_report(
        session_, plan_, calibration_of(ranked_quantities(session_, plan_), std::move(records), replications_, plan_.draws));
    for (ExperimentData const& each : data_) add_data(session_.file, each, model(), report);
    std::chrono::duration<double> const wall = std::chrono::steady_clock::now() - began_;
    report.timing.emplace_back("wall_seconds", wall.count());
    report.timing.emplace_back("threads", static_cast<std::int64_t>(session_.threads()));
    keep_result(session_, task_, report);
    remove_file(checkpoint_.path());
    return verdict_of(report.findings).pass ? ExitCode::success : ExitCode::doubtful;
  }

  Session& session_;
  Task const& task_;
  TaskCheckpoint checkpoint_;
  int replications_;
  CalibrationPlan plan_;
  std::vector<ExperimentData> data_;
  std::chrono::steady_clock::time_point began_, saved_;
  std::mutex mutex_;
  std::map<int, Replication> done_;  // by number
  int failed_ = 0;
  std::vector<std::unique_ptr<Replicator>> idle_;
};

/// Whether a calibration of as many replications of this very task stands there already; UserError (E6208) where what stands there
/// is something else, or a calibration of more replications, of which some would be lost. One of fewer is gone on from.
bool kept(Session const& session, Task const& task, CalibrateOptions const& options) {
  auto const folder = session.result_folder(task);
  if (!session.options.resume || !complete(folder)) return false;
  std::optional<std::uint64_t> const seed = session.options.seed ? session.options.seed : std::get<FitTask>(task.what).seed;
  if (auto const wrong = stored_otherwise(session, task, seed, "calibrate")) throw UserError(*wrong);
  auto const summary = json::parse(read_whole_summary(folder));
  int const replications =
      interpreted(folder / "summary.json", [&] { return summary.at("settings").at("replications").get<int>(); });
  if (replications > options.replications)
    throw UserError(result_error("E6208",
                                 fmt::format("the calibration in `{}` has {} replications, more than {}", folder.string(),
                                             replications, options.replications),
                                 replace_results()));
  return replications == options.replications;
}

/// Of a back end whose settings say how many draws it keeps; else no refusal: the fits themselves are counted.
std::optional<Diagnostic> too_few_draws(Task const& task, FitTask const& what) {
  auto const& all = what.settings.all();
  for (char const* each : {"samples", "burn_in", "thin", "chains"})
    if (!all.contains(each)) return std::nullopt;
  std::int64_t const kept = (what.settings.integer("samples") - what.settings.integer("burn_in")) / what.settings.integer("thin") *
                            what.settings.integer("chains");
  if (kept >= CalibrationPlan().draws) return std::nullopt;
  return Diagnostic{
      Severity::error,
      "E6210",
      fmt::format("`{}` cannot be calibrated: it keeps {} draws, fewer than the {} among which a true value is ranked", task.name,
                  kept, CalibrationPlan().draws),
      Label{task.span, {}},
      {},
      "take more samples, or a smaller `thin`"};
}

/// Those that can be calibrated: of all of the file the others are skipped with a notice, one that is named alone is refused.
std::vector<int> possible_fits(Session& session, std::vector<int> const& fits) {
  std::vector<int> possible;
  Diagnostics refused;
  for (int const index : fits) {
    Task const& task = session.file.tasks[static_cast<std::size_t>(index)];
    FitTask const& what = std::get<FitTask>(task.what);
    Model const& model = session.file.models[static_cast<std::size_t>(what.model)];
    auto why = RecordMaker::refusal(session, task, what,
                                    load_experiments(session, what.experiments, model, what.start, what.prediction, what.solver));
    if (!why) why = too_few_draws(task, what);
    if (!why)
      possible.push_back(index);
    else
      refused.add(*why);
  }
  if (possible.empty()) throw UserError(refused.all().front());
  for (Diagnostic const& each : refused.all()) session.notices << "skipped: " << each.message << '\n';
  return possible;
}

/// All that can be refused is refused before the first begins.
ExitCode calibrate_all(Session& session, std::vector<int> const& fits, CalibrateOptions const& options) {
  // What a killed run had ready is put in its place before anyone looks.
  for (int const index : fits) (void)summary_stands(session.result_folder(session.file.tasks[static_cast<std::size_t>(index)]));
  ranks::wait_for_all();
  std::vector<int> open;
  ExitCode worst = ExitCode::success;
  for (int const index : possible_fits(session, fits)) {
    Task const& task = session.file.tasks[static_cast<std::size_t>(index)];
    if (kept(session, task, options))
      worst = std::max(worst, keep_complete(session, task));
    else
      open.push_back(index);
  }
  ranks::wait_for_all();  // before anything is written where another rank reads
  ClaimedFolders claimed;
  for (int const index : open)
    claimed.folders.emplace_back(session.result_folder(session.file.tasks[static_cast<std::size_t>(index)]), session.options);
  std::vector<std::unique_ptr<Calibration>> calibrations;
  for (int const index : open) {
    calibrations.push_back(std::make_unique<Calibration>(session, index, options));
    calibrations.back()->prepare();
  }
  ranks::wait_for_all();
  for (auto& calibration : calibrations) {
    ExitCode const code = calibration->run();
    if (code == ExitCode::interrupted) return code;
    worst = std::max(worst, code);
    calibration.reset();
  }
  return worst;
}

}  // namespace

ExitCode calibrate(Session& session, CalibrateOptions const& options) {
  try {
    std::vector<int> const fits = chosen_fits(session, options.task, "calibrate");
    check_preconditions(session, [&](Task const& task) {
      auto const index = static_cast<int>(&task - session.file.tasks.data());
      return std::find(fits.begin(), fits.end(), index) != fits.end();
    }).require();
    return calibrate_all(session, fits, options);
  } catch (Interrupted const&) {
    session.notices << "interrupted before the first replication; what is stored is kept\n";
    return ExitCode::interrupted;
  }
}

}  // namespace sysid
