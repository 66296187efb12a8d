// Records made from the prior of a fit: true values, then what the model measures with them along the task's own inputs and rows.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "app/session/session.hpp"
#include "experiment/experiments.hpp"
#include "likelihood/parameter_space.hpp"

namespace sysid {

/// The records of one replication, for the data blocks that the task reads.
struct MadeRecords {
  std::vector<double> truth;                      // [P] of the sampled parameters, declared
  std::vector<std::pair<int, Record>> of_blocks;  // by index of the data block
  bool settled = true;                            // a finer solver would not change them
  int redrawn = 0;                                // prior draws before it that could not be simulated
};

class RecordMaker {
 public:
  /// Why no record can be made of the model and data of a task; nothing where it can.
  static std::optional<Diagnostic> refusal(Session const& session, Task const& task, FitTask const& what,
                                           std::vector<ExperimentData> const& data);

  /// what, data: of a task that is not refused, with the records that it has; they outlive this.
  RecordMaker(Session& session, FitTask const& what, std::vector<ExperimentData> const& data);

  /// A draw of the prior that can be simulated, and its record: scored samples that are not missing are replaced, all others, times
  /// and inputs stay. What the solver of the fit cannot simulate has no likelihood, so that drawing again leaves the posterior as
  /// it is. Nothing where none of `most_draws` can be simulated. Interrupted where an interruption is asked for.
  std::optional<MadeRecords> make(std::uint64_t seed) const;

  static constexpr int most_draws = 50;

 private:
  /// Of all experiments, SI [experiment][channel][sample]; empty where the model cannot be simulated with these values. settled:
  /// false where a finer solver would change them.
  std::vector<std::vector<std::vector<double>>> samples(ConstLanes values, std::uint64_t seed, bool& settled) const;
  std::optional<std::vector<std::vector<double>>> samples(int experiment, ConstLanes parameters, StreamKey noise,
                                                          bool& settled) const;
  std::optional<std::vector<std::vector<double>>> samples(Experiment experiment, ConstLanes parameters, StreamKey noise,
                                                          bool& settled) const;

  Session& session_;
  FitTask const& what_;
  std::vector<ExperimentData> const& data_;
  std::shared_ptr<CompiledModel const> compiled_;
  std::shared_ptr<ParameterSpace const> space_;
};

}  // namespace sysid
