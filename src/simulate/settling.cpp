// Lanes change programs one by one, each at a look of its own.
#include "simulate/settling.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/numeric/not_finite.hpp"
#include "simulate/looks.hpp"
#include "simulate/machine_loop.hpp"

namespace sysid {
namespace {

/// Of a standard deviation: entries of a covariance that change by less between two looks are taken for their limits. What is left
/// to come is as much times the samples that a filter remembers; in a log likelihood it is below 1e-9.
constexpr double settled_change = 1e-12;

}  // namespace

std::shared_ptr<Simulator const> settled_simulator(SimulationProgram const& program, Schedule const& schedule,
                                                   ExecutionOptions const& options) {
  if (!program.settled || !schedule.solver().fixed_step()) return nullptr;
  int const samples = schedule.last_summed() - schedule.without_gaps();
  if (samples < least_settling_samples) return nullptr;
  // Equations that know the length of each step know how far the times of a record are from equal ones.
  bool const by_steps = !program.source.map || (program.source.stepped && !schedule.solver().row().exact);
  if (by_steps && unequal_step(schedule.experiment().time) != 0) return nullptr;
  if (schedule.lengths().count() > 1) return nullptr;
  std::shared_ptr<SimulationProgram const> const settled(program.settled, &program.settled->program);
  ExecutionOptions alone = options;
  alone.threads = 1;
  auto result = std::make_shared<Simulator const>(settled, Schedule(*settled, schedule.experiment(), schedule.solver()), alone);
  std::size_t const channels = program.source.channels.size();  // sums of data alone are of whole records
  if (schedule.epilogue_row().size() != channels || result->schedule().epilogue_row().size() != channels) return nullptr;
  return result;
}

SettlingLanes::SettlingLanes(Simulator const& whole, Simulator const& settled, Block& block, Lanes out, std::span<Outcome> outcome)
    : whole_(whole),
      settled_(settled),
      program_(*whole.program().settled),
      block_(block),
      out_(out),
      outcome_(outcome),
      begin_(whole.schedule().without_gaps()),
      end_(whole.schedule().last_summed()),
      at_(whole.program().registers.states, out.width()),
      since_(static_cast<std::size_t>(out.width()), -1) {}

void SettlingLanes::leave(int lane, bool ok, int sample) {
  for (int r = 0; r < out_.rows() && ok; ++r) ok = std::isfinite(out_(r, lane));
  outcome_[static_cast<std::size_t>(lane)] = {ok, ok ? -1 : sample, FailureClass::non_finite};
  for (int r = 0; r < out_.rows() && !ok; ++r) out_(r, lane) = not_a_number;
}

void SettlingLanes::run(ConstLanes parameters) {
  parameters_ = parameters;
  block_.set_parameters(parameters);
  block_.start();
  run_whole();
  if (whole_.stopped()) {
    for (int w = 0; w < lanes(); ++w) leave(w, false, end_ - 1);
    return;
  }
  int const settled = static_cast<int>(std::ranges::count_if(since_, [](int since) { return since >= 0; }));
  if (settled == 0) return;
  double const instructions = work_per_sample(settled_.program(), settled_.schedule()) * (end_ - begin_) * lanes();
  Executor const executor = settled_.executor(lanes(), instructions, native::LoopKind::observe);
  for (int first = 0; first < lanes(); first += executor.width)
    run_settled(first, std::min(executor.width, lanes() - first), executor);
}

/// Until every lane has settled or died, or to the end.
void SettlingLanes::run_whole() {
  bool alive = true, all = false;
  for (int from = 0; from < end_ && alive && !all;) {
    if (whole_.stopped()) return;
    int const look_at = (from / settling_interval + 1) * settling_interval;
    int const to = std::min(next_look(block_, whole_.schedule().solver().substeps, from, end_), look_at);
    block_.advance(from, to, end_ - 1);
    if (to % burial_interval == 0 || to == end_) alive = block_.bury(to - 1);
    if (to == look_at && to < end_ && to >= begin_) {
      look(to);
      all = true;
      for (int w = 0; w < lanes(); ++w)
        all = all && (since_[static_cast<std::size_t>(w)] >= 0 || block_.death()[static_cast<std::size_t>(w)] >= 0);
    }
    from = to;
  }
  if (!all) block_.finish();
  for (int w = 0; w < lanes(); ++w)
    if (since_[static_cast<std::size_t>(w)] < 0) take(w, end_);
}

void SettlingLanes::look(int sample) {
  if (before_.rows() > 0) {
    bool fresh = false;
    for (int w = 0; w < lanes(); ++w) {
      int& since = since_[static_cast<std::size_t>(w)];
      if (since >= 0 || block_.death()[static_cast<std::size_t>(w)] >= 0 || !has_settled(w)) continue;
      if (!std::exchange(fresh, true)) block_.finish(whole_.schedule().counts(0, sample));
      since = sample;
      for (int r = 0; r < at_.rows(); ++r) at_(r, w) = block_.states()(r, w);
      take(w, sample);
    }
  } else {
    before_ = LaneArray(at_.rows(), at_.width());
  }
  for (int r = 0; r < before_.rows(); ++r) std::copy_n(block_.states().row(r).begin(), lanes(), before_.row(r).begin());
}

/// Changes as parts of standard deviations; of an entry of U times the sd that it multiplies, of one of D, whose relative error is
/// small, between that sd and the state's own.
bool SettlingLanes::has_settled(int lane) const {
  std::vector<SettlingState> const& entries = whole_.program().source.settling;
  ConstLanes const now = block_.states();
  int size = 0;
  for (SettlingState const& each : entries) size = std::max(size, each.row + 1);
  std::vector<double> diagonal(static_cast<std::size_t>(size)), variance(static_cast<std::size_t>(size));
  for (SettlingState const& each : entries)
    if (each.row == each.column) diagonal[static_cast<std::size_t>(each.row)] = now(each.state, lane);
  for (SettlingState const& each : entries) {
    double const value = now(each.state, lane), d = diagonal[static_cast<std::size_t>(each.row)];
    if (each.row == each.column)
      variance[static_cast<std::size_t>(each.row)] += d;
    else if (each.factored)
      variance[static_cast<std::size_t>(each.column)] += value * value * d;
  }
  return std::ranges::all_of(entries, [&](SettlingState const& each) {
    double const change = now(each.state, lane) - before_(each.state, lane);
    auto const row = static_cast<std::size_t>(each.row), column = static_cast<std::size_t>(each.column);
    double const squared = !each.factored            ? change * change / (variance[row] * variance[column])
                           : each.row == each.column ? change * change / (diagonal[row] * variance[row])
                                                     : change * change * diagonal[row] / variance[column];
    return change == 0 || squared <= settled_change * settled_change;
  });
}

/// The sums of a lane from the beginning to before `sample`, which the block has just finished.
void SettlingLanes::take(int lane, int sample) {
  ConstLanes const sums = block_.sums();
  int const death = block_.death()[static_cast<std::size_t>(lane)];
  for (int r = 0; r < out_.rows(); ++r) out_(r, lane) = sums(r, lane);
  leave(lane, death < 0, death < 0 ? std::max(0, sample - 1) : death);
}

void SettlingLanes::run_settled(int first, int lanes, Executor executor) {
  std::vector<int> starts;
  for (int w = first; w < first + lanes; ++w)
    if (int const since = since_[static_cast<std::size_t>(w)]; since >= 0) starts.push_back(since);
  if (starts.empty()) return;
  std::ranges::sort(starts);
  starts.erase(std::ranges::unique(starts).begin(), starts.end());
  int const given = whole_.program().registers.parameters, fixed = static_cast<int>(program_.fixed.size()),
            moving = static_cast<int>(program_.moving.size());
  LaneArray parameters(given + fixed, lanes);
  int model = first;  // a lane that has not settled computes what this one does
  while (since_[static_cast<std::size_t>(model)] < 0) ++model;
  for (int w = 0; w < lanes; ++w) {
    int const from = since_[static_cast<std::size_t>(first + w)] < 0 ? model : first + w;
    for (int r = 0; r < given; ++r) parameters(r, w) = parameters_(r, from);
    for (int r = 0; r < fixed; ++r) parameters(given + r, w) = at_(program_.fixed[static_cast<std::size_t>(r)], from);
  }
  Block block(settled_.program(), settled_.schedule(), narrowed(executor, lanes), lanes, native::LoopKind::observe,
              whole_.options().stopped);
  block.set_parameters(parameters);
  block.start();
  std::vector<double> states(static_cast<std::size_t>(moving));
  auto next = starts.begin();
  for (int from = starts.front(); from < end_;) {
    if (whole_.stopped()) return;
    for (int w = 0; w < lanes && next != starts.end() && from == *next; ++w) {
      if (since_[static_cast<std::size_t>(first + w)] != from) continue;
      for (int r = 0; r < moving; ++r)
        states[static_cast<std::size_t>(r)] = at_(program_.moving[static_cast<std::size_t>(r)], first + w);
      block.enter(w, states);
    }
    if (next != starts.end() && from == *next) ++next;
    int const to =
        std::min(next_look(block, settled_.schedule().solver().substeps, from, end_), next == starts.end() ? end_ : *next);
    block.advance(from, to, end_ - 1);
    from = to;
  }
  for (int const start : starts) {
    block.finish(settled_.schedule().counts(start, end_));
    for (int w = 0; w < lanes; ++w) {
      if (since_[static_cast<std::size_t>(first + w)] != start || !outcome_[static_cast<std::size_t>(first + w)].ok) continue;
      for (int r = 0; r < out_.rows(); ++r) out_(r, first + w) += block.sums()(r, w);
      leave(first + w, true, end_ - 1);
    }
  }
}

}  // namespace sysid
