// Search, solver, back end, draws; and again where the draws show a higher place or need a finer solver.
#include "app/fit/fit_sampling.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "app/fit/advice.hpp"
#include "app/search/solver_refinement.hpp"
#include "app/session/fit_end.hpp"
#include "app/session/preconditions.hpp"
#include "app/session/solver_record.hpp"
#include "core/system/interrupt.hpp"
#include "diagnostics/tolerance/tolerance.hpp"
#include "inference/automatic.hpp"
#include "inference/backend/checkpoint.hpp"
#include "inference/table.hpp"
#include "search/journal.hpp"

namespace sysid {
namespace {

using json = nlohmann::json;

constexpr int most_searches = 2;

}  // namespace

FitSampling::FitSampling(Session& session, Task const& task, FitTask const& what, TaskCheckpoint checkpoint,
                         BackendRow const* backend)
    : session_(session),
      task_(task),
      what_(what),
      checkpoint_(std::move(checkpoint)),
      seed_(checkpoint_.seed()),
      chosen_(what),
      backend_(backend),
      data_(load_experiments(session, what.experiments, session.file.models[static_cast<std::size_t>(what.model)], what.start,
                             what.prediction, what.solver)),
      likelihood_(session.file.models[static_cast<std::size_t>(what.model)].processes.empty()
                      ? independent_likelihood(session, what, data_, seed_)
                      : process_likelihood(session, what, data_, seed_)),
      model_(likelihood_->model()),
      preparing_(session, task, what, data_, *likelihood_, backend_->objective_kind, checkpoint_) {
  checkpoint_.of_data(data_);
}

std::optional<FitResult> FitSampling::run() {
  if (auto const why = refusal(task_, what_, likelihood_->sampled_model(), data_)) throw UserError(*why);
  RunContext context = searching(ledger_);
  std::shared_ptr<json const> const stored = checkpoint_.stored();
  if (stored) session_.notices << fmt::format("{}: continuing from the checkpoint\n", task_.name);
  if (stored && stored->contains("preparation")) {
    if (!go_on(*stored, context)) {
      stopped_ = stop_late(session_, task_, checkpoint_, preparation_);
      return std::nullopt;
    }
  } else if (!prepare(stored.get())) {
    stopped_ = stop_early(session_, task_, checkpoint_);
    return std::nullopt;
  }
  context.checkpoint = [this](json const& state) { checkpoint_.save({{"preparation", store(preparation_)}, {"state", state}}); };
  return sample_to_end(context);
}

std::optional<FitResult> FitSampling::run_unkept() {
  if (auto const why = refusal(task_, what_, likelihood_->sampled_model(), data_)) throw UserError(*why);
  if (!prepare(nullptr)) return std::nullopt;
  RunContext context = searching(ledger_);
  std::optional<FitResult> result = sample_to_end(context);
  if (result && result->interrupted) result.reset();
  return result;
}

Ledger FitSampling::whole_ledger() const {
  Ledger whole = preparation_.ledger;
  whole.merge(ledger_);
  return whole;
}

// After the search. False: interrupted once more.
bool FitSampling::go_on(json const& stored, RunContext& context) {
  preparation_ = checkpoint_.preparation(stored);
  checkpoint_.reading([&] {
    require_method(preparation_.solver);
    likelihood_->refer(preparation_.references);
    likelihood_->standardise(preparation_.standardised);
  });
  if (stored.contains("state")) context.resume = std::make_shared<json const>(stored.at("state"));
  return !stored.contains("again") || go_on_choosing(stored.at("again"));
}

std::optional<FitResult> FitSampling::sample_to_end(RunContext& context) {
  while (true) {
    FitResult result;
    try {
      result = sample(context);
    } catch (Interrupted const&) {  // before the first iteration, or an optimum's checks
      if (!checkpoint_.kept()) checkpoint_.save({{"preparation", store(preparation_)}});
      stopped_ = stop_early(session_, task_, checkpoint_);
      return std::nullopt;
    }
    if (result.interrupted && result.draws.total() == 0) {
      stopped_ = stop_early(session_, task_, checkpoint_);
      return std::nullopt;
    }
    HigherSearch chosen = HigherSearch::nothing;
    if (std::vector<double> place = higher_place(result); !place.empty()) {
      session_.notices << fmt::format("{}: searching again, from a draw whose density is higher than that of the best mode found\n",
                                      task_.name);
      chosen = choose_again({preparation_.solver, std::move(place)}, nullptr);
    }
    if (chosen == HigherSearch::nothing) {
      check_draws_of(result);
      if (!to_be_chosen_again(result)) return result;
      session_.notices << fmt::format("{}: sampling again with a finer solver: {}\n", task_.name,
                                      tolerance_findings(*accuracy_, preparation_.solver, true).front().message);
      chosen = choose_again({fine_enough(preparation_.solver, accuracy_->largest()), {}}, nullptr);
    }
    if (chosen == HigherSearch::interrupted) {
      stopped_ = stop_late(session_, task_, checkpoint_, preparation_);
      return std::nullopt;
    }
    context.resume = {};
  }
}

// Without checkpoints and known modes.
RunContext FitSampling::searching(Ledger& ledger) {
  return {.seed = seed_,
          .progress = session_.progress,
          .ledger = ledger,
          .interrupted = [this] { return session_.interrupted(); },
          .checkpoint_interval = session_.options.checkpoint_interval};
}

FitResult FitSampling::sample(RunContext& context) {
  likelihood_->know_modes(preparation_.modes);
  choose_backend();
  Target const& target = likelihood_->set_target(preparation_.solver, session_.abandonable());
  if (std::string const how = likelihood_->estimated_by(); !how.empty())
    session_.notices << fmt::format("{}: {}\n", task_.name, how);
  context.modes = preparation_.modes;
  context.mode_findings = preparation_.findings;
  FitResult result = backend_->run(target, chosen_.settings, context);
  if (result.failure) {
    advise({model_, data_, preparation_.solver, ledger_}, *result.failure);
    throw UserError(no_result(task_, *result.failure));
  }
  for (Finding& each : result.findings) advise({model_, data_, preparation_.solver, preparation_.ledger}, each);
  return result;
}

// What `auto` stands for, by the modes.
void FitSampling::choose_backend() {
  if (chosen_.backend != "auto") return;
  Target const& target = likelihood_->set_target(preparation_.solver, session_.abandonable());
  Ledger looked;
  automatic::Choice choice = automatic::choose(target, preparation_.modes, seed_, looked);
  backend_ = find_backend(choice.backend);
  chosen_.backend = choice.backend;
  chosen_.settings = Settings(backend_->settings);
  reason_ = std::move(choice.reason);
  session_.notices << fmt::format("{}: sampling with {}: {}\n", task_.name, chosen_.backend, reason_);
}

// Whether a finer solver moves the draws.
void FitSampling::check_draws_of(FitResult const& result) {
  accuracy_.reset();
  SolverSettings const& solver = preparation_.solver;
  if (!model_.integrated() || solver.row().exact || result.interrupted || result.draws.total() < 2) return;
  if (auto const estimates = likelihood_->finer_estimates(session_.abandonable()); estimates.coarse) {
    accuracy_ = check_estimates(*estimates.coarse, *estimates.fine, result.draws, extra_);
    return;
  }
  accuracy_ =
      check_draws(*preparing_.target(solver), *preparing_.target(solver.finer()), result.draws, preparation_.modes, seed_, extra_);
}

// A solver that the guard has chosen, by modes, for draws that it moves after all. Where none was fine enough for the modes, none
// is left to choose.
bool FitSampling::to_be_chosen_again(FitResult const& result) const {
  bool const settled = std::none_of(preparation_.findings.begin(), preparation_.findings.end(),
                                    [](Finding const& each) { return each.code == FindingCode::step_not_settled; });
  return what_.refine_solver && settled && !result.interrupted && !session_.interrupted() && accuracy_ && !accuracy_->holds() &&
         fine_enough(preparation_.solver, accuracy_->largest()).within_limits();
}

// A place that shows that the search has missed a mode; empty where there is none. A search that the user has aimed stays there.
std::vector<double> FitSampling::higher_place(FitResult const& result) {
  bool const asked = !result.interrupted && !session_.interrupted() && !what_.near && preparation_.searched_again < most_searches;
  if (!asked) return {};
  Target const& target = likelihood_->set_target(preparation_.solver, session_.abandonable());
  return place_above_modes(result, target, backend_->objective_kind, preparation_.modes,
                           likelihood_->with_hierarchies() != nullptr);
}

// steps: what an interrupted run has kept of it, or null. Interrupted: kept with what was sampled before, which then stays.
// Nothing: no higher mode lies near the place, and the result stays.
HigherSearch FitSampling::choose_again(Again const& from, json const* steps) {
  Preparation again = preparation_;
  RunContext context = searching(again.ledger);
  MakeTarget const make = [this](SolverSettings const& solver) { return preparing_.target(solver); };
  auto const content = [&](json const& kept) -> json {
    return {{"preparation", store(preparation_)},
            {"again",
             {{"solver", write_solver(from.solver)},
              {"place", checkpoint::encode(std::span<double const>(from.place))},
              {"ledger", checkpoint::encode(ledger_)},
              {"journal", kept}}}};
  };
  HigherSearch searched = HigherSearch::found;
  bool const chosen = checkpoint_.keep_steps(steps, content, [&](Journal& journal) {
    context.journal = &journal;
    if (!from.place.empty())
      searched = search_from_place(from.place, *preparing_.target(again.solver), backend_->objective_kind, again, context);
    if (searched == HigherSearch::nothing) return true;
    bool const ended =
        searched == HigherSearch::found &&
        (!what_.refine_solver || refine_solver(session_, task_, make, backend_->objective_kind, from.solver, again, context));
    if (!ended) journal.save();  // the sampling before is not done again
    return ended;
  });
  if (!chosen) return HigherSearch::interrupted;
  if (searched == HigherSearch::nothing) {
    preparation_.searched_again = most_searches;
    preparation_.ledger = std::move(again.ledger);
  } else {
    preparation_ = std::move(again);
    preparation_.ledger.merge(ledger_);
    ledger_ = {};
    chosen_ = what_;
  }
  if (checkpoint_.kept()) checkpoint_.save({{"preparation", store(preparation_)}});
  return searched;
}

// Of a solver that a checkpoint holds: a run refines its steps, and keeps its method.
void FitSampling::require_method(SolverSettings const& stored) const {
  if (stored.method != what_.solver.method) throw checkpoint::Mismatch("its solver is another one");
}

// Where a run was interrupted in `choose_again`.
bool FitSampling::go_on_choosing(json const& stored) {
  Again from;
  checkpoint_.reading([&] {
    from = {read_solver(stored.at("solver")), checkpoint::decode(stored.at("place"))};
    require_method(from.solver);
    // Of what is sampled: coefficients that are integrated out have no coordinate.
    bool const fits = from.place.empty() || std::ssize(from.place) == preparing_.target(from.solver)->dimension();
    if (!fits) throw checkpoint::Mismatch("its parameters differ in number");
    ledger_ = checkpoint::decode_ledger(stored.at("ledger"));
    (void)stored.at("journal");
  });
  HigherSearch const searched = choose_again(from, &stored.at("journal"));
  if (searched == HigherSearch::nothing) ledger_ = {};  // the draws, which stay as they were, are drawn once more
  return searched != HigherSearch::interrupted;
}

// From what an interrupted run has kept, if there is anything. False: interrupted, and kept.
bool FitSampling::prepare(json const* stored) {
  json const* steps = nullptr;
  if (stored != nullptr) checkpoint_.reading([&] { steps = &stored->at("journal"); });
  RunContext context = searching(preparation_.ledger);
  bool const prepared = checkpoint_.keep_steps(
      steps,
      [](json const& kept) -> json {
        return {{"journal", kept}};
      },
      [&](Journal& journal) {
        context.journal = &journal;
        return preparing_.run(context, preparation_);
      });
  // What took so long that it has been kept on the way is kept at its end.
  if (prepared && checkpoint_.kept()) checkpoint_.save({{"preparation", store(preparation_)}});
  return prepared;
}

}  // namespace sysid
