// Crews of lanes, segment by segment.
#include "simulate/wavefront.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/numeric/not_finite.hpp"
#include "simulate/block.hpp"
#include "simulate/machine_loop.hpp"

namespace sysid {
namespace {

/// Samples between two looks at the lanes. Short enough that a hopeless lane costs little, long enough that moving lanes costs
/// nothing.
constexpr int segment = 50;

/// Blocks that a crew fills at the start: enough that closing ranks pays, few enough that its lanes stay in the second-level cache.
constexpr int blocks_per_crew = 8;

class Crew {
 public:
  Crew(Simulator const& simulator, ConstLanes parameters, Wanted const& wanted, int first, Lanes out, std::span<Ending> endings,
       std::span<int> failed_at, Executor executor)
      : simulator_(simulator),
        program_(simulator.program()),
        schedule_(simulator.schedule()),
        parameters_(parameters),
        wanted_(wanted),
        first_(first),
        out_(out),
        endings_(endings),
        failed_at_(failed_at),
        executor_(executor),
        stopped_(simulator.options().stopped),
        block_lanes_(executor.width),
        end_(schedule_.last_summed()) {}

  void run() {
    if (!schedule_.solver().fixed_step()) return run_in_place();
    int const lanes = parameters_.width();
    at_.resize(static_cast<std::size_t>(lanes));
    std::iota(at_.begin(), at_.end(), 0);
    LaneArray now(program_.registers.carried(), lanes);
    for_blocks(lanes, [&](Block& block, int lane, int count) {
      block.set_parameters(parameters_.columns(lane, count));
      block.start();
      block.store(now.view().columns(lane, count));
    });
    for (int from = 0; from < end_ && !at_.empty() && !simulator_.stopped(); from += segment) {
      int const to = std::min(from + segment, end_);
      std::vector<std::uint8_t> stays(at_.size());
      for_blocks(static_cast<int>(at_.size()), [&](Block& block, int lane, int count) {
        block.load(now.view().columns(lane, count));
        advance(block, from, to);
        block.store(now.view().columns(lane, count));
        look(block, to, lane, count, stays);
      });
      close_ranks(now, stays);
    }
    if (end_ == 0)
      for (int const lane : at_) end(lane, Ending::finished, -1);
  }

 private:
  /// A block for each width that occurs: a full one, and a last one.
  template <class Action>
  void for_blocks(int lanes, Action const& action) {
    for (int lane = 0; lane < lanes; lane += block_lanes_) {
      int const count = std::min(block_lanes_, lanes - lane);
      if (count == block_lanes_) {
        if (!full_) full_.emplace(program_, schedule_, executor_, block_lanes_, native::LoopKind::observe, stopped_);
        action(*full_, lane, count);
      } else {
        Block last(program_, schedule_, narrowed(executor_, count), count, native::LoopKind::observe, stopped_);
        action(last, lane, count);
      }
    }
  }

  /// Samples [from, to), and the step to `to`. Machine code in one go, all else sample by sample, to be stopped anywhere.
  void advance(Block& block, int from, int to) const {
    if (block.runs_loops())
      block.advance(from, to, end_ - 1);
    else
      for (int i = from; i < to && !simulator_.stopped(); ++i) block.advance(i, i + 1, end_ - 1);
    if (to == end_) block.finish();
  }

  void read_sums(Block const& block, int sample, int count, LaneArray& sums) const {
    if (sample == end_) {
      ConstLanes const final = block.sums();
      for (int r = 0; r < sums.rows(); ++r) std::copy_n(final.row(r).begin(), count, sums.row(r).begin());
      return;
    }
    ConstLanes const accumulators = block.accumulators();
    for (int r = 0; r < sums.rows(); ++r) {
      auto const& running = program_.running_sums[static_cast<std::size_t>(r)];
      if (!running) continue;
      for (int w = 0; w < count; ++w) sums(r, w) = running->factor * accumulators(running->accumulator, w);
    }
  }

  static bool finite(ConstLanes values, int lane) {
    for (int r = 0; r < values.rows(); ++r)
      if (!std::isfinite(values(r, lane))) return false;
    return true;
  }

  /// Whether a lane goes on from here: notes its sums, and its ending when it does not.
  bool goes_on(int lane, bool alive, ConstLanes sums, int column, int sample) {
    for (int r = 0; r < sums.rows(); ++r) out_(r, lane) = sums(r, column);
    if (!alive || !finite(sums, column))
      end(lane, Ending::failed, sample - 1);
    else if (!wanted_(sums, column, first_ + lane))
      end(lane, Ending::given_up, -1);
    else if (sample == end_)
      end(lane, Ending::finished, -1);
    else
      return true;
    return false;
  }

