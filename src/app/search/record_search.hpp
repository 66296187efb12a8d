// How the record of a fit, or of a candidate of a selection, is searched: with which solver, and from which first rows.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/session/session.hpp"
#include "diagnostics/tolerance/tolerance.hpp"
#include "search/global/search.hpp"

namespace sysid {

/// References: all outlive the search, and the shorter records that are made of it.
struct SearchableRecord {
  Session& session;
  std::string const& name;  // of the task or the candidate, in notices
  FitTask const& what;
  std::vector<ExperimentData> const& data;
  Model const& model;
  /// Of the data, or of their first rows.
  std::function<std::unique_ptr<Target>(std::vector<Experiment> experiments, SolverSettings const& solver)> make;

  /// The steps of its solver may be refined.
  bool refines() const { return what.refine_solver && model.integrated(); }
  std::unique_ptr<Target> target(SolverSettings const& solver) const { return make(experiments_of(data), solver); }
};

/// The solver that follows most of the prior, with a notice where it is not the task's. Nothing: interrupted.
std::optional<SearchSolver> choose_search_solver(SearchableRecord const& record, RunContext const& context);

/// What a search of a long record begins with. solver: that of the search.
ShorterRecords shorter_records(SearchableRecord const& record, SolverSettings const& solver);

/// Of what a search has found that began with `began_with`: the solver of its modes, and the coarsest one that is to be tried on
/// them. Where the search has followed the record with a finer one than it began with, both are that one, and a notice says so.
struct SearchedWith {
  SolverSettings solver, coarsest;
};
SearchedWith searched_with(SearchableRecord const& record, SearchResult const& found, SolverSettings const& began_with);

}  // namespace sysid
