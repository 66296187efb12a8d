// Coordinates for the members of hierarchies, from what the data say of each.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "likelihood/parameter_space.hpp"
#include "search/global/search.hpp"

namespace sysid {

/// What the data say of the members of `space`, in its order.
struct MemberInformation {
  std::vector<MemberCoordinate> members;  // of each by itself
  /// Of each, the largest precision of any combination of members of its population: more than any of them has by itself where the
  /// data know a combination only, such as a sum.
  std::vector<double> sharpest;
};

/// That at a place of declared values: precision and pull of the likelihood after integration over all other parameters, in the
/// approximation
///
///   2 log p(y | u) = 2 g'(u - u0) - (u - u0)' H (u - u0),   H = J'J,   other parameters normal with the widths of their priors
///
/// about the place u0, with J the slopes of the residuals and g the gradient there. declared: a target of `space`, whose members
/// all have the coordinates of their priors.
MemberInformation member_information(Target const& declared, ParameterSpace const& space, std::vector<double> const& mode,
                                     std::uint64_t seed);

/// The coordinates of all members that a search begins with, when nothing is known of the data: (w - location)/scale.
std::vector<MemberCoordinate> non_centred(ParameterSpace const& space);

/// A target with such coordinates; with none, those that were declared.
using MakeStandardised = std::function<std::unique_ptr<Target>(std::vector<MemberCoordinate> const&)>;

struct StandardisedSearch {
  std::vector<MemberCoordinate> coordinates;  // none: those that were declared
  SearchResult found;
};

/// Follows the modes of the posterior that a search in `non_centred` coordinates has `found` to those that suit the data: first
/// those of members given their population and what the data say, in which the highest density over members and population lies
/// where that of the population alone is highest, if the likelihood is normal. There all members of a population get the declared
/// ones if each has h tau^2 >= 25, h its precision, or if only a combination of them has; the others keep theirs, by what the data
/// say at the new modes. space: with declared coordinates.
StandardisedSearch follow_members(ParameterSpace const& space, SearchResult found, MakeStandardised const& make,
                                  RunContext& context);

}  // namespace sysid
