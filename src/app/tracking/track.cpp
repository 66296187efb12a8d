// Rows of a record at once, or as they are appended; each into the table, some into the figures, alarms into both.
#include "app/tracking/track.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>

#include "app/session/provenance.hpp"
#include "app/session/reporting.hpp"
#include "app/session/results.hpp"
#include "app/tracking/followed_rows.hpp"
#include "app/tracking/track_report.hpp"
#include "app/tracking/track_table.hpp"
#include "core/system/files.hpp"
#include "core/system/interrupt.hpp"
#include "data/input_rule.hpp"
#include "data/table/table.hpp"
#include "data/table_record.hpp"
#include "experiment/record_request.hpp"
#include "model/lags.hpp"
#include "report/file/csv.hpp"

namespace sysid {
namespace {

constexpr std::size_t rows_together = 1024;

/// The columns of the fit's data block, of another file where one is named.
DataBlock followed_block(Session const& session, TrackedFit const& fit) {
  DataBlock block = fit.block(session);
  if (!fit.options.record.empty() && fit.options.record != "-")
    block.path = std::filesystem::absolute(fit.options.record).lexically_normal().string();
  return block;
}

class Tracking {
 public:
  Tracking(Session& session, TrackedFit const& fit, Report head)
      : session_(session),
        fit_(fit),
        block_(followed_block(session, fit)),
        units_(units_of(fit.model(), fit.tracked)),
        table_(session.result_folder(*fit.task), units_, csv_head(head), lives()),
        gathered_(fit, units_) {}

  GatheredTrack run() {
    if (lives())
      follow();
    else
      whole();
    if (gathered_.rows == 0 && waiting_ > 0) throw too_few_rows();
    if (gathered_.rows == 0)
      throw no_tracking(fmt::format("the file has no rows from row {} on", fit_.options.first_row), "choose other --rows");
    table_.finish();
    return std::move(gathered_);
  }
  std::vector<std::string> taken_over() { return table_.taken_over(); }

 private:
  bool lives() const { return fit_.options.follow || fit_.options.record == "-"; }
  Model const& model() const { return fit_.model(); }
  static UserError too_few_rows() { return no_tracking("tracking needs at least two rows", "choose more --rows"); }

  /// Where it is known how the record begins, else somewhere along that of the fit.
  StatePrior first_states(Experiment const& experiment, std::int64_t rows_before) const {
    bool const known =
        fit_.options.at_rest || (fit_.options.record.empty() && rows_before + experiment.first_row == fit_.fitted_from &&
                                 fit_.fit->start.kind != StartRule::Kind::estimated);
    return known ? fit_.at_rest(experiment) : fit_.states;
  }

  void take(Experiment const& experiment, int from, std::int64_t rows_before) {
    if (!tracker_) {
      ExecutionOptions execution = session_.interruptible();
      execution.stopped = nullptr;  // a chunk takes milliseconds
      execution.threads = 1;
      tracker_.emplace(fit_.program, fit_.solver, execution, fit_.prior,
                       first_states(slice(experiment, from, static_cast<int>(experiment.time.size()), lag()), rows_before),
                       fit_.tracking);
      gathered_.threshold = tracker_->detector().threshold();
    }
    tracker_->take(
        experiment, from,
        [&](TrackedRow const& row) {
          table_.add(row);
          gathered_.add(row);
          for (std::string const& line : gathered_.lines(row)) session_.notices << line << '\n' << std::flush;
        },
        rows_before);
  }

  void whole() {
    DataBlock block = block_;
    block.parts = {{"tracked", fit_.options.first_row, fit_.options.last_row, block.span}};
    Record const record = load_record(block, model(), session_.folder());
    gathered_.file = block.path;
    gathered_.digest = record.digest;
    Experiment const experiment = cut(record, block, model(), 0, {StartRule::Kind::rest, 0});
    gathered_.time_unit = experiment.time_unit;
    if (experiment.time.size() < 2) throw too_few_rows();
    take(experiment, 0, 0);
  }

