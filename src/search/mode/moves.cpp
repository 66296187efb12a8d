// Moves of modes in units of their sds, as far as these can be believed.
#include "search/mode/moves.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/not_finite.hpp"
#include "search/mode/at_bound.hpp"

namespace sysid {
namespace {

bool flat_in(Mode const& mode, std::size_t parameter) {
  for (std::size_t at = parameter; at < mode.flat.size(); at += mode.declared.size())
    if (mode.flat[at] != 0) return true;
  return false;
}

/// Sds that a flat direction has made the prior's hide what was gained across it: that is the move of what moves most.
void show_hidden(std::vector<Move>& moves, double allowed) {
  auto const most = std::max_element(moves.begin(), moves.end(), [](Move const& a, Move const& b) { return a.value < b.value; });
  if (most != moves.end() && allowed > 1 && most->value < 0.2 * allowed) most->value = allowed;
}

}  // namespace

std::vector<Move> moves_between(std::span<ParameterInfo const> parameters, Mode const& before, Mode const& after, double gain) {
  std::vector<Move> moves;
  bool const finite = std::isfinite(before.log_density) && std::isfinite(after.log_density);
  double const allowed = std::sqrt(2 * std::max(0.0, gain));  // sds
  for (std::size_t p = 0; p < before.declared.size(); ++p) {
    auto const parameter = static_cast<int>(p);
    if (!finite) {
      moves.push_back({parameter, infinity, infinity});
      continue;
    }
    bool const was = at_bound(parameters[p], before.declared[p], before.sd[p]),
               is = at_bound(parameters[p], after.declared[p], after.sd[p]);
    bool const was_flat = flat_in(before, p), is_flat = flat_in(after, p);
    bool const before_measures = before.sd[p] > 0 && !was && (!was_flat || is_flat);
    double const sd = before_measures ? before.sd[p] : after.sd[p];
    if ((was && is) || !(sd > 0)) continue;
    Move move{parameter, std::abs(after.declared[p] - before.declared[p]) / sd, std::abs(after.sd[p] - before.sd[p]) / sd};
    bool const wrong = move.value > 2 * allowed;
    if (wrong) move.value = allowed;
    if (wrong || was || is || was_flat || is_flat) move.width = 0;
    moves.push_back(move);
  }
  if (finite && !(before.flat.empty() && after.flat.empty())) show_hidden(moves, allowed);
  return moves;
}

Move largest_move(std::span<ParameterInfo const> parameters, Mode const& before, Mode const& after, double gain) {
  Move most;
  for (Move const& move : moves_between(parameters, before, after, gain))
    if (move.size() > most.size()) most = move;
  return most;
}

}  // namespace sysid
