// Splits a batch into blocks, runs them over the schedule, collects sums, records and outcomes.
#include "simulate/simulator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <thread>

#include "core/numeric/not_finite.hpp"
#include "core/ranks/own.hpp"
#include "core/system/interrupt.hpp"
#include "core/text/diagnostic.hpp"
#include "simulate/block.hpp"
#include "simulate/looks.hpp"
#include "simulate/machine_loop.hpp"
#include "simulate/settling.hpp"
#include "simulate/shared_work.hpp"
#include "simulate/thread_pool.hpp"

namespace sysid {
namespace {

/// Registers of a block beyond this do not stay in a 32 KiB first-level cache beside code and tables.
constexpr int cache_bytes = 28 * 1024;

/// Lane-instructions below which waking a thread costs more than it brings (about 20 us of work).
constexpr double small_job = 1e5;

/// Whether what steps take from their lengths is compiled with them: a few lengths are interpreted sooner.
bool many_lengths(SimulationProgram const& program, Schedule const& schedule, int width) {
  constexpr double batches = 1000;
  double const seconds = interpretation_time(work_of_lengths(program, schedule), width, choose_executor(width));
  return batches * seconds > length_compilation_time(program);
}

}  // namespace

WrittenLanes::WrittenLanes(Lanes out)
    : data(reinterpret_cast<std::byte*>(out.data())),
      rows(static_cast<std::size_t>(out.rows())),
      row_step(sizeof(double) * static_cast<std::size_t>(out.stride())),
      lane_step(sizeof(double)),
      size(sizeof(double)) {}

void do_blocks(std::span<Blocks const> pieces, ThreadPool* pool) {
  std::vector<std::function<void()> const*> blocks;
  double instructions = 0;
  for (Blocks const& each : pieces) {
    for (auto const& block : each.all) blocks.push_back(&block);
    instructions += each.instructions;
  }
  ranks::Apart const apart;
  if (pool != nullptr && instructions > small_job)
    pool->run(static_cast<int>(blocks.size()), [&, alone = ranks::on_its_own()](int b) {
      std::optional<ranks::Own> own;  // threads of the pool hear what the caller hears
      if (alone) own.emplace();
      (*blocks[static_cast<std::size_t>(b)])();
    });
  else
    for (auto const* block : blocks) (*block)();
}

void do_work(std::span<Work const> work, ThreadPool* pool) {
  if (!do_share(work, pool)) {
    std::vector<Blocks> pieces;
    for (Work const& each : work)
      if (each.width > 0) pieces.push_back(each.blocks(0, each.width));
    do_blocks(pieces, pool);
  }
  for (Work const& each : work)
    if (each.given_up != nullptr && each.given_up()) throw Interrupted();
}

std::string const& why_no_machine_code() { return native::why_unavailable(); }

std::shared_ptr<ThreadPool> make_pool(ExecutionOptions const& options) {
  int const threads = options.threads > 0 ? options.threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return threads > 1 ? std::make_shared<ThreadPool>(threads) : nullptr;
}

Simulator::Simulator(std::shared_ptr<SimulationProgram const> program, Schedule schedule, ExecutionOptions options,
                     std::shared_ptr<ThreadPool> pool)
    : program_(std::move(program)),
      schedule_(std::move(schedule)),
      options_(options),
      pool_(pool ? std::move(pool) : make_pool(options)),
      settled_(settled_simulator(*program_, schedule_, options_)) {}

int Simulator::threads() const { return pool_ ? pool_->threads() : 1; }

Executor Simulator::executor(int width, double instructions, native::LoopKind loop) const {
  if (options_.executor == ExecutorKind::scalar) return choose_executor(width, 1, ExecutorKind::scalar);
  if (options_.executor != ExecutorKind::lanes)
    if (auto const found = native(width, instructions, loop)) return *found;
  return interpreter(width, instructions);
}

void Simulator::expect(double lanes) const {
  constexpr int width = 16;  // of a batch as samplers make them
  if (options_.executor != ExecutorKind::automatic) return;
  double const instructions = work_per_sample(*program_, schedule_) * schedule_.last_summed();
  program_->machine_code->expect(interpretation_time(instructions, width, interpreter(width, instructions * width)) * lanes /
                                 width);
}

std::optional<Executor> Simulator::native(int width, double instructions, native::LoopKind loop) const {
  SolverSettings const& solver = schedule_.solver();
  if (!solver.row().in_program) return std::nullopt;  // nearly all the work is the solver's own
  int widest = options_.lanes > 0 ? options_.lanes : most_native_lanes(*program_);
  if (pool_ && options_.lanes == 0 && instructions > 4 * small_job)
    widest = std::min(widest, std::max(least_lanes(solver), (width + pool_->threads() - 1) / pool_->threads()));
  Executor const chosen = choose_executor(std::min(width, widest), std::numeric_limits<int>::max(), ExecutorKind::native);
  if (options_.executor == ExecutorKind::automatic) {
    double const seconds = interpretation_time(instructions / width, width, interpreter(width, instructions)),
                 of_lengths = many_lengths(*program_, schedule_, width) ? length_compilation_time(*program_) : 0;
    if (!program_->machine_code->pays(machine_loop_name(solver, chosen, loop), seconds,
                                      compilation_time(*program_, chosen) + of_lengths))
      return std::nullopt;
  }
  if (machine_loop(*program_, solver, chosen, loop) == nullptr) return std::nullopt;
  compile_length_loop(width);
  return chosen;
}

void Simulator::compile_length_loop(int width) const {
  if (schedule_.lengths().count() == 1) return;
  if (options_.executor == ExecutorKind::native || many_lengths(*program_, schedule_, width)) length_loop(*program_);
}

Executor Simulator::interpreter(int width, double instructions) const {
  int widest = options_.lanes;
  if (widest == 0) {
    widest = std::max(least_lanes(schedule_.solver()), cache_bytes / 8 / std::max(1, program_->hot_registers));
    // Narrower blocks rather than idle threads, but not so narrow that the time goes into dispatch.
    if (pool_ && instructions > small_job)
      widest = std::min(widest, std::max(least_lanes(schedule_.solver()), (width + pool_->threads() - 1) / pool_->threads()));
  }
  return choose_executor(std::min(width, widest), options_.lanes == 0 ? widest : std::numeric_limits<int>::max());
}

Work Simulator::blocks(int width, int samples, native::LoopKind loop, BlockWork const& work) const {
  Work result;
  if (width == 0) return result;
  double const each = work_per_sample(*program_, schedule_) * samples;
  result.width = width;
  result.given_up = given_up();
  result.instructions = each * width;
  result.grain = grain(schedule_.solver());
  result.blocks = [=, this](int first, int count) {
    Executor const executor = this->executor(count, each * count, loop);
    Blocks blocks;
    blocks.instructions = each * count / speed(executor);
    for (int lane = first; lane < first + count; lane += executor.width)
      blocks.all.push_back([this, work, executor, loop, lane, lanes = std::min(executor.width, first + count - lane)] {
        // The last one may be narrower.
        Block block(*program_, schedule_, narrowed(executor, lanes), lanes, loop, options_.stopped);
        work(block, lane, lanes);
      });
    return blocks;
  };
  return result;
}

void Simulator::give_up(int sample, int lane, int lanes, Lanes out, std::span<Outcome> outcome) {
  for (int w = lane; w < lane + lanes; ++w) {
    outcome[static_cast<std::size_t>(w)] = {false, sample, FailureClass::non_finite};
    for (int r = 0; r < out.rows(); ++r) out(r, w) = not_a_number;
  }
}

Work Simulator::sums_work(ConstLanes parameters, Lanes out, std::span<Outcome> outcome) const {
  return sums_to(schedule_.last_summed(), parameters, out, outcome);
}

Work Simulator::constant_sums_work(ConstLanes parameters, Lanes out, std::span<Outcome> outcome) const {
  if (program_->registers.accumulators > 0) throw InternalError("sums that read states, without a step");
  return sums_to(0, parameters, out, outcome);
}

Work Simulator::sums_to(int end, ConstLanes parameters, Lanes out, std::span<Outcome> outcome) const {
  Work result;
  if (settled_ && end > 0)
    result = blocks(parameters.width(), end, native::LoopKind::observe, [=, this](Block& block, int lane, int lanes) {
      SettlingLanes(*this, *settled_, block, out.columns(lane, lanes),
                    outcome.subspan(static_cast<std::size_t>(lane), static_cast<std::size_t>(lanes)))
          .run(parameters.columns(lane, lanes));
    });
  else
    result = blocks(parameters.width(), end, native::LoopKind::observe, [=, this](Block& block, int lane, int lanes) {
      block.set_parameters(parameters.columns(lane, lanes));
      block.start();
      bool alive = true;
      for (int from = 0; from < end && alive;) {
        if (stopped()) return give_up(from, lane, lanes, out, outcome);
        int const to = next_look(block, schedule_.solver().substeps, from, end);
        block.advance(from, to, end - 1);
        if (to % burial_interval == 0 || to == end) alive = block.bury(to - 1);
        from = to;
      }
      if (end == 0) block.bury(0);
      take_sums(block, end, out.columns(lane, lanes),
                outcome.subspan(static_cast<std::size_t>(lane), static_cast<std::size_t>(lanes)));
    });
  result.written = {out, outcome};
  return result;
}

void Simulator::take_sums(Block& block, int end, Lanes out, std::span<Outcome> outcome) {
  block.finish();
  ConstLanes const sums = block.sums();
  for (int w = 0; w < out.width(); ++w) {
    Outcome& result = outcome[static_cast<std::size_t>(w)];
    int const death = block.death()[static_cast<std::size_t>(w)];
    result = {death < 0, death, block.failure(w)};
    for (int r = 0; r < sums.rows() && result.ok; ++r)
      if (!std::isfinite(sums(r, w))) result = {false, std::max(0, end - 1), FailureClass::non_finite};
    for (int r = 0; r < sums.rows(); ++r) out(r, w) = result.ok ? sums(r, w) : not_a_number;
  }
}

void Simulator::sums(ConstLanes parameters, Lanes out, std::span<Outcome> outcome) const {
  Work const work = sums_work(parameters, out, outcome);
  do_work({&work, 1}, pool_.get());
}

void Simulator::record_block(Block& block, Redraw const* redraw, int lane, int lanes, int first, int last, Lanes out,
                             std::span<Outcome> outcome) const {
  LaneArray drawn(redraw != nullptr ? program_->registers.parameters : 0, lanes);
  auto const draw = [&](int sample) {
    if (redraw == nullptr) return;
    (*redraw)(sample, lane, drawn);
    block.set_parameters(drawn);
  };
  draw(0);
  block.start();
  int const records = program_->registers.records;
  bool alive = true;
  for (int from = 0; from < last && alive;) {
    if (stopped()) return give_up(from, lane, lanes, out, outcome);
    if (from > 0) draw(from);
    int to = redraw != nullptr ? from + 1 : next_look(block, schedule_.solver().substeps, from, last);
    if (from < first) to = std::min(to, first);
    if (from < first) {
      block.step_to(from, to - 1);
      block.pass(to - 1);
    } else {
      block.record(from, to, {&out((from - first) * records, lane), (to - from) * records, lanes, out.stride()});
    }
    if (to % burial_interval == 0 || to == last) alive = block.bury(to - 1);
    if (to < last) block.step(to - 1);
    from = to;
  }
  for (int w = 0; w < lanes; ++w) {
    int const death = block.death()[static_cast<std::size_t>(w)];
    outcome[static_cast<std::size_t>(lane + w)] = {death < 0, death, block.failure(w)};
    if (death < 0) continue;
    for (int r = 0; r < (last - first) * records; ++r) out(r, lane + w) = not_a_number;
  }
}

Work Simulator::records_work(ConstLanes parameters, int first, int last, Lanes out, std::span<Outcome> outcome) const {
  Work result = blocks(parameters.width(), last, native::LoopKind::record, [=, this](Block& block, int lane, int lanes) {
    block.set_parameters(parameters.columns(lane, lanes));
    record_block(block, nullptr, lane, lanes, first, last, out, outcome);
  });
  result.written = {out, outcome};
  return result;
}

void Simulator::records(ConstLanes parameters, int first, int last, Lanes out, std::span<Outcome> outcome) const {
  Work const work = records_work(parameters, first, last, out, outcome);
  do_work({&work, 1}, pool_.get());
}

void Simulator::records_ahead(ConstLanes parameters, Schedule const& uncorrected, int ahead, Lanes out,
                              std::span<Outcome> outcome) const {
  int const samples = schedule_.samples(), records = program_->registers.records;
  auto const along = [=, this, &uncorrected](Block& block, int lane, int lanes) {
    // From each sample a second block goes on without corrections.
    Block free(*program_, uncorrected, block.executor(), lanes, native::LoopKind::record, options_.stopped);
    block.set_parameters(parameters.columns(lane, lanes));
    free.set_parameters(parameters.columns(lane, lanes));
    block.start();
    free.start();
    auto const record = [&](int sample) {
      free.record(sample, sample + 1, {&out(sample * records, lane), records, lanes, out.stride()});
    };
    for (int i = 0; i < std::min(ahead, samples); ++i) {
      record(i);
      if (i + 1 < samples) free.step(i);
    }
    bool alive = true;
    for (int from = 0; from + ahead < samples && alive; ++from) {
      if (stopped()) return give_up(from, lane, lanes, out, outcome);
      block.pass(from);
      free.take_states(block.states());
      for (int i = from; i < from + ahead; ++i) free.step(i);
      record(from + ahead);
      block.step(from);
      if ((from + 1) % burial_interval == 0) alive = block.bury(from + 1);
    }
    if (alive) block.bury(samples - 1);
    for (int w = 0; w < lanes; ++w) {
      int const death = block.death()[static_cast<std::size_t>(w)];
      outcome[static_cast<std::size_t>(lane + w)] = {death < 0, death, block.failure(w)};
      for (int r = 0; death >= 0 && r < samples * records; ++r) out(r, lane + w) = not_a_number;
    }
  };
  Work work = blocks(parameters.width(), samples * (1 + ahead), native::LoopKind::record, along);
  work.written = {out, outcome};
  do_work({&work, 1}, pool_.get());
}

void Simulator::records_redrawn(Redraw const& redraw, int first, int last, Lanes out, std::span<Outcome> outcome) const {
  Work work = blocks(static_cast<int>(outcome.size()), last, native::LoopKind::record,
                     [=, this, &redraw](Block& block, int lane, int lanes) {
                       record_block(block, &redraw, lane, lanes, first, last, out, outcome);
                     });
  work.written = {out, outcome};
  do_work({&work, 1}, pool_.get());
}

}  // namespace sysid