  // --- as rows arrive
  void follow() {
    for (InputSignal const& input : signals_of_rules())
      if (row_of(input.rule()).degree > 1)
        throw no_tracking(
            fmt::format("the input rule `{}` needs later samples, so the record cannot be followed", rule_name(input.rule())),
            "write `hold zero_order` or `hold linear` in the data block to follow a record");
    if (needs_whole_file(block_.rules))
      throw no_tracking("the data block has `read` with settings that need the whole file",
                        "for rows that arrive, only these settings of `read` are possible: `separator`, `decimal`, `thousands`, "
                        "`missing`, `ragged` and `units = names`");
    bool const standard_input = fit_.options.record == "-";
    auto const path = standard_input ? std::filesystem::path("-") : session_.folder() / block_.path;
    gathered_.file = standard_input ? "standard input" : block_.path;
    FollowedRows lines(path, fit_.options.follow);
    for (;;) {
      std::vector<std::string> const rows = lines.next(rows_together);
      if (rows.empty()) return;
      for (std::string const& row : rows) {
        ++read_;
        if (fit_.options.last_row == 0 || read_ <= fit_.options.last_row) kept_.push_back(row);
        if (read_ >= fit_.options.first_row) waiting_ += fit_.options.last_row == 0 || read_ <= fit_.options.last_row ? 1 : 0;
        // Of rows that are not tracked only those stay that a model looks back to.
        while (waiting_ == 0 && static_cast<int>(kept_.size()) > lag() + 1) kept_.pop_front(), ++gone_;
      }
      try {
        take_kept(lines.header());
      } catch (Interrupted const&) {  // the end of a track that follows; the table holds the rows so far
        return;
      }
      if (fit_.options.last_row > 0 && read_ >= fit_.options.last_row) return;
    }
  }

  std::vector<InputSignal> signals_of_rules() const {
    std::vector<InputSignal> signals;
    for (DataInputUse const& input : block_.inputs)
      if (input.rule && row_of(*input.rule).degree > 1)
        signals.emplace_back(*input.rule, std::vector{0.0, 1.0}, std::vector{0.0, 0.0});
    return signals;
  }

  int lag() const { return data_lag(model()); }

  void take_kept(std::string const& header) {
    if (waiting_ == 0 || static_cast<int>(kept_.size()) < lag() + 2) return;
    std::string text = header;
    for (std::string const& row : kept_) text += row + '\n';
    Diagnostics diagnostics;
    std::optional<Record> const record =
        read_record(record_request(block_, model(), session_.folder()),
                    Table::parse(gathered_.file, std::move(text), block_.path_span, gone_, block_.rules), diagnostics);
    if (!record) throw UnusableData(std::move(diagnostics));
    require_steps(*record, block_, model());
    Experiment experiment = cut(*record, block_, model(), -1, {StartRule::Kind::rest, 0});
    if (!block_.time)
      for (double& time : experiment.time)
        time += static_cast<double>(gone_) * (block_.step > 0 ? block_.step : model().step.value_or(1));
    gathered_.time_unit = experiment.time_unit;
    int const from = static_cast<int>(kept_.size()) - waiting_ - lag();
    take(experiment, std::max(0, from), gone_);
    waiting_ = 0;
    while (static_cast<int>(kept_.size()) > lag() + 1) kept_.pop_front(), ++gone_;
  }

  Session& session_;
  TrackedFit const& fit_;
  DataBlock block_;
  TrackedUnits units_;
  TrackTable table_;
  GatheredTrack gathered_;
  std::optional<Tracker> tracker_;
  std::deque<std::string> kept_;      // lines: those before what waits, then what waits
  std::int64_t read_ = 0, gone_ = 0;  // rows
  int waiting_ = 0;
};

}  // namespace

ExitCode track(Session& session, TrackOptions const& options) {
  auto const began = std::chrono::steady_clock::now();
  Task const& task = task_of_result(session, options.result);
  auto const folder = session.options.output / task.name;
  ClaimedFolder const claimed(folder, session.options);
  try {
    TrackedFit const fit = tracked_fit(session, options);
    session.find_results_in(folder, task);
    Report report = track_head(session, fit);
    Tracking tracking(session, fit, report);
    GatheredTrack const gathered = tracking.run();
    fill_report(session, fit, gathered, report);
    std::chrono::duration<double> const wall = std::chrono::steady_clock::now() - began;
    report.timing.emplace_back("wall_seconds", wall.count());
    report.timing.emplace_back("rows_per_second", static_cast<double>(gathered.rows) / wall.count());
    keep_result(session, task, report, tracking.taken_over());
    return gathered.changed() ? ExitCode::doubtful : ExitCode::success;
  } catch (Interrupted const&) {
    session.notices << fmt::format("{}: interrupted; nothing is kept\n", task.name);
    return ExitCode::interrupted;
  }
}

}  // namespace sysid
