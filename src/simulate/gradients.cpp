// Forwards with a tape of states, then backwards; in parts, from states at checkpoints, where the tape is shorter than the record.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

#include "core/numeric/not_finite.hpp"
#include "simulate/block.hpp"
#include "simulate/looks.hpp"
#include "simulate/simulator.hpp"

namespace sysid {
namespace {

/// Samples of a part: whole intervals between looks for dead lanes, so that a part begins where lanes have been buried.
int part_length(std::size_t tape_bytes, std::size_t row, int end) {
  auto const fitting = static_cast<int>(std::min<std::size_t>(tape_bytes / (8 * row), static_cast<std::size_t>(end)));
  return fitting >= end ? end : std::max(1, fitting / burial_interval) * burial_interval;
}

/// Memory as it comes, on a cache line: to write zeros first would take as long as a part of the work.
struct Free {
  void operator()(double* p) const { std::free(p); }
};
std::unique_ptr<double, Free> doubles(std::size_t count) {
  std::unique_ptr<double, Free> memory(static_cast<double*>(std::aligned_alloc(64, (8 * count + 63) / 64 * 64)));
  if (!memory) throw std::bad_alloc();
  return memory;
}

}  // namespace

Work Simulator::gradients_work(ConstLanes parameters, Lanes out, Lanes slopes, std::span<Outcome> outcome) const {
  Work result =
      blocks(parameters.width(), schedule_.last_summed(), native::LoopKind::tape, [=, this](Block& block, int lane, int lanes) {
        block.set_parameters(parameters.columns(lane, lanes));
        run_gradient(block, out.columns(lane, lanes), slopes.columns(lane, lanes),
                     outcome.subspan(static_cast<std::size_t>(lane), static_cast<std::size_t>(lanes)));
      });
  result.written = {out, slopes, outcome};
  return result;
}

void Simulator::run_gradient(Block& block, Lanes out, Lanes slopes, std::span<Outcome> outcome) const {
  int const end = schedule_.last_summed(), lanes = out.width(), substeps = schedule_.solver().substeps;
  std::size_t const row = block.tape_row(), states = row / static_cast<std::size_t>(substeps);
  int const part = part_length(options_.tape_bytes, row, end);
  auto const tape = doubles(std::max<std::size_t>(1, static_cast<std::size_t>(part)) * row);
  std::vector<double> checkpoints;
  auto const give_up_at = [&](int sample) {
    give_up(sample, 0, lanes, out, outcome);
    for (int r = 0; r < slopes.rows(); ++r) std::fill(slopes.row(r).begin(), slopes.row(r).end(), not_a_number);
  };

  block.start();
  bool alive = true;
  for (int from = 0; from < end && alive;) {
    if (stopped()) return give_up_at(from);
    if (from % part == 0) {
      checkpoints.resize(checkpoints.size() + states);
      block.copy_states(checkpoints.data() + checkpoints.size() - states);
    }
    int const to = next_look(block, substeps, from, end);
    block.advance_to_tape(from, to, end - 1, true, tape.get() + static_cast<std::size_t>(from % part) * row);
    if (to % burial_interval == 0 || to == end) alive = block.bury(to - 1);
    from = to;
  }
  if (end == 0) block.bury(0);
  take_sums(block, end, out, outcome);

  block.start_reverse();
  for (int first = end > 0 ? (end - 1) / part * part : -1; first >= 0 && alive; first -= part) {
    int const last = std::min(first + part, end);
    if (last < end) {  // the tape holds a later part
      block.put_states(checkpoints.data() + static_cast<std::size_t>(first / part) * states);
      for (int from = first; from < last;) {
        if (stopped()) return give_up_at(from);
        int const to = next_look(block, substeps, from, last);
        block.advance_to_tape(from, to, end - 1, false, tape.get() + static_cast<std::size_t>(from - first) * row);
        from = to;
      }
    }
    for (int to = last; to > first;) {
      if (stopped()) return give_up_at(to - 1);
      int const from = std::max(first, to - burial_interval);
      block.reverse(from, to, end - 1, tape.get() + static_cast<std::size_t>(from - first) * row);
      to = from;
    }
  }
  block.finish_reverse();
  ConstLanes const found = block.slopes();
  for (int w = 0; w < lanes; ++w) {
    Outcome& result = outcome[static_cast<std::size_t>(w)];
    for (int k = 0; k < slopes.rows(); ++k) slopes(k, w) = found(k, w);
    for (ReverseSections::Direct const& direct : program_->reverse.direct) slopes(direct.slope, w) += out(direct.row, w);
    for (int k = 0; k < slopes.rows() && result.ok; ++k)
      if (!std::isfinite(slopes(k, w))) result = {false, std::max(0, end - 1), FailureClass::non_finite};
    for (int k = 0; k < slopes.rows() && !result.ok; ++k) slopes(k, w) = not_a_number;
    for (int r = 0; r < out.rows() && !result.ok; ++r) out(r, w) = not_a_number;
  }
}

}  // namespace sysid
