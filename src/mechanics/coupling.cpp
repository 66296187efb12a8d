// A graph of masses and the ground: its edges from the terms of the accelerations, its scales by walking along them.
#include "mechanics/coupling.hpp"

#include <algorithm>
#include <cmath>

namespace sysid {

namespace {

constexpr double same = 1e-6;            // parts of a size, which rounding stays below
constexpr std::size_t most_states = 50;  // that are looked at

using States = std::vector<std::vector<double>>;
using Other = std::optional<std::size_t>;

class CoupledMasses {
 public:
  CoupledMasses(Accelerations const& accelerations, States const& states)
      : accelerations_(accelerations), masses_(accelerations.masses()) {
    std::size_t const stride = states.size() / most_states + 1;
    for (std::size_t i = 0; i < states.size(); i += stride) states_.push_back(states[i]);
    for (std::size_t i = 0; i < masses_.size(); ++i) edges_.push_back(edges_of(i));
    keep_links();
  }

  /// Links of all masses that a mass is coupled with, itself included; marks them as visited.
  std::vector<Link> links_around(std::size_t first, std::vector<bool>& visited) const {
    std::vector<std::size_t> group = {first};
    visited[first] = true;
    for (std::size_t at = 0; at < group.size(); ++at)
      for (Other const& edge : edges_[group[at]])
        if (edge && !visited[*edge]) visited[*edge] = true, group.push_back(*edge);
    std::sort(group.begin(), group.end());
    auto const [scale, input] = scales(group);
    std::vector<Link> links;
    std::vector<Other> const parent = parents(group);
    for (std::size_t const i : group)
      for (Other const& other : edges_[i]) {
        // Each once: from the mass that is farther from the ground.
        bool const from_here = !other || parent[i] == other || (parent[*other] != Other(i) && i > *other);
        if (!from_here || !scale[i]) continue;
        links.push_back({i, other, input, *scale[i], {}});
        if (is_tree(group)) links.back().held = held_beyond(i, other, scale);
      }
    return links;
  }

 private:
  double elongation(std::size_t i, Other other, std::vector<double> const& states, std::size_t Mass::*of) const {
    return states[masses_[i].*of] - (other ? states[masses_[*other].*of] : 0);
  }
  double by_link(std::size_t i, Other other, std::vector<double> const& states) const {
    return accelerations_.by_link(i, other, elongation(i, other, states, &Mass::displacement),
                                  elongation(i, other, states, &Mass::velocity));
  }

  /// The ends of the links of a mass; empty where its acceleration is no sum over links.
  std::vector<Other> edges_of(std::size_t i) const {
    Mass const& mass = masses_[i];
    if (!mass.readable || mass.remembers) return {};
    std::vector<Other> ends = {Other()};
    ends.insert(ends.end(), mass.neighbours.begin(), mass.neighbours.end());
    std::vector<double> largest(ends.size(), 0);
    double const at_rest = accelerations_.value(mass.at_rest, accelerations_.rest());
    double size = 0, error = 0;
    for (auto const& states : states_) {
      double sum = at_rest;
      for (std::size_t k = 0; k < ends.size(); ++k) {
        double const part = by_link(i, ends[k], states);
        sum += part;
        largest[k] = std::max(largest[k], std::fabs(part));
      }
      double const whole = accelerations_.value(mass.at_rest, states);
      size = std::max(size, std::fabs(whole));
      // Not a number where a link has no value at rest.
      error = std::isfinite(whole - sum) ? std::max(error, std::fabs(whole - sum)) : INFINITY;
      if (!std::isfinite(error)) return {};
    }
    if (error > same * size) return {};
    std::vector<Other> held_by;
    for (std::size_t k = 0; k < ends.size(); ++k)
      if (largest[k] > same * same * size) held_by.push_back(ends[k]);
    return held_by;
  }

  /// A link pulls at both its ends alike. What pulls at one alone, as an actuator does that follows another mass, is none, and that
  /// mass is held by more than its links.
  void keep_links() {
    std::vector<std::vector<Other>> const all = edges_;
    auto const pulls_back = [&](std::size_t i, Other const& other) {
      return !other || (std::find(all[*other].begin(), all[*other].end(), Other(i)) != all[*other].end() && mass_ratio(i, *other));
    };
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      std::erase_if(edges_[i], [&](Other const& other) { return !pulls_back(i, other); });
      by_links_alone_.push_back(edges_[i].size() == all[i].size());
    }
  }

