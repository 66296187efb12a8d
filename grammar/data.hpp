// Data blocks.
#pragma once
#include "grammar/expression.hpp"

namespace sysid::grammar {

inline constexpr x3::rule<struct data_tag, ast::Data> data = "a data block";

BOOST_SPIRIT_DECLARE(decltype(data))

}  // namespace sysid::grammar
