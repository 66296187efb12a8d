// Splits a batch into blocks, runs them over the schedule, collects sums, records and outcomes.
#include "simulate/simulator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>

#include "simulate/block.hpp"
#include "simulate/thread_pool.hpp"

namespace sysid {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Dead lanes are looked for after every so many samples.
constexpr int burial_interval = 64;

/// Registers of a block beyond this do not stay in a 32 KiB first-level cache beside code and tables.
constexpr int cache_bytes = 28 * 1024;

/// Lane-instructions below which waking a thread costs more than it brings (about 20 us of work).
constexpr double small_job = 1e5;

}  // namespace

Simulator::Simulator(std::shared_ptr<SimulationProgram const> program, Schedule schedule, ExecutionOptions options)
    : program_(std::move(program)), schedule_(std::move(schedule)), options_(options) {
  if (options_.threads == 0) options_.threads = std::max(1u, std::thread::hardware_concurrency());
  if (options_.threads > 1) pool_ = std::make_shared<ThreadPool>(options_.threads);
}

void Simulator::for_each_block(int width, int samples, Work const& work) const {
  if (width == 0) return;
  double const instructions = work_per_sample(*program_, schedule_.solver()) * samples * width;
  bool const threaded = pool_ && instructions > small_job;
  int widest = options_.lanes;
  if (widest == 0) {
    widest = std::max(16, cache_bytes / 8 / std::max(1, program_->hot_registers));
    // Narrower blocks rather than idle threads, but not so narrow that the time goes into dispatch.
    if (threaded) widest = std::min(widest, std::max(16, (width + pool_->threads() - 1) / pool_->threads()));
  }
  Executor const executor =
      choose_executor(std::min(width, widest), options_.lanes == 0 ? widest : std::numeric_limits<int>::max());
  int const blocks = (width + executor.width - 1) / executor.width;
  auto const task = [&](int b) {
    int const lane = b * executor.width, lanes = std::min(executor.width, width - lane);
    Block block(*program_, schedule_, choose_executor(lanes, executor.width), lanes);  // the last one may be narrower
    work(block, lane, lanes);
  };
  if (threaded)
    pool_->run(blocks, task);
  else
    for (int b = 0; b < blocks; ++b) task(b);
}

void Simulator::sums(ConstLanes parameters, Lanes out, std::span<Outcome> outcome) const {
  int const end = schedule_.last_summed();
  for_each_block(parameters.width(), end, [&](Block& block, int lane, int lanes) {
    block.set_parameters(parameters.columns(lane, lanes));
    block.start();
    bool alive = true;
    for (int i = 0; i < end && alive; ++i) {
      block.observe(i);
      if (i + 1 < end) block.step(i);
      if ((i + 1) % burial_interval == 0 || i + 1 == end) alive = block.bury(i);
    }
    if (end == 0) block.bury(0);
    block.finish();
    ConstLanes const sums = block.sums();
    for (int w = 0; w < lanes; ++w) {
      Outcome& result = outcome[static_cast<std::size_t>(lane + w)];
      int const death = block.death()[static_cast<std::size_t>(w)];
      result = {death < 0, death, block.failure(w)};
      for (int r = 0; r < sums.rows() && result.ok; ++r)
        if (!std::isfinite(sums(r, w))) result = {false, std::max(0, end - 1), FailureClass::non_finite};
      for (int r = 0; r < sums.rows(); ++r) out(r, lane + w) = result.ok ? sums(r, w) : not_a_number;
    }
  });
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
  for (int i = 0; i < last && alive; ++i) {
    if (i > 0) draw(i);
    if (i >= first) {
      block.record(i);
      ConstLanes const now = block.records();
      for (int r = 0; r < records; ++r) std::copy_n(now.row(r).begin(), lanes, &out((i - first) * records + r, lane));
    }
    if ((i + 1) % burial_interval == 0 || i + 1 == last) alive = block.bury(i);
    if (i + 1 < last) block.step(i);
  }
  for (int w = 0; w < lanes; ++w) {
    int const death = block.death()[static_cast<std::size_t>(w)];
    outcome[static_cast<std::size_t>(lane + w)] = {death < 0, death, block.failure(w)};
    if (death < 0) continue;
    for (int r = 0; r < (last - first) * records; ++r) out(r, lane + w) = not_a_number;
  }
}

void Simulator::records(ConstLanes parameters, int first, int last, Lanes out, std::span<Outcome> outcome) const {
  for_each_block(parameters.width(), last, [&](Block& block, int lane, int lanes) {
    block.set_parameters(parameters.columns(lane, lanes));
    record_block(block, nullptr, lane, lanes, first, last, out, outcome);
  });
}

void Simulator::records_redrawn(Redraw const& redraw, int first, int last, Lanes out, std::span<Outcome> outcome) const {
  for_each_block(static_cast<int>(outcome.size()), last,
                 [&](Block& block, int lane, int lanes) { record_block(block, &redraw, lane, lanes, first, last, out, outcome); });
}

}  // namespace sysid
