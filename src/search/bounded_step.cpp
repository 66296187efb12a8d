// Coordinates held at an end, released by the sign of their slope.
#include "search/bounded_step.hpp"

#include <vector>

#include "linear_algebra/decompositions.hpp"

namespace sysid {
namespace {

/// Where g's - 1/2 s'Hs is largest among the steps that leave the held coordinates as they are in `s`.
Eigen::VectorXd best_free(Eigen::MatrixXd const& h, Eigen::VectorXd const& g, Eigen::VectorXd s, std::vector<bool> const& held) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < s.size(); ++i)
    if (!held[static_cast<std::size_t>(i)]) free.push_back(i);
  if (free.empty()) return s;
  Eigen::VectorXd fixed = s;
  for (Eigen::Index const i : free) fixed(i) = 0;
  Eigen::VectorXd const x = solve_symmetric(h(free, free), (g - h * fixed)(free));
  s(free) = x;
  return s;
}

}  // namespace

Eigen::VectorXd best_step(Eigen::MatrixXd const& h, Eigen::VectorXd const& g, Eigen::VectorXd const& low,
                          Eigen::VectorXd const& high) {
  Eigen::Index const n = g.size();
  Eigen::VectorXd s = Eigen::VectorXd::Zero(n);
  std::vector<bool> held(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) held[static_cast<std::size_t>(i)] = g(i) > 0 ? high(i) <= 0 : low(i) >= 0;
  for (Eigen::Index turn = 0; turn < 5 * n + 5; ++turn) {
    Eigen::VectorXd const move = best_free(h, g, s, held) - s;
    if (!move.allFinite()) return s;
    double part = 1;
    Eigen::Index stopped = -1;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (move(i) == 0) continue;
      double const room = ((move(i) > 0 ? high(i) : low(i)) - s(i)) / move(i);
      if (room < part) part = room, stopped = i;
    }
    if ((g - h * s).dot(move) > 0)
      s += part * move;
    else if (stopped >= 0)
      return s;  // rounding: no direction up
    if (stopped >= 0) {
      s(stopped) = move(stopped) > 0 ? high(stopped) : low(stopped);
      held[static_cast<std::size_t>(stopped)] = true;
      continue;
    }
    Eigen::VectorXd const rest = g - h * s;
    Eigen::Index worst = -1;
    double most = 1e-12;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!held[static_cast<std::size_t>(i)]) continue;
      double const inward = s(i) >= high(i) ? -rest(i) : rest(i);
      if (low(i) < high(i) && inward * inward > most * h(i, i)) most = inward * inward / h(i, i), worst = i;
    }
    if (worst < 0) return s;
    held[static_cast<std::size_t>(worst)] = false;
  }
  return s;
}

}  // namespace sysid
