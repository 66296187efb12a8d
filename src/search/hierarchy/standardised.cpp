// The information of each member, and the way of the modes.
#include "search/hierarchy/standardised.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "linear_algebra/decompositions.hpp"
#include "search/descent.hpp"
#include "search/laplace.hpp"
#include "search/local_slopes.hpp"
#include "search/mode_findings.hpp"

namespace sysid {
namespace {

/// h tau^2 from which on the population adds so little to a member that its own coordinate is as good.
constexpr double well_informed = 25;
/// Relative change of what is known of the members that leaves their coordinates good.
constexpr double as_good_as_known = 0.1;
constexpr int most_rounds_of_coordinates = 4;
/// Precision of a combination of members, over that of any of them alone, from which on it ties them to each other.
constexpr double much_sharper = 4;
constexpr std::size_t most_followed = 12;                // modes
constexpr std::uint64_t standardising_step = 6'000'000;  // a stream of its own among those of Purpose::start

LaneArray unconstrained(Target const& target, std::vector<double> const& declared) {
  LaneArray values(target.dimension(), 1), theta(target.dimension(), 1);
  for (int p = 0; p < target.dimension(); ++p) values(p, 0) = declared[static_cast<std::size_t>(p)];
  target.unconstrain(values, theta);
  return theta;
}

bool by_coordinate(MemberCoordinate const& a, MemberCoordinate const& b) { return a.coordinate < b.coordinate; }

/// The first modes in the coordinates of a target [P x N].
LaneArray modes_in(Target const& target, std::vector<Mode> const& modes) {
  std::vector<Eigen::VectorXd> places;
  for (std::size_t m = 0; m < std::min(modes.size(), most_followed); ++m)
    places.push_back(column(unconstrained(target, modes[m].declared), 0));
  return to_lanes(places);
}

std::vector<double> scales_at(Target const& declared, ParameterSpace const& space, std::vector<double> const& mode) {
  LaneArray scales(static_cast<int>(space.members().size()), 1);
  space.member_scales(unconstrained(declared, mode), scales);
  return {scales.view().data(), scales.view().data() + scales.rows()};
}

/// Coordinates of members with the same population as one that is little known, unless their data tie them to each other: members
/// given their population would lie on a ridge, which bends with its scale.
std::set<int> little_known(ParameterSpace const& space, MemberInformation const& known, std::vector<double> const& scales) {
  std::map<std::vector<int>, double> highest;  // precision of one member
  for (std::size_t m = 0; m < scales.size(); ++m) {
    double& own = highest.try_emplace(space.members()[m].population, 0).first->second;
    own = std::max(own, known.members[m].precision);
  }
  std::set<std::vector<int>> little, tied;
  for (std::size_t m = 0; m < scales.size(); ++m) {
    std::vector<int> const& population = space.members()[m].population;
    double const variance = scales[m] * scales[m];
    if (!(known.members[m].precision * variance >= well_informed)) little.insert(population);
    if (known.sharpest[m] * variance >= well_informed && known.sharpest[m] > much_sharper * highest[population])
      tied.insert(population);
  }
  std::set<int> coordinates;
  for (ParameterSpace::Member const& member : space.members())
    if (little.contains(member.population) && !tied.contains(member.population)) coordinates.insert(member.coordinate);
  return coordinates;
}

/// Of each member the largest eigenvalue of what the data know of its population's members together.
std::vector<double> sharpest(ParameterSpace const& space, Eigen::MatrixXd const& covariance, Eigen::VectorXd const& of_prior) {
  std::map<std::vector<int>, std::vector<int>> together;
  for (ParameterSpace::Member const& member : space.members()) together[member.population].push_back(member.coordinate);
  std::map<std::vector<int>, double> largest;
  for (auto const& [population, members] : together) {
    Eigen::MatrixXd known = inverse(covariance(members, members));
    for (Eigen::Index k = 0; k < known.rows(); ++k) known(k, k) -= of_prior(members[static_cast<std::size_t>(k)]);
    largest[population] = known.allFinite() ? symmetric_eigen(known).values.maxCoeff() : 0;
  }
  std::vector<double> all;
  for (ParameterSpace::Member const& member : space.members()) all.push_back(largest[member.population]);
  return all;
}

bool alike(std::vector<MemberCoordinate> const& a, std::vector<MemberCoordinate> const& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](MemberCoordinate const& x, MemberCoordinate const& y) {
    // The place of the likelihood in its own sds.
    double const root = std::sqrt(std::max(x.precision, y.precision));
    return x.coordinate == y.coordinate &&
           std::fabs(x.precision - y.precision) <= as_good_as_known * std::max(x.precision, y.precision) &&
           std::fabs(x.pull - y.pull) <= as_good_as_known * root;
  });
}

