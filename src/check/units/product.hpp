// The factors of a product as they are written, and the product without some of them: for conversions that a unit already makes
// (E2214).
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "syntax/ast.hpp"

namespace sysid {

/// The factors of a product, those of its parts among them, in the order of the text. A minus before one is beside it.
struct ProductFactor {
  ast::Expression const* tree;
  bool divides = false;
  double number = 0;     // of a number without a unit and of `pi`; 0: something else
  bool negated = false;  // the whole product by a minus before this factor
};
std::vector<ProductFactor> product_factors(ast::Expression const& tree);

/// "2*pi*sqrt(k/m)", "c/(2*m)", "1/T"; without a minus before a factor.
std::string product_text(std::vector<ProductFactor> const& factors);

/// A conversion among the factors of a product, and the product without it.
struct FactorTaken {
  std::string factor, rest;
  std::string sign = {};  // "-" or empty, before the rest
};
/// One bare number, or one with pi or 2*pi, that is `wanted` to the digits that people write: 57.3 of 180/pi. Two numbers that make
/// it together are likelier a formula's own, and so is one beside a number with a unit (a strain of 0.001 times 200 [GPa]). Nothing
/// where there are none, nothing but them, or nothing to convert (1).
std::optional<FactorTaken> taken_from_product(ast::Expression const& tree, double wanted);

/// With 2*pi on the other side of the fraction, where it stands on the wrong one; else empty.
std::string with_turns_moved(ast::Expression const& tree, bool multiply);

}  // namespace sysid
