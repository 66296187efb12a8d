// Dictionaries: the terms that an equation may be made of.
#pragma once
#include "grammar/expression.hpp"

namespace sysid::grammar {

inline constexpr x3::rule<struct dictionary_tag, ast::Dictionary> dictionary = "a dictionary";

BOOST_SPIRIT_DECLARE(decltype(dictionary))

}  // namespace sysid::grammar
