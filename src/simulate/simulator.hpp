// Runs a program over an experiment for any number of parameter vectors at once: lanes in blocks, blocks over threads.
#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/numeric/lanes.hpp"
#include "core/system/ledger.hpp"
#include "program/interpreter/executor.hpp"
#include "program/simulation_program.hpp"
#include "simulate/schedule.hpp"

namespace sysid {

class Block;       // simulate/block.hpp
class ThreadPool;  // simulate/thread_pool.hpp

/// How, never what: results are the same bytes for every choice.
struct ExecutionOptions {
  int lanes = 0;    // lanes per block, rounded up to what an executor has; 0: chosen from the work and the first-level cache
  int threads = 1;  // 0: one per processor
  ExecutorKind executor = ExecutorKind::automatic;
  /// Asked every few samples, from several threads at once. True: what is not done is given up and counts as failed, for a caller
  /// who uses nothing of it then. Null: never.
  bool (*stopped)() = nullptr;
  /// Interrupted is thrown for what has been given up, so that nothing of it is used.
  bool throws = false;
  /// Of states that an adjoint goes back over; of longer records it is written again and again, from states kept at checkpoints.
  std::size_t tape_bytes = std::size_t{32} << 20;
};

/// How the solve of one lane ended. `sample`: one by which it had failed (looked for every few samples, the same ones for any
/// width).
struct Outcome {
  bool ok = true;
  int sample = -1;
  FailureClass kind = FailureClass::non_finite;
};

/// Why and where a solve failed: the first sub-expression that is not finite, or the equation that a solver gave up at.
struct Diagnosis {
  NodeId node = 0;  // of SimulationProgram::source.graph
  double time = 0;
  int sample = 0;
  FailureClass kind = FailureClass::non_finite;
};

/// Blocks of lanes that may run in any order and on any threads, each touching its own part of the results.
struct Blocks {
  std::vector<std::function<void()>> all;
  double instructions = 0;  // in all: too few are not worth waking threads for
};

/// Where the results of lanes lie: `size` bytes of lane w in row r, at data + r * row_step + w * lane_step.
struct WrittenLanes {
  WrittenLanes(Lanes out);
  template <class T>
  WrittenLanes(std::span<T> of_lanes)
      : data(reinterpret_cast<std::byte*>(of_lanes.data())), rows(1), lane_step(sizeof(T)), size(sizeof(T)) {}
  WrittenLanes(std::byte* first, std::size_t lane_step, std::size_t size)
      : data(first), rows(1), lane_step(lane_step), size(size) {}

  std::byte* data;
  std::size_t rows, row_step = 0, lane_step, size;
};

/// A batch of lanes, of which any part may be done by itself.
struct Work {
  int width = 0;  // lanes
  /// Of lanes [first, first + count).
  std::function<Blocks(int first, int count)> blocks;
  double instructions = 0;       // of all lanes, as they are interpreted
  bool (*given_up)() = nullptr;  // asked at the end: whether to throw Interrupted
  /// All that the blocks write, so that the lanes may be divided among ranks (core/ranks); empty: each rank does all of them.
  std::vector<WrittenLanes> written = {};
  int grain = 1;  // lanes that cost no more together than one of them
};
/// Does all lanes of all pieces; returns when they are done, or throws. pool: null for the calling thread alone.
void do_work(std::span<Work const> work, ThreadPool* pool);

/// Why simulations cannot be compiled to machine code; empty where they can. Loads the compiler.
std::string const& why_no_machine_code();

/// The threads that the options ask for; null for one.
std::shared_ptr<ThreadPool> make_pool(ExecutionOptions const& options);

/// Immutable; all members may be called concurrently.
class Simulator {
 public:
  /// pool: shared with other simulators; null: threads of its own, as the options say.
  Simulator(std::shared_ptr<SimulationProgram const> program, Schedule schedule, ExecutionOptions options = {},
            std::shared_ptr<ThreadPool> pool = nullptr);

