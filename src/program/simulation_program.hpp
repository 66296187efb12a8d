// A first-order system with its integrator and its observations as one program: prologue (once per parameter vector), step, observe
// (per scored sample), record, epilogue. Sub-expressions are sorted by binding time, so each is computed as seldom as it may be.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "native/machine_code.hpp"
#include "program/equation_kernels.hpp"
#include "program/kernel.hpp"
#include "program/uniform_leaf.hpp"
#include "solver/stages.hpp"

namespace sysid {

/// Expressions to be summed over the scored, non-missing samples of one channel: functions of measured(channel), state, input,
/// input_rate, time and parameter leaves. A log density comes back with its constants: terms of parameters alone are multiplied by
/// the number of samples.
struct ChannelSource {
  std::vector<NodeId> sums;
  /// What the states become once the sample has been summed, one expression per state; empty: they stay as they are. The channels
  /// of a sample follow one another, each reading what the one before has left.
  std::vector<NodeId> correct = {};
  bool always = false;  // at every sample, scored or not
};

/// When a record of a sample is computed, in programs whose samples correct states: before all channels, with one of them (only
/// where that is summed, else NaN), or after all.
constexpr int before_channels = -1, after_channels = 1 << 20;

/// A state that a filter moves towards a limit, whatever the samples are: entry (row, column) of a covariance whose entries follow
/// one another in the states; or, factored, of its factors (Moments::entries).
struct SettlingState {
  int state = 0;
  int row = 0, column = 0;
  bool factored = false;
};

struct SimulationSource {
  Graph graph;
  int parameters = 0;  // parameter leaves 0 ... parameters - 1
  int inputs = 0;
  std::vector<NodeId> initial;  // one per state: expressions of parameters, and of data at the first sample; of an algebraic one:
                                // where its iteration begins
  std::vector<NodeId> derivative;  // one per differential state: expressions of state, input, input_rate, parameter, time
  /// The derivatives are no derivatives but the states at the next sample, which read data at this one: no integrator.
  bool map = false;
  bool stepped = false;  // a map that reads data of the interval to the next sample, as a step does
  /// The last differential states remember: each takes the value of its expression at every sample, before the step from it; their
  /// derivatives are zero.
  std::vector<NodeId> memories;
  std::vector<NodeId> constraints;  // one per algebraic state, which come last: expressions that are zero
  std::vector<ChannelSource> channels;
  std::vector<NodeId> records;     // written out at every sample: expressions of the same leaves (measured as well)
  std::vector<int> recorded_at;    // per record: before_channels, a channel, after_channels; empty: all before
  std::string integrator = "rk4";  // a solver's name
  /// Parameters by which an adjoint gives the derivative of all sums together (program/adjoint.hpp); empty: there is none.
  std::vector<int> adjoint_by;
  /// Those that make up a covariance, where samples correct it alike; empty: there is nothing that settles.
  std::vector<SettlingState> settling;

  int states() const { return static_cast<int>(derivative.size() + constraints.size()); }
  /// Whether samples change the states.
  bool corrects() const;
};

/// Names of leaves, for the dump.
struct ProgramNames {
  std::vector<std::string> parameters, inputs, states, channels;
};

/// Values that depend on data alone, computed once per data set for every step or sample.
struct UniformTable {
  std::vector<UniformLeaf> leaves;  // what the rows of the kernel's inputs are
  Kernel kernel;                    // outputs: the uniforms of one row
};

/// A sum that is `factor` times one accumulator, so it can be read before the last sample.
struct RunningSum {
  int accumulator = 0;
  double factor = 1;
};

/// Straight-line code over the register file, and the row of uniforms it reads.
struct Section {
  Code code;
  UniformTable uniforms;
  std::shared_ptr<LinkedCode const> linked;
};

/// Registers of the file, in this order; uniforms are constants, then one row of the running section's table.
struct RegisterLayout {
  int parameters = 0, hoisted = 0, states = 0, control = 0, accumulators = 0, adjoints = 0, slopes = 0, records = 0, sums = 0,
      temporaries = 0;
  int first_hoisted() const { return parameters; }
  int first_state() const { return first_hoisted() + hoisted; }
  int first_control() const { return first_state() + states; }
  int first_accumulator() const { return first_control() + control; }
  int first_adjoint() const { return first_accumulator() + accumulators; }
  int first_slope() const { return first_adjoint() + adjoints; }
  int first_record() const { return first_slope() + slopes; }
  int first_sum() const { return first_record() + records; }
  int first_temporary() const { return first_sum() + sums; }
  int total() const { return first_temporary() + temporaries; }
  /// What a fixed-step solver carries from sample to sample: the rows before this one.
  int carried() const { return first_record(); }
};

/// What runs backwards over a simulation, reading its states from a tape. In registers of their own: the derivative of what is
/// summed from here to the end by each state, and by each parameter of `SimulationSource::adjoint_by`.
struct ReverseSections {
  Section step;                  // states before a step, derivatives after it -> derivatives before it
  std::vector<Section> observe;  // per channel: what a summed sample adds to the derivatives by the states
  Section start;                 // what the initial states add to the derivatives by the parameters
  Section values;                // what a method's values of one length of a step add there, once; `start` does it, too
  struct Direct {
    int row, slope;
  };
  std::vector<Direct> direct;  // rows of the sums that are derivatives by parameters where states do not move: to be added
};

struct SettledProgram;  // program/settled.hpp

struct SimulationProgram {
  SimulationSource source;

  RegisterLayout registers;
  std::vector<int> length_values;  // hoisted ones that a step reads, forwards or backwards
  int hot_registers = 0;           // rows that a step and the observations touch: they should stay in the first-level cache
  std::vector<double> constants;
  int uniforms = 0;  // constants and the widest row
  Section prologue;  // parameters, the length of a step -> hoisted values
  Section start;     // parameters, hoisted values, data of the first sample -> initial states
  Section carry;     // what is to be remembered of a sample -> the last states
  Section step;      // one integrator step, one attempt at one, or the map from sample to sample; empty for SUNDIALS' solvers
  EquationKernels equations;     // for those, and to look into failed solves of adaptive methods
  std::vector<Section> observe;  // per channel: one scored sample into the accumulators
  ReverseSections reverse;       // of an adjoint
  Section record;                // one sample into the record registers
  Section record_after;          // the same, of what is recorded after the channels
  Section epilogue;              // accumulators -> sums; its row: the number of summed samples of each channel, then all data sums
  std::vector<UniformTable> data_sums;  // per channel: terms of data alone, summed once per data set over the summed samples
  std::vector<std::optional<RunningSum>> running_sums;  // per row of the sums
  std::vector<int> first_sums;                          // per channel: the row of its first

  std::shared_ptr<native::MachineCode> machine_code = std::make_shared<native::MachineCode>();  // of its loops, as they are wanted

  /// What goes on once its covariance has settled; null: nothing does.
  std::shared_ptr<SettledProgram const> settled;

  // The step as expressions, before algebra: where a failed solve is looked into.
  Graph graph;                      // source.graph, grown
  std::vector<NodeId> next;         // states after one step
  std::vector<StageVisit> visited;  // evaluations of the derivative, in order

  int sum_count() const;
  /// The row of sum k of a channel in the output of Simulator::sums.
  int sum_row(int channel, int k) const;
};

/// Cannot fail on a checked model: a leaf that has no business where it stands is a fault of ours (InternalError).
SimulationProgram compile(SimulationSource source);

/// What `--dump program` prints.
std::string dump(SimulationProgram const& program, ProgramNames const& names);

}  // namespace sysid
