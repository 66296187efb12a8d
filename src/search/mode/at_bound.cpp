// Nearness to bounds, by the density on the way to them.
#include "search/mode/at_bound.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/system/ledger.hpp"
#include "search/laplace.hpp"

namespace sysid {
namespace {

bool has_one_bound(ParameterInfo const& parameter) { return std::isfinite(parameter.lower) != std::isfinite(parameter.upper); }

/// Of a support with two bounds.
bool near_a_bound(ParameterInfo const& parameter, double declared) {
  double const width = parameter.upper - parameter.lower;
  // Logarithmic coordinates end at the lower bound relative to it, not to the width.
  double const unit = parameter.lower > 0 ? std::min(width, parameter.lower) : width;
  return declared - parameter.lower < 1e-3 * unit || parameter.upper - declared < 1e-3 * width;
}

/// Of the bound that is nearer.
double distance_to_bound(ParameterInfo const& parameter, double declared) {
  return std::min(declared - parameter.lower, parameter.upper - declared);
}

/// -1 or 1: the direction in which the coordinate runs to the bound that the mode is near. That of one bound alone is log |x - a|.
double towards_bound(Objective const& objective, Eigen::VectorXd const& theta, int parameter) {
  ParameterInfo const& info = objective.target.parameters()[static_cast<std::size_t>(parameter)];
  if (has_one_bound(info)) return -1;
  std::vector<Eigen::VectorXd> places(2, theta);
  places[0](parameter) -= 1;
  places[1](parameter) += 1;
  LaneArray declared(objective.dimension(), 2);
  objective.target.constrain(to_lanes(places), declared);
  return distance_to_bound(info, declared(parameter, 0)) < distance_to_bound(info, declared(parameter, 1)) ? -1 : 1;
}

}  // namespace

bool at_bound(ParameterInfo const& parameter, double declared, double sd) {
  if (!std::isfinite(parameter.lower) && !std::isfinite(parameter.upper)) return false;
  double const distance = distance_to_bound(parameter, declared);
  if (has_one_bound(parameter)) return distance <= 0 || sd > 10 * distance;
  return near_a_bound(parameter, declared) && !(sd > 0 && sd < distance);
}

std::vector<ModeAtBound> modes_at_bounds(Objective const& objective, Mode const& mode) {
  constexpr double thousand = 3 * std::numbers::ln10, same = 1e-3, rises = 0.1, fallen = 0.5;  // nats
  constexpr int further = 8;
  Eigen::VectorXd const theta = theta_of(mode);
  std::vector<ModeAtBound> found;
  for (int p = 0; p < objective.dimension(); ++p) {
    ParameterInfo const& info = objective.target.parameters()[static_cast<std::size_t>(p)];
    double const declared = mode.declared[static_cast<std::size_t>(p)];
    bool const one = has_one_bound(info), two = std::isfinite(info.lower) && std::isfinite(info.upper);
    double const room = objective.centre(p) + 3 * objective.scale(p) - theta(p);  // to where the prior ends, of one bound
    if (!(one && room > 0) && !(two && near_a_bound(info, declared))) continue;
    double const all_the_way = thousand * towards_bound(objective, theta, p);
    std::vector<double> moves{0, all_the_way, all_the_way / 2};
    for (int k = 1; one && k <= further; ++k) moves.push_back(k * room / further);
    // Of an interval: its middle, and nine tenths and all but a thousandth of the way to the other bound.
    for (double const away : {0.0, std::log(9.0), thousand})
      if (two) moves.push_back((all_the_way > 0 ? -away : away) - theta(p));
    std::vector<Eigen::VectorXd> places(moves.size(), theta);
    for (std::size_t k = 0; k < moves.size(); ++k) places[k](p) += moves[k];
    Ledger untold;  // places that nobody asked for
    std::vector<double> const density = log_density_in_blocks(objective, to_lanes(places), untold);
    bool const resists = std::any_of(density.begin() + 3, density.end(), [&](double each) { return each < density[0] - fallen; });
    if (!resists || !(density[1] > density[0] - same)) continue;
    // A power of the distance rises by as much in each half of the way; a density that ends at the bound hardly in the second.
    bool const ends_nowhere = density[1] > density[0] + rises && density[1] - density[2] > (density[2] - density[0]) / 4;
    bool const upper = info.upper - declared < declared - info.lower;
    found.push_back({p, upper, ends_nowhere});
  }
  return found;
}

}  // namespace sysid
