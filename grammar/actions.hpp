// The semantic actions of all rules: where a parsed part goes in its node. They replace X3's attribute propagation, which would
// need Fusion adaptations and traits for std::variant and std::optional, and loses its way with nodes of one member.
#pragma once
#include <boost/spirit/home/x3.hpp>
#include <utility>

#include "syntax/ast.hpp"

namespace sysid::grammar {

/// The part is the node.
inline constexpr auto take = [](auto& context) { boost::spirit::x3::_val(context) = std::move(boost::spirit::x3::_attr(context)); };

/// The part is one member of the node.
template <class Node, class Member>
constexpr auto to(Member Node::*member) {
  return [member](auto& context) { boost::spirit::x3::_val(context).*member = std::move(boost::spirit::x3::_attr(context)); };
}

/// The part is one more element of a member.
template <class Node, class Member>
constexpr auto append(Member Node::*member) {
  return [member](auto& context) {
    (boost::spirit::x3::_val(context).*member).push_back(std::move(boost::spirit::x3::_attr(context)));
  };
}

/// The part is what an expression consists of; the rule sets the span.
inline constexpr auto take_node = [](auto& context) {
  boost::spirit::x3::_val(context).node = std::move(boost::spirit::x3::_attr(context));
};

/// The part is a whole expression, kept in a box.
inline constexpr auto take_boxed = [](auto& context) {
  auto& part = boost::spirit::x3::_attr(context);
  Span const span = part.span;
  boost::spirit::x3::_val(context) = {{span}, ast::Box(std::move(part))};
};

/// The operator of a unary node.
constexpr auto symbol(char const* spelling) {
  return [spelling](auto& context) { boost::spirit::x3::_val(context).symbol = spelling; };
}

/// The presence of a part is the value of a member.
template <class Node, class Member>
constexpr auto set(Member Node::*member, Member value) {
  return [member, value](auto& context) { boost::spirit::x3::_val(context).*member = value; };
}

}  // namespace sysid::grammar
