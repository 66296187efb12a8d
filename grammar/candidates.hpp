// Sets of candidate models.
#pragma once
#include "grammar/expression.hpp"

namespace sysid::grammar {

inline constexpr x3::rule<struct candidates_tag, ast::Candidates> candidates = "a set of candidate models";

BOOST_SPIRIT_DECLARE(decltype(candidates))

}  // namespace sysid::grammar
