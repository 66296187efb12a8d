// Subsets of a few numbers are tried, the smaller first: 60 and 2*pi in 60*sqrt(k/m)/(2*pi).
#include "check/units/product.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <numbers>

#include "syntax/unparse.hpp"

namespace sysid {
namespace {

void take_factors(ast::Expression const& tree, bool divides, std::vector<ProductFactor>& factors) {
  if (auto const* binary = std::get_if<ast::Box<ast::Binary>>(&tree.node);
      binary != nullptr && ((*binary)->symbol == "*" || (*binary)->symbol == "/")) {
    take_factors(*(*binary)->left, divides, factors);
    return take_factors(*(*binary)->right, divides != ((*binary)->symbol == "/"), factors);
  }
  auto const* number = std::get_if<ast::Number>(&tree.node);
  auto const* name = std::get_if<ast::Reference>(&tree.node);
  double const pi = name != nullptr && name->name.text == "pi" ? std::numbers::pi : 0;
  factors.push_back({&tree, divides, number != nullptr && !number->unit ? number->value : pi});
}

std::string factors_on_side(std::vector<ProductFactor> const& factors, bool divides, int& count) {
  std::string text;
  for (ProductFactor const& factor : factors) {
    if (factor.divides != divides) continue;
    auto const* binary = std::get_if<ast::Box<ast::Binary>>(&factor.tree->node);
    bool const choice = std::holds_alternative<ast::Box<ast::Conditional>>(factor.tree->node);
    bool const sum = choice || (binary != nullptr && (*binary)->symbol != "^");
    text += (text.empty() ? "" : "*") + (sum ? "(" + unparse(*factor.tree) + ")" : unparse(*factor.tree));
    ++count;
  }
  return text;
}

}  // namespace

std::vector<ProductFactor> product_factors(ast::Expression const& tree) {
  std::vector<ProductFactor> factors;
  take_factors(tree, false, factors);
  return factors;
}

std::string product_text(std::vector<ProductFactor> const& factors) {
  int above = 0, below = 0;
  std::string const top = factors_on_side(factors, false, above), bottom = factors_on_side(factors, true, below);
  if (below == 0) return above == 0 ? "1" : top;
  return fmt::format("{}/{}", above == 0 ? "1" : top, below > 1 ? "(" + bottom + ")" : bottom);
}

std::optional<FactorTaken> taken_from_product(ast::Expression const& tree, double wanted) {
  constexpr std::size_t most_numbers = 6;
  constexpr double rounded = 1e-3;
  std::vector<ProductFactor> const factors = product_factors(tree);
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < factors.size(); ++i)
    if (factors[i].number != 0) numbers.push_back(i);
  if (numbers.size() > most_numbers || numbers.size() == factors.size()) return std::nullopt;
  unsigned best = 0;
  for (unsigned subset = 1; subset < 1U << numbers.size(); ++subset) {
    double value = 1;
    for (std::size_t i = 0; i < numbers.size(); ++i)
      if ((subset >> i & 1U) != 0)
        value *= factors[numbers[i]].divides ? 1 / factors[numbers[i]].number : factors[numbers[i]].number;
    if (std::fabs(value / wanted - 1) < rounded && (best == 0 || std::popcount(subset) < std::popcount(best))) best = subset;
  }
  if (best == 0) return std::nullopt;
  std::vector<ProductFactor> taken, rest;
  for (std::size_t i = 0, number = 0; i < factors.size(); ++i) {
    bool const is_number = number < numbers.size() && numbers[number] == i;
    (is_number && (best >> number & 1U) != 0 ? taken : rest).push_back(factors[i]);
    number += is_number ? 1 : 0;
  }
  return FactorTaken{product_text(taken), product_text(rest)};
}

std::string with_turns_moved(ast::Expression const& tree, bool multiply) {
  // One factor of 2 and those of pi, by which cycles and radians are converted, are counted only.
  std::vector<ProductFactor> others;
  int pi_above = 0, pi_below = 0, twos = 0;
  for (ProductFactor const& factor : product_factors(tree)) {
    if (factor.number == 2 && twos++ == 0) continue;
    if (factor.number == std::numbers::pi)
      ++(factor.divides ? pi_below : pi_above);
    else
      others.push_back(factor);
  }
  if ((multiply ? pi_below : pi_above) != 1 || (multiply ? pi_above : pi_below) != 0) return {};
  int above = 0, below = 0;
  std::string const top = factors_on_side(others, false, above), bottom = factors_on_side(others, true, below);
  if (above == 0) return {};
  if (multiply) return fmt::format("2*pi*{}{}", top, below == 0 ? "" : below > 1 ? "/(" + bottom + ")" : "/" + bottom);
  return fmt::format("{}/(2*pi{}{})", top, below == 0 ? "" : "*", bottom);
}

}  // namespace sysid
