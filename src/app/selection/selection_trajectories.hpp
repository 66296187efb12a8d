// What a predict task of a selection simulates: trajectories of the candidates' particles, as many of each as it is probable.
#pragma once
#include <memory>
#include <vector>

#include "app/session/session.hpp"
#include "experiment/experiments.hpp"
#include "likelihood/trajectory.hpp"

namespace sysid {

class SelectionTrajectories {
 public:
  /// Of a selection whose particles are those of this run or of its result folder; UserError as `selected_candidates`.
  SelectionTrajectories(Session& session, PredictTask const& what, std::uint64_t seed);

  /// How many trajectories each candidate has: its share, the rest to the largest remainders.
  std::vector<int> const& counts() const { return counts_; }
  /// The most probable candidate.
  std::size_t lead() const;
  /// That of its particles, unless the data that are predicted do not suit it.
  SolverSettings solver(std::size_t candidate) const;

  /// A candidate's trajectories along an experiment. Of its noise nothing is known: `result.noisy` is without values.
  struct Along {
    std::shared_ptr<CompiledModel const> compiled;
    std::unique_ptr<ExperimentData const> data;
    std::unique_ptr<Trajectory const> trajectory;
    LaneArray parameters;  // of the model, SI [parameters x trajectories]
    int start_rows = 0;
    SolverSettings solver;
    Trajectory::Result result;

    Model const& model() const { return compiled->model; }
  };
  Along along(std::size_t candidate, std::size_t experiment) const;

 private:
  Session& session_;
  PredictTask const& what_;
  SelectTask const& select_;
  std::vector<SelectedCandidate> const& candidates_;
  std::uint64_t seed_;
  std::vector<int> counts_;
};

}  // namespace sysid
