// Coordinates of the members of a hierarchy that do not narrow with its spread.
#pragma once
#include "distribution/location_scale.hpp"

namespace sysid {

/// What the data say of a member by themselves, on the unbounded scale w of its prior: their log likelihood is about
/// pull w - precision/2 w^2. SI. Without both it is not used for the coordinate, which is then (w - location)/scale.
struct MemberCoordinate {
  int coordinate;  // of the space, the place of the member's parameter
  double precision, pull;
};

/// The member's value as a function of its coordinate v, and log |dx/dv|:
///
///   w = (mu + k tau^2)/(1 + h tau^2) + v tau/sqrt(1 + h tau^2),    h = precision, k = pull,    Christensen, Roberts, Skoeld 2006
///
/// the mean and the sd of w given mu and tau, if the data say what `member` holds: v is then normal, whatever mu and tau are. Where
/// the data say little (h tau^2 << 1) v is (w - mu)/tau, the non-centred form; where they say much, w itself, moved and scaled.
/// Any h >= 0 and k give valid coordinates.
Coordinate constrain_member(Graph& graph, Support const& support, LocationScale const& prior, MemberCoordinate const& member,
                            NodeId v);
/// log of the prior density of that value, from v and not from w: where tau is far below the last digit of mu, w - mu is lost.
NodeId log_density_of_member(Graph& graph, Distribution const& use, MemberCoordinate const& member, NodeId v);
/// The inverse.
NodeId unconstrain_member(Graph& graph, Support const& support, LocationScale const& prior, MemberCoordinate const& member,
                          NodeId x);

}  // namespace sysid