  /// Which lanes of a block, at places [lane, lane + count) of the crew, stay.
  void look(Block const& block, int sample, int lane, int count, std::vector<std::uint8_t>& stays) {
    LaneArray sums(program_.sum_count(), count);
    read_sums(block, sample, count, sums);
    for (int w = 0; w < count; ++w) {
      auto const place = static_cast<std::size_t>(lane + w);
      stays[place] = goes_on(at_[place], finite(block.states(), w), sums, w, sample) ? 1 : 0;
    }
  }

  void close_ranks(LaneArray& now, std::vector<std::uint8_t> const& stays) {
    std::size_t kept = 0;
    for (std::size_t w = 0; w < at_.size(); ++w) {
      if (stays[w] == 0) continue;
      if (kept != w)
        for (int r = 0; r < now.rows(); ++r) now(r, static_cast<int>(kept)) = now(r, static_cast<int>(w));
      at_[kept++] = at_[w];
    }
    at_.resize(kept);
  }

  void end(int lane, Ending how, int sample) {
    endings_[static_cast<std::size_t>(lane)] = how;
    failed_at_[static_cast<std::size_t>(lane)] = sample;
    if (how == Ending::failed)
      for (int r = 0; r < out_.rows(); ++r) out_(r, lane) = not_a_number;
  }

  void run_in_place() {
    for (int lane = 0; lane < parameters_.width(); lane += block_lanes_) {
      int const count = std::min(block_lanes_, parameters_.width() - lane);
      Block block(program_, schedule_, narrowed(executor_, count), count, native::LoopKind::observe, stopped_);
      at_.resize(static_cast<std::size_t>(count));
      std::iota(at_.begin(), at_.end(), lane);
      block.set_parameters(parameters_.columns(lane, count));
      block.start();
      std::vector<std::uint8_t> running(static_cast<std::size_t>(count), 1);
      for (int from = 0; from < end_ && std::count(running.begin(), running.end(), 1) > 0 && !simulator_.stopped();
           from += segment) {
        int const to = std::min(from + segment, end_);
        advance(block, from, to);
        block.bury(to - 1);
        look_in_place(block, to, count, running);
      }
    }
  }

  void look_in_place(Block const& block, int sample, int count, std::vector<std::uint8_t>& running) {
    LaneArray sums(program_.sum_count(), count);
    read_sums(block, sample, count, sums);
    for (int w = 0; w < count; ++w) {
      auto const place = static_cast<std::size_t>(w);
      if (running[place] != 0) running[place] = goes_on(at_[place], block.death()[place] < 0, sums, w, sample) ? 1 : 0;
    }
  }

  Simulator const& simulator_;
  SimulationProgram const& program_;
  Schedule const& schedule_;
  ConstLanes parameters_;
  Wanted const& wanted_;
  int first_;  // of the batch
  Lanes out_;
  std::span<Ending> endings_;
  std::span<int> failed_at_;
  Executor executor_;
  bool (*stopped_)();
  int block_lanes_, end_;
  std::vector<int> at_;  // the lanes of the crew that still run, in order
  std::optional<Block> full_;
};

}  // namespace

Work wavefront_work(Simulator const& simulator, ConstLanes parameters, Wanted wanted, Lanes out, std::span<Ending> endings,
                    std::span<int> failed_at) {
  Work result;
  int const width = parameters.width();
  if (width == 0) return result;
  double const each = work_per_sample(simulator.program(), simulator.schedule()) * simulator.schedule().last_summed();
  result.width = width;
  result.given_up = simulator.given_up();
  result.instructions = each * width;
  result.written = {out, endings, failed_at};
  result.grain = grain(simulator.schedule().solver());
  auto const shared = std::make_shared<Wanted const>(std::move(wanted));
  result.blocks = [=, &simulator](int begin, int asked) {
    Executor const executor = simulator.executor(asked, each * asked, native::LoopKind::observe);
    int const block = executor.width, end = begin + asked;
    Blocks blocks;
    blocks.instructions = each * asked / speed(executor);
    // Two crews a thread at least, so that threads end together.
    int const share = (asked + 2 * simulator.threads() - 1) / (2 * simulator.threads());
    int const crew = std::clamp((share + block - 1) / block * block, block, block * blocks_per_crew);
    for (int lane = begin; lane < end; lane += crew)
      blocks.all.push_back([=, &simulator] {
        int const lanes = std::min(crew, end - lane);
        auto const first = static_cast<std::size_t>(lane), count = static_cast<std::size_t>(lanes);
        Crew(simulator, parameters.columns(lane, lanes), *shared, lane, out.columns(lane, lanes), endings.subspan(first, count),
             failed_at.subspan(first, count), executor)
            .run();
      });
    return blocks;
  };
  return result;
}

}  // namespace sysid