  SimulationProgram const& program() const { return *program_; }
  Schedule const& schedule() const { return schedule_; }
  ExecutionOptions const& options() const { return options_; }
  int threads() const;
  /// Whether sums may be those of a covariance that settles, at a fraction of the cost of records.
  bool settles() const { return settled_ != nullptr; }
  /// As the options say; what has no result then is not looked into either.
  bool stopped() const { return options_.stopped != nullptr && options_.stopped(); }
  /// For Work::given_up.
  bool (*given_up() const)() { return options_.throws ? options_.stopped : nullptr; }
  /// For blocks of a batch of `width` lanes that takes so many lane-instructions in all, in loops of that kind. Counts them, as
  /// machine code is made when a program has been interpreted for long enough.
  Executor executor(int width, double instructions, native::LoopKind loop) const;

  /// Says that about so many lanes will be run, up to the last sample that is summed: then machine code is made early.
  void expect(double lanes) const;

  /// parameters: [parameters x W], SI. out: [sum_count x W], rows as SimulationProgram::sum_row; NaN in failed lanes. outcome: [W].
  /// A lane fails when a state or a sum is not finite. Lane w depends on column w alone.
  void sums(ConstLanes parameters, Lanes out, std::span<Outcome> outcome) const;

  /// The same as work to do, so that several simulators share the threads; what the arguments view must outlive it.
  Work sums_work(ConstLanes parameters, Lanes out, std::span<Outcome> outcome) const;
  /// Of a program whose sums read no state (none is accumulated): without a step. A lane fails by its initial state or a sum.
  Work constant_sums_work(ConstLanes parameters, Lanes out, std::span<Outcome> outcome) const;

  /// With a program that has an adjoint: the sums, and the derivatives of all of them together by the parameters of `adjoint_by` [K
  /// x W] in `slopes`, to which the rows of ReverseSections::direct have been added. A lane fails as above, or where a derivative
  /// is not finite.
  Work gradients_work(ConstLanes parameters, Lanes out, Lanes slopes, std::span<Outcome> outcome) const;

  /// Records of samples [first, last): record r of sample i is row (i - first) * records + r of out; a failed lane is NaN in every
  /// row.
  void records(ConstLanes parameters, int first, int last, Lanes out, std::span<Outcome> outcome) const;
  Work records_work(ConstLanes parameters, int first, int last, Lanes out, std::span<Outcome> outcome) const;

  /// Writes the parameters in force from sample `sample` on, for lanes [lane, lane + parameters.width()) of the batch.
  using Redraw = std::function<void(int sample, int lane, Lanes parameters)>;
  /// `records` with parameters redrawn at every sample; initial states are those of sample 0's parameters. `redraw` is called from
  /// several threads at once.
  void records_redrawn(Redraw const& redraw, int first, int last, Lanes out, std::span<Outcome> outcome) const;

  /// Of a program whose samples correct the states: record r of sample i, row i * records + r of out, as it is known `ahead`
  /// samples before, after what corrects the states up to there; of the first samples from the start alone. uncorrected: the
  /// schedule with no sample that corrects. A failed lane is NaN in every row.
  void records_ahead(ConstLanes parameters, Schedule const& uncorrected, int ahead, Lanes out, std::span<Outcome> outcome) const;

  /// Re-runs one lane (fixed steps: with plain arithmetic) until it fails; nothing when it does not. Throws as do_work does.
  std::optional<Diagnosis> diagnose(std::span<double const> parameters) const;

 private:
  using BlockWork = std::function<void(Block&, int lane, int lanes)>;
  Work blocks(int width, int samples, native::LoopKind loop, BlockWork const& work) const;
  Executor interpreter(int width, double instructions) const;
  std::optional<Executor> native(int width, double instructions, native::LoopKind loop) const;
  void compile_length_loop(int width) const;
  Work sums_to(int end, ConstLanes parameters, Lanes out, std::span<Outcome> outcome) const;
  void run_gradient(Block& block, Lanes out, Lanes slopes, std::span<Outcome> outcome) const;
  static void take_sums(Block& block, int end, Lanes out, std::span<Outcome> outcome);
  static void give_up(int sample, int lane, int lanes, Lanes out, std::span<Outcome> outcome);
  void record_block(Block& block, Redraw const* redraw, int lane, int lanes, int first, int last, Lanes out,
                    std::span<Outcome> outcome) const;

  std::shared_ptr<SimulationProgram const> program_;
  Schedule schedule_;
  ExecutionOptions options_;
  std::shared_ptr<ThreadPool> pool_;          // absent for one thread
  std::shared_ptr<Simulator const> settled_;  // of SimulationProgram::settled; absent where nothing settles
};

}  // namespace sysid