  /// m_j / m_i from their common link; nothing where the two do not pull at each other alike.
  std::optional<double> mass_ratio(std::size_t i, std::size_t j) const {
    double low = INFINITY, high = -INFINITY, size = 0;
    for (auto const& states : states_) size = std::max(size, std::fabs(by_link(j, i, states)));
    for (auto const& states : states_) {
      double const back = by_link(j, i, states);
      if (!(std::fabs(back) > 1e-3 * size)) continue;
      double const ratio = -by_link(i, j, states) / back;
      low = std::min(low, ratio);
      high = std::max(high, ratio);
    }
    return high > 0 && high - low <= same * high ? std::optional(high) : std::nullopt;
  }

  /// Of each mass its scale [masses], and the input in whose unit they are.
  std::pair<std::vector<std::optional<double>>, std::optional<std::size_t>> scales(std::vector<std::size_t> const& group) const {
    auto const pushed = std::find_if(group.begin(), group.end(), [&](std::size_t i) { return accelerations_.gain(i) != 0; });
    std::size_t const seed = pushed == group.end() ? group.front() : *pushed;
    std::vector<std::optional<double>> scale(masses_.size());
    scale[seed] = pushed == group.end() ? 1 : 1 / std::fabs(accelerations_.gain(seed));
    std::vector<std::size_t> known = {seed};
    for (std::size_t at = 0; at < known.size(); ++at)
      for (Other const& edge : edges_[known[at]]) {
        if (!edge || scale[*edge]) continue;
        auto const ratio = mass_ratio(known[at], *edge);
        if (!ratio) continue;
        scale[*edge] = *ratio * *scale[known[at]];
        known.push_back(*edge);
      }
    return {scale, masses_[seed].input};
  }

  /// Of each mass the next one towards the ground, or towards the first of the group where none is held by the ground.
  std::vector<Other> parents(std::vector<std::size_t> const& group) const {
    std::vector<Other> parent(masses_.size());
    std::vector<bool> reached(masses_.size(), false);
    std::vector<std::size_t> order;
    for (std::size_t const i : group)
      if (std::find(edges_[i].begin(), edges_[i].end(), Other()) != edges_[i].end()) order.push_back(i);
    if (order.empty()) order.push_back(group.front());
    for (std::size_t const i : order) reached[i] = true;
    for (std::size_t at = 0; at < order.size(); ++at)
      for (Other const& edge : edges_[order[at]])
        if (edge && !reached[*edge]) reached[*edge] = true, parent[*edge] = order[at], order.push_back(*edge);
    return parent;
  }

  /// Whether each link divides the masses: there are as many as masses that are held, one less where none is held by the ground.
  bool is_tree(std::vector<std::size_t> const& group) const {
    std::size_t ends = 0, grounded = 0;
    for (std::size_t const i : group) {
      if (edges_[i].empty()) return false;  // what holds it is not known
      for (Other const& edge : edges_[i]) edge ? ++ends : ++grounded;
    }
    return ends / 2 + grounded == group.size() - (grounded == 0 ? 1 : 0);
  }

  std::vector<Link::Held> held_beyond(std::size_t i, Other from, std::vector<std::optional<double>> const& scale) const {
    if (!scale[i] || !by_links_alone_[i]) return {};
    std::vector<Link::Held> out = {{i, *scale[i]}};
    for (Other const& edge : edges_[i]) {
      if (edge == from) continue;
      if (!edge) return {};
      std::vector<Link::Held> const farther = held_beyond(*edge, i, scale);
      if (farther.empty()) return {};
      out.insert(out.end(), farther.begin(), farther.end());
    }
    return out;
  }

  Accelerations const& accelerations_;
  std::vector<Mass> const& masses_;
  States states_;
  std::vector<std::vector<Other>> edges_;  // of each mass
  std::vector<bool> by_links_alone_;       // whether they are all that acts on it
};

}  // namespace

std::vector<Link> links_of(Accelerations const& accelerations, States const& states) {
  std::vector<Mass> const& masses = accelerations.masses();
  std::vector<Link> links;
  std::vector<bool> visited(masses.size(), false);
  std::optional<CoupledMasses> coupled;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    if (visited[i] || !masses[i].readable) continue;
    if (masses[i].neighbours.empty()) {
      visited[i] = true;
      double const scale = masses[i].input ? 1 / std::fabs(accelerations.gain(i)) : 1;
      links.push_back({i, {}, masses[i].input, scale, {{i, scale}}});
      continue;
    }
    if (!coupled) coupled.emplace(accelerations, states);
    for (Link& link : coupled->links_around(i, visited)) links.push_back(std::move(link));
  }
  return links;
}

}  // namespace sysid
