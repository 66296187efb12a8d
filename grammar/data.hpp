// Data blocks.
#pragma once
#include "grammar/expression.hpp"

namespace sysid::grammar {

struct data_tag {};

inline constexpr x3::rule<data_tag, ast::Data> data = "a data block";

BOOST_SPIRIT_DECLARE(decltype(data))

}  // namespace sysid::grammar
