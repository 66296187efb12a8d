// A model as compiled functions: initial state and derived quantities as kernels, simulations as programs for each use. Compiled
// once, used by every view and every experiment.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/system/lazily.hpp"
#include "core/text/source.hpp"
#include "model/filter_rule.hpp"
#include "model/model.hpp"
#include "program/kernel.hpp"
#include "program/simulation_program.hpp"

namespace sysid {

/// Rows of a simulation's parameters: all parameters of the model in the user's order (those fixed for all experiments are folded
/// in, their rows unread), then, with a free start, one row per state: its value at the first sample.
struct CompiledModel {
  Model model;
  bool free_start = false;
  std::string method;                         // of the solver that the simulations are compiled for
  FilterRule filter = FilterRule::automatic;  // where states are random

  Kernel derived;                  // parameters, SI -> quantities derived from parameters alone, declared units
  Kernel initial;                  // parameters, SI -> the model's own initial state, SI
  std::vector<int> derived_index;  // into model.derived
  std::shared_ptr<SimulationProgram const> likelihood;  // sums: per channel the log density
  std::shared_ptr<SimulationProgram const>
      residuals;  // records: per channel the deviance residual; sums: the saturated log density
  std::shared_ptr<SimulationProgram const> trajectory;  // records: see below
  struct Record {
    enum class Kind { centre, noise_argument, state, derived, constraint, constraint_size, spread };
    Kind kind;
    int index;     // channel, channel, state, model.derived, model.invariants (twice); of a spread the record whose sd it is
    int argument;  // of the noise
  };
  std::vector<Record> records;                // of `trajectory`, SI
  std::vector<DistributionRow const*> noise;  // of the channels, as recorded there: normal where moments stand for random states

  int parameter_rows() const;

  /// By which parameters of the model `squares` differentiates (likelihood/differentiated.hpp); none where there are no tangents,
  /// and where starts are estimated.
  std::vector<int> differentiated;
  /// The normal equations of `residuals` by these parameters (program/tangents.hpp); compiled at the first need. Residuals of
  /// normal noise are (y - mean)/sd there, which has a derivative at 0.
  std::shared_ptr<SimulationProgram const> squares() const;

  /// By which parameters of the model `gradient` differentiates; none where a gradient is taken by differences.
  std::vector<int> gradient_by;
  bool adjoint = false;  // by its adjoint, not by tangents
  /// The log density per channel, and its derivatives by these parameters: by tangents further sums of the channel
  /// (program/tangents.hpp), by the adjoint those of all channels together (program/adjoint.hpp). Compiled at the first need.
  std::shared_ptr<SimulationProgram const> gradient() const;

 private:
  Lazily<std::shared_ptr<SimulationProgram const>> squares_, gradient_;
};

/// free_start: the initial state is read from extra parameter rows instead of the model's initial values. method: a solver's name.
/// filter: how moments of random states are found, if there are any.
std::shared_ptr<CompiledModel const> compile(Model model, bool free_start, std::string const& method,
                                             FilterRule filter = FilterRule::automatic);

/// A program that sums, over the scored samples of each channel, an expression of `grown`: the model's graph and what was added to
/// it.
std::shared_ptr<SimulationProgram const> compile_sums(CompiledModel const& compiled, Graph grown,
                                                      std::span<NodeId const> per_channel);

/// A program whose records are, per channel, an expression of `grown`, as above.
std::shared_ptr<SimulationProgram const> compile_records(CompiledModel const& compiled, Graph grown,
                                                         std::span<NodeId const> per_channel);

/// A program whose records are, per channel, the log density of its sample, of the declared unit; NaN where there is no sample.
/// ahead: before the samples of its row correct random states.
std::shared_ptr<SimulationProgram const> compile_densities(CompiledModel const& compiled, bool ahead = false);

/// What `--dump program` prints: the likelihood program and the kernels of the prior.
std::string dump_program(CompiledModel const& compiled);

/// A sub-expression in the user's words and its place: "`k3*y^3` (duffing.sysid:12:20)"; from its structure where it has no place.
std::string describe(Model const& model, Graph const& graph, NodeId node, Source const& source);

}  // namespace sysid
