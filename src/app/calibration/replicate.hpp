// One replication of a calibration: a record made from the prior, its fit, and where the true values lie in the posterior.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "app/calibration/made_records.hpp"
#include "diagnostics/calibration/calibration.hpp"
#include "inference/backend/backend.hpp"

namespace sysid {

/// What all replications of a task share.
struct CalibrationPlan {
  int index = 0;  // of the task
  Task const* task = nullptr;
  FitTask what;  // the task's, but for a search near another result, which knows nothing of made records
  BackendRow const* backend = nullptr;
  std::uint64_t seed = 0;
  int draws = 99;
};

/// Parameters that are ranked, in the order of their draws, without coefficients of unknown functions; then the log likelihood,
/// unless the back end finds an optimum alone.
std::vector<QuantityName> ranked_quantities(Session& session, CalibrationPlan const& plan);

/// A session in which replications run one after the other, with what it has compiled. Each replication depends on the plan and its
/// number alone.
class Replicator {
 public:
  /// session: that of the whole, whose records and options are taken over.
  Replicator(Session& session, CalibrationPlan const& plan);

  /// Nothing where it was interrupted.
  std::optional<Replication> run(int number);
  /// How many of the prior draws cannot be simulated, among `some` replications, and of how many.
  struct Tried {
    int failed = 0, draws = 0;
  };
  Tried try_prior(int some);

 private:
  std::uint64_t seed_of(int number) const;
  void fit(MadeRecords const& made, Replication& replication);

  CalibrationPlan const& plan_;
  RunOptions options_;
  SilentProgress progress_;
  std::ostream nowhere_{nullptr};
  Session session_;
  Model const& model_;
  std::vector<ExperimentData> data_;  // as they were recorded
  RecordMaker maker_;
};

nlohmann::json store(Replication const& replication);
Replication restore_replication(nlohmann::json const& stored);

}  // namespace sysid
