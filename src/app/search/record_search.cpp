// Notices say what was chosen, and why.
#include "app/search/record_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "app/session/fit_target.hpp"
#include "likelihood/first_rows.hpp"

namespace sysid {
namespace {

SolverSettings refined(SolverSettings solver, int times) {
  for (; times > 0; --times) solver = solver.finer();
  return solver;
}

bool reads_time(Model const& model) {
  std::vector<NodeId> all;
  for (Channel const& channel : model.channels)
    all.insert(all.end(), channel.noise.arguments.begin(), channel.noise.arguments.end());
  std::vector<NodeId> const read = model.graph.reachable(all);
  return std::ranges::any_of(
      read, [&](NodeId id) { return model.graph[id].operation == Operation::leaf && model.graph[id].leaf_kind == LeafKind::time; });
}

}  // namespace

std::optional<SearchSolver> choose_search_solver(SearchableRecord const& record, RunContext const& context) {
  SolverSettings const& stated = record.what.solver;
  MakeTarget const make = [&](SolverSettings const& tried) { return record.target(tried); };
  SearchSolver const search = search_solver(make, stated, context.seed, context.interrupted, context.journal);
  if (context.stop_requested()) return std::nullopt;
  if (search.solver != stated)
    record.session.notices << fmt::format("{}: searching with {}: with {}, {:.0f} % of the prior draws overflow\n", record.name,
                                          accuracy(search.solver), accuracy(stated), 100 * search.failed_as_given);
  return search;
}

ShorterRecords shorter_records(SearchableRecord const& record, SolverSettings const& solver) {
  std::vector<Experiment> const whole = experiments_of(record.data);
  int const least = 4 * start_rows(record.what.start);  // an estimated start is not all that a part is for
  constexpr int most_refinements = 4;
  return {.rows = most_scored_rows(whole),
          .finest = record.refines() ? most_refinements : 0,
          .make =
              [record, whole, least, solver](double share, int finer) {
                FirstRows part = first_rows(whole, share, least);
                return FirstPart{record.make(std::move(part.experiments), refined(solver, finer)), part.share};
              },
          .ordered = !record.model.states.empty() || reads_time(record.model)};
}

SearchedWith searched_with(SearchableRecord const& record, SearchResult const& found, SolverSettings const& began_with) {
  if (found.finer == 0) return {began_with, record.what.solver};
  SolverSettings const finer = refined(began_with, found.finer);
  record.session.notices << fmt::format(
      "{}: the search uses {}, because with {} it found no parameters that fit the whole record as well\n", record.name,
      accuracy(finer), accuracy(began_with));
  return {finer, finer};
}

}  // namespace sysid
