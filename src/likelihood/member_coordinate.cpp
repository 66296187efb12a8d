// The conditional mean and sd of a member, given its population.
#include "likelihood/member_coordinate.hpp"

#include "function/primitive.hpp"

namespace sysid {
namespace {

/// Of w given the population.
struct Conditional {
  Term mean, sd, log_sd;
};

Conditional conditional(Graph& graph, LocationScale const& prior, MemberCoordinate const& member) {
  Term const location(graph, prior.location), scale(graph, prior.scale);
  if (member.precision == 0 && member.pull == 0) return {location, scale, log(scale)};
  Term const square = scale * scale;
  Term const informed = member.precision * square;
  Term const share = 1.0 / (1.0 + informed);
  return {(location + member.pull * square) * share, scale * sqrt(share), log(scale) - 0.5 * log1p(informed)};
}

}  // namespace

Coordinate constrain_member(Graph& graph, Support const& support, LocationScale const& prior, MemberCoordinate const& member,
                            NodeId v) {
  Conditional const given = conditional(graph, prior, member);
  Coordinate const moved = constrain(graph, support, (given.mean + given.sd * Term(graph, v)).id);
  return {moved.value, (Term(graph, moved.log_jacobian) + given.log_sd).id};
}

NodeId unconstrain_member(Graph& graph, Support const& support, LocationScale const& prior, MemberCoordinate const& member,
                          NodeId x) {
  Conditional const given = conditional(graph, prior, member);
  return ((Term(graph, unconstrain(graph, support, x)) - given.mean) / given.sd).id;
}

}  // namespace sysid
