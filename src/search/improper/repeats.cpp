// Local searches from far off.
#include "search/improper/repeats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/numeric/elementary.hpp"
#include "core/numeric/random.hpp"
#include "core/text/number.hpp"
#include "search/improper/free_climb.hpp"
#include "search/laplace.hpp"

namespace sysid::unbounded {
namespace {

constexpr int per_side = 8, rounds = 16;
constexpr double nearest = 1, decades = 4;  // powers of ten of sds
constexpr double as_high = 0.5;             // nats
constexpr double apart = 5;                 // sds
constexpr std::uint64_t repeat_step = 12'000'002;

struct Coordinate {
  Eigen::Index p;
  bool on_line;
  double sd;
};

std::vector<Eigen::VectorXd> starts_along(Coordinate const& along, Eigen::VectorXd const& mode, std::uint64_t seed) {
  Stream stream({seed, Purpose::start, static_cast<std::uint64_t>(along.p), repeat_step});
  std::vector<Eigen::VectorXd> starts;
  for (double const sign : {1.0, -1.0})
    for (int k = 0; k < per_side; ++k) {
      double const exponent = nearest + decades * (k + stream.uniform()) / per_side,
                   distance = along.sd * elementary::exp(std::numbers::ln10 * exponent);
      if (!along.on_line && sign < 0) continue;
      starts.push_back(mode);
      starts.back()(along.p) += along.on_line ? sign * distance : elementary::log(1 + distance);
    }
  return starts;
}

/// Distances from the mode, in sds, of different places that are as high.
std::vector<double> as_high_as(Objective const& objective, Coordinate const& along, Eigen::VectorXd const& mode, std::uint64_t seed,
                               std::function<bool()> const& stop) {
  Ledger untold;
  std::vector<Eigen::VectorXd> starts = starts_along(along, mode, seed);
  starts.push_back(mode);
  std::vector<double> const density = log_density_in_blocks(objective, to_lanes(starts), untold, stop);
  std::vector<FreeClimber> climbers;
  for (std::size_t k = 0; k + 1 < starts.size(); ++k) climbers.push_back({starts[k], density[k]});
  climb_freely(objective, climbers, rounds, untold, stop);
  std::vector<double> found;
  for (FreeClimber const& each : climbers) {
    double const place = (each.theta(along.p) - mode(along.p)) / along.sd;
    if (!(each.log_density > density.back() - as_high) || std::fabs(place) < apart) continue;
    if (std::none_of(found.begin(), found.end(), [&](double other) { return std::fabs(place - other) < apart; }))
      found.push_back(place);
  }
  for (double& each : found) each = std::fabs(each);
  std::sort(found.begin(), found.end());
  return found;
}

Finding repeated(Target const& target, Eigen::Index p, std::size_t places, bool certain) {
  std::string const& name = target.parameters()[static_cast<std::size_t>(p)].name;
  std::string const why =
      fmt::format("{} local searches that started further away ended at other values of `{}` that fit equally well", places, name);
  std::string const help = fmt::format("bound `{}` by `lower` and `upper` to one period, or give it a proper prior", name);
  if (certain) return {FindingCode::improper_posterior, Severity::error, {name}, "the posterior is improper: " + why, help};
  return {
      FindingCode::propriety_not_checked, Severity::warning, {name}, "whether the posterior is proper is not known: " + why, help};
}

}  // namespace

Findings find_repeats(Objective const& objective, Mode const& mode, std::uint64_t seed, std::function<bool()> const& stop) {
  constexpr std::size_t some = 2, many = 4;
  constexpr double spread = 20;
  constexpr double narrow = 0.3;  // of a logarithm: what is wider has been followed to where it ends
  Eigen::MatrixXd const covariance = covariance_of(mode);
  Eigen::VectorXd const theta = theta_of(mode);
  Findings findings;
  for (Eigen::Index p = 0; p < theta.size() && !(stop && stop()); ++p) {
    Improper const kind = objective.target.parameters()[static_cast<std::size_t>(p)].improper;
    double const sd = std::min(std::sqrt(std::max(covariance(p, p), 0.0)), objective.scale(p));
    if (kind == Improper::no || !(sd > 0) || (kind == Improper::half_line && sd > narrow)) continue;
    std::vector<double> const found = as_high_as(objective, {p, kind == Improper::line, sd}, theta, seed, stop);
    if (found.size() < some) continue;
    findings.push_back(repeated(objective.target, p, found.size(), found.size() >= many && found.back() > spread * found.front()));
  }
  return findings;
}

}  // namespace sysid::unbounded
