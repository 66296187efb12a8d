// Sets of candidate models.
#pragma once
#include "grammar/expression.hpp"

namespace sysid::grammar {

struct candidates_tag {};

inline constexpr x3::rule<candidates_tag, ast::Candidates> candidates = "a set of candidate models";

BOOST_SPIRIT_DECLARE(decltype(candidates))

}  // namespace sysid::grammar
