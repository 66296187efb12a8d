// The steps before sampling, in their order.
#include "app/fit/fit_preparation.hpp"

#include <fmt/format.h>

#include <cmath>

#include "app/fit/advice.hpp"
#include "app/fit/hierarchies.hpp"
#include "app/preflight/check_file.hpp"
#include "app/preflight/time_scales.hpp"
#include "app/search/search_near.hpp"
#include "app/search/solver_refinement.hpp"
#include "app/session/fit_end.hpp"
#include "app/session/preconditions.hpp"
#include "app/session/provenance.hpp"
#include "app/session/reporting.hpp"
#include "core/numeric/random.hpp"
#include "search/hierarchy/standardised.hpp"
#include "search/improper/propriety.hpp"
#include "search/improper/references.hpp"
#include "search/refit.hpp"

namespace sysid {
namespace {

constexpr std::uint64_t other_references = 13'000'000;  // of Purpose::start

}  // namespace

FitPreparation::FitPreparation(Session& session, Task const& task, FitTask const& what, std::vector<ExperimentData> const& data,
                               FitLikelihood& likelihood, ObjectiveKind objective_kind, TaskCheckpoint& checkpoint)
    : session_(session),
      task_(task),
      what_(what),
      data_(data),
      likelihood_(likelihood),
      objective_kind_(objective_kind),
      checkpoint_(checkpoint) {}

std::unique_ptr<Target> FitPreparation::target(SolverSettings const& solver) const {
  return likelihood_.make_target(experiments_of(data_), solver, session_.interruptible());
}

SearchableRecord FitPreparation::searchable_record() const {
  return {.session = session_,
          .name = task_.name,
          .what = what_,
          .data = data_,
          .model = likelihood_.model(),
          .make = [this](std::vector<Experiment> experiments, SolverSettings const& solver) {
            return likelihood_.make_target(std::move(experiments), solver, session_.interruptible());
          }};
}

bool FitPreparation::run(RunContext& context, Preparation& preparation) {
  Model const& model = likelihood_.model();
  Findings ahead = check_method(session_, what_);
  for (Finding& each : check_prior_size(session_, what_, data_)) ahead.push_back(std::move(each));
  std::optional<Finding> const scales = time_scales_apart(session_.file, model, likelihood_.space(), data_);
  if (scales) ahead.push_back(*scales);
  print_data_findings(session_, task_, data_, model);
  print_findings(session_, task_, ahead);

  preparation.solver = what_.solver;
  if (!find_references(context, context.seed, preparation)) return false;
  SearchableRecord const record = searchable_record();
  std::optional<SearchSolver> solver;
  if (record.refines()) {
    solver = choose_search_solver(record, context);
    if (!solver) return false;
    preparation.solver = solver->solver;
  }
  FitSituation const situation{
      model, data_, preparation.solver, preparation.ledger, solver ? &*solver : nullptr, scales ? &*scales : nullptr};
  if (ParameterSpace const* const space = hierarchies()) likelihood_.standardise(non_centred(*space));
  auto const searched = target(preparation.solver);
  SearchResult found = what_.near ? search_near(session_, *what_.near, *searched, objective_kind_, context)
                                  : search(*searched, objective_kind_, context, shorter_records(record, preparation.solver));
  if (found.interrupted) return false;
  if (found.failure && !preparation.references.empty())
    if (auto singular = unbounded::unbounded_density(*searched, before_search_, context.seed)) found.failure = std::move(singular);
  if (found.failure) {
    advise(situation, *found.failure);
    checkpoint_.drop();
    throw UserError(no_result(task_, *found.failure));
  }
  SearchedWith const with = searched_with(record, found, preparation.solver);
  SolverSettings const& from = with.coarsest;
  preparation.solver = with.solver;
  if (!follow_members(found, context, preparation)) return false;
  if (!require_proper(found, preparation, context)) return false;
  preparation.modes = std::move(found.modes);
  preparation.findings = std::move(found.findings);
  preparation.findings.insert(preparation.findings.end(), ahead.begin(), ahead.end());
  if (solver && !scales)
    for (Finding& each : stiff_prior(*solver, allow_exact_steps(data_, model))) preparation.findings.push_back(std::move(each));
  print_findings(session_, task_, likelihood_.check_ranges(preparation.modes.front().declared, preparation.solver));
  MakeTarget const make = [this](SolverSettings const& tried) { return target(tried); };
  if (what_.refine_solver && !refine_solver(session_, task_, make, objective_kind_, from, preparation, context)) return false;
  for (Finding& each : preparation.findings) advise(situation, each);
  if (objective_kind_ != ObjectiveKind::likelihood) excuse_hierarchies(likelihood_.space(), preparation.findings);
  return true;
}

// Where the search looks for parameters whose prior is improper. False: interrupted.
bool FitPreparation::find_references(RunContext const& context, std::uint64_t seed, Preparation& preparation) {
  std::vector<int> const coordinates = improper_coordinates(likelihood_.space().infos());
  if (coordinates.empty()) return true;
  unbounded::References found = unbounded::find_references(
      [&](std::vector<ImproperReference> const& references) {
        likelihood_.refer(references);
        return target(what_.solver);
      },
      coordinates, {!likelihood_.space().members().empty(), objective_kind_ == ObjectiveKind::likelihood}, seed,
      context.interrupted);
  if (context.stop_requested()) return false;
  preparation.references = std::move(found.of_coordinates);
  before_search_ = std::move(found.place);
  if (preparation.references.empty()) {
    checkpoint_.drop();
    throw UserError(no_result(task_, unbounded::no_finite_start_of_improper()));
  }
  likelihood_.refer(preparation.references);
  return true;
}

// An improper posterior has no draws. A poor mode may lie where the response is constant, and every constant is improper: so before
// a fit is refused the search is made once more, from other references. False: interrupted.
bool FitPreparation::require_proper(SearchResult& found, Preparation& preparation, RunContext& context) {
  if (preparation.references.empty() || objective_kind_ == ObjectiveKind::likelihood) return true;
  auto const checked = [&](SearchResult const& of) {
    auto const posterior = target(preparation.solver);
    Mode mode = of.modes.front();
    if (objective_kind_ == ObjectiveKind::declared_posterior) {
      // An optimum of the declared parameters may lie at a bound, where coordinates have no mass: what has ends far from it.
      Ledger untold;
      Mode const in_coordinates =
          refit(*posterior, ObjectiveKind::posterior, {mode}, context.seed, untold, context.interrupted).front();
      if (std::isfinite(in_coordinates.log_density)) mode = in_coordinates;
    }
    return unbounded::check_propriety(*posterior, mode, context.seed, context.interrupted);
  };
  unbounded::Propriety propriety = checked(found);
  if (context.stop_requested()) return false;
  if (propriety.failure && !what_.near) {
    std::uint64_t const other_seed = Stream({context.seed, Purpose::start, 0, other_references}).bits() >> 11;
    if (!find_references(context, other_seed, preparation)) return false;
    if (ParameterSpace const* const space = hierarchies()) likelihood_.standardise(non_centred(*space));
    SearchResult again = search(*target(preparation.solver), objective_kind_, context);
    if (again.interrupted) return false;
    double const before = found.modes.front().log_density;
    if (!again.failure && again.modes.front().log_density > before + 1) {
      if (!follow_members(again, context, preparation)) return false;
      propriety = checked(again);
      if (context.stop_requested()) return false;
      found = std::move(again);
    }
  }
  if (propriety.failure) {
    checkpoint_.drop();
    throw UserError(no_result(task_, *propriety.failure));
  }
  found.findings.insert(found.findings.end(), propriety.findings.begin(), propriety.findings.end());
  return true;
}

// Where members of hierarchies may have other coordinates than declared; else null.
ParameterSpace const* FitPreparation::hierarchies() const {
  return objective_kind_ == ObjectiveKind::posterior ? likelihood_.with_hierarchies() : nullptr;
}

// From the coordinates of members that the search has begun with to those that suit the data. False: interrupted.
bool FitPreparation::follow_members(SearchResult& found, RunContext& context, Preparation& preparation) {
  ParameterSpace const* const space = hierarchies();
  if (space == nullptr) return true;
  auto const make = [&](std::vector<MemberCoordinate> const& members) {
    likelihood_.standardise(members);
    return target(preparation.solver);
  };
  StandardisedSearch again = sysid::follow_members(*space, std::move(found), make, context);
  found = std::move(again.found);
  if (found.interrupted || context.stop_requested()) return false;
  preparation.standardised = std::move(again.coordinates);
  likelihood_.standardise(preparation.standardised);
  if (!preparation.standardised.empty())
    session_.notices << task_.name << ": " << standardised_notice(declared_names(parameters_of(*space, preparation.standardised)));
  return true;
}

}  // namespace sysid