/// The findings of a search with those about its modes replaced.
Findings with_modes_of(Findings findings, Target const& target, std::vector<Mode> const& modes) {
  remove_mode_findings(findings);
  for (Finding& each : mode_findings(target, ObjectiveKind::posterior, modes)) findings.push_back(std::move(each));
  return findings;
}

}  // namespace

MemberInformation member_information(Target const& declared, ParameterSpace const& space, std::vector<double> const& mode,
                                     std::uint64_t seed) {
  Objective const objective = make_objective(declared, ObjectiveKind::posterior, seed, standardising_step);
  LaneArray const theta = unconstrained(declared, mode);
  Ledger looked;
  LikelihoodSlope const slope = local_slopes(declared, theta, difference_width(declared) * objective.scale, looked).front();
  Eigen::MatrixXd precision = slope.curvature;
  Eigen::VectorXd const of_prior = objective.scale.cwiseAbs2().cwiseInverse();
  precision.diagonal() += of_prior;
  Eigen::MatrixXd const covariance = inverse(precision);
  Eigen::VectorXd const step = covariance * slope.gradient;

  std::vector<MemberCoordinate> members;
  for (ParameterSpace::Member const& member : space.members()) {
    int const p = member.coordinate;
    // That of the member alone is what remains when its prior is taken out: 1/covariance - 1/width^2.
    double const own = std::max(0.0, 1 / covariance(p, p) - of_prior(p));
    double const pull = own * theta(p, 0) + step(p) / covariance(p, p);
    bool const usable = std::isfinite(own) && std::isfinite(pull);
    members.push_back({p, usable ? own : 0, usable ? pull : 0});
  }
  return {std::move(members), sharpest(space, covariance, of_prior)};
}

std::vector<MemberCoordinate> non_centred(ParameterSpace const& space) {
  std::vector<MemberCoordinate> members;
  for (ParameterSpace::Member const& member : space.members()) members.push_back({member.coordinate, 0, 0});
  std::sort(members.begin(), members.end(), by_coordinate);
  return members;
}

StandardisedSearch follow_members(ParameterSpace const& space, SearchResult found, MakeStandardised const& make,
                                  RunContext& context) {
  std::unique_ptr<Target> const declared = make({});
  StandardisedSearch result{non_centred(space), std::move(found)};
  std::optional<std::set<int>> standardised;
  for (int pass = 0; pass < most_rounds_of_coordinates; ++pass) {
    std::vector<double> const& mode = result.found.modes.front().declared;
    MemberInformation known = member_information(*declared, space, mode, context.seed);
    if (pass == 1) standardised = little_known(space, known, scales_at(*declared, space, mode));
    std::vector<MemberCoordinate> chosen = std::move(known.members);
    if (standardised) std::erase_if(chosen, [&](MemberCoordinate const& each) { return !standardised->contains(each.coordinate); });
    std::sort(chosen.begin(), chosen.end(), by_coordinate);
    if (context.stop_requested()) break;
    if (alike(chosen, result.coordinates)) {
      if (pass > 0) break;
      continue;  // which members are little known is still to be decided
    }
    std::unique_ptr<Target> const target = chosen.empty() ? nullptr : make(chosen);
    Target const& next = target ? *target : *declared;
    LaneArray const starts = modes_in(next, result.found.modes);
    SearchResult again =
        search_from(next, ObjectiveKind::posterior, starts, context, "searching in coordinates of the members of hierarchies");
    result.found.interrupted = again.interrupted;
    if (again.interrupted || again.failure) break;
    result.coordinates = std::move(chosen);
    result.found.findings = with_modes_of(std::move(result.found.findings), next, again.modes);
    result.found.modes = std::move(again.modes);
  }
  return result;
}

}  // namespace sysid
