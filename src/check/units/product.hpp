// The factors of a product as they are written, and the product without some of them: for what a unit converts already.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "syntax/ast.hpp"

namespace sysid {

/// The factors of a product, those of its parts among them, in the order of the text.
struct ProductFactor {
  ast::Expression const* tree;
  bool divides = false;
  double number = 0;  // of a number without a unit and of `pi`; 0: something else
};
std::vector<ProductFactor> product_factors(ast::Expression const& tree);

/// "2*pi*sqrt(k/m)", "c/(2*m)", "1/T".
std::string product_text(std::vector<ProductFactor> const& factors);

/// Bare numbers among the factors of a product that are together some number, and the product without them.
struct FactorTaken {
  std::string factor, rest;
};
/// The fewest that are `wanted`, to the digits that people write: 57.3 of 180/pi. Nothing where there are none, or nothing but
/// them.
std::optional<FactorTaken> taken_from_product(ast::Expression const& tree, double wanted);

/// With 2*pi on the other side of the fraction, where it stands on the wrong one; else empty.
std::string with_turns_moved(ast::Expression const& tree, bool multiply);

}  // namespace sysid
