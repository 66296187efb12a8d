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
  Term const mean = (location + member.pull * square) * share, sd = scale * sqrt(share), narrowing = 0.5 * log1p(informed);
  return {mean, sd, log(scale) - narrowing};
}

}  // namespace

Coordinate constrain_member(Graph& graph, Support const& support, LocationScale const& prior, MemberCoordinate const& member,
                            NodeId v) {
  Conditional const given = conditional(graph, prior, member);
  Coordinate const moved = constrain(graph, support, (given.mean + given.sd * Term(graph, v)).id);
  return {moved.value, (Term(graph, moved.log_jacobian) + given.log_sd).id};
}

NodeId log_density_of_member(Graph& graph, Distribution const& use, MemberCoordinate const& member, NodeId v) {
  LocationScale const prior = location_scale(graph, use);
  Support const allowed = support(graph, use);
  Term const location(graph, prior.location), scale(graph, prior.scale), coordinate(graph, v);
  // z = (w - mu)/tau
  Term z = coordinate;
  if (member.precision != 0 || member.pull != 0) {
    Term const informed = 1.0 + member.precision * (scale * scale);
    Term const spread = coordinate / sqrt(informed);
    z = scale * (member.pull - member.precision * location) / informed + spread;
  }
  Coordinate const standardised = constrain(graph, allowed, z.id);
  Conditional const given = conditional(graph, prior, member);
  Coordinate const moved = constrain(graph, allowed, (given.mean + given.sd * coordinate).id);
  Term const of_z(graph, log_density(graph, standard(graph, use), standardised.value));
  // Nodes in this order on every compiler.
  Term const log_scale = log(scale), density = of_z + Term(graph, standardised.log_jacobian);
  return (density - log_scale - Term(graph, moved.log_jacobian)).id;
}

NodeId unconstrain_member(Graph& graph, Support const& support, LocationScale const& prior, MemberCoordinate const& member,
                          NodeId x) {
  Conditional const given = conditional(graph, prior, member);
  return ((Term(graph, unconstrain(graph, support, x)) - given.mean) / given.sd).id;
}

}  // namespace sysid
