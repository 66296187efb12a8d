// One number is tried with each pi: 60 and 2*pi in 60*sqrt(k/m)/(2*pi).
#include "check/units/product.hpp"

#include <fmt/format.h>

#include <algorithm>
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
  if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&tree.node); unary != nullptr && (*unary)->symbol == "-") {
    std::size_t const first = factors.size();
    take_factors(*(*unary)->operand, divides, factors);
    factors[first].negated = !factors[first].negated;
    return;
  }
  auto const* number = std::get_if<ast::Number>(&tree.node);
  auto const* name = std::get_if<ast::Reference>(&tree.node);
  double const pi = name != nullptr && name->name.text == "pi" ? std::numbers::pi : 0;
  factors.push_back({&tree, divides, number != nullptr && !number->unit ? number->value : pi});
}

std::string sign_of(std::vector<ProductFactor> const& factors) {
  return std::count_if(factors.begin(), factors.end(), [](ProductFactor const& each) { return each.negated; }) % 2 == 1 ? "-" : "";
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

/// A number that may convert: no 1, no pi, and not beside a number with a unit, which it multiplies.
bool is_own_number(std::vector<ProductFactor> const& factors, std::size_t i) {
  auto const has_unit = [&](std::size_t j) {
    auto const* number = j < factors.size() ? std::get_if<ast::Number>(&factors[j].tree->node) : nullptr;
    return number != nullptr && number->unit;
  };
  double const number = factors[i].number;
  return number != 0 && number != 1 && number != std::numbers::pi && !has_unit(i + 1) && (i == 0 || !has_unit(i - 1));
}

/// Each pi, alone and with a 2 beside it on the same side of the fraction.
std::vector<std::vector<std::size_t>> turns_among(std::vector<ProductFactor> const& factors) {
  std::vector<std::vector<std::size_t>> turns;
  for (std::size_t i = 0; i < factors.size(); ++i) {
    if (factors[i].number != std::numbers::pi) continue;
    turns.push_back({i});
    for (std::size_t const j : {i - 1, i + 1})  // before the first: beyond the last
      if (j < factors.size() && factors[j].number == 2 && factors[j].divides == factors[i].divides) turns.push_back({i, j});
  }
  return turns;
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
  constexpr double rounded = 1e-3;
  std::vector<ProductFactor> const factors = product_factors(tree);
  bool const all_numbers = std::all_of(factors.begin(), factors.end(), [](ProductFactor const& each) { return each.number != 0; });
  if (all_numbers || std::fabs(wanted - 1) < rounded) return std::nullopt;
  auto const take = [&](std::vector<std::size_t> const& indices) -> std::optional<FactorTaken> {
    double value = 1;
    for (std::size_t const i : indices) value *= factors[i].divides ? 1 / factors[i].number : factors[i].number;
    if (!(std::fabs(value / wanted - 1) < rounded)) return std::nullopt;
    std::vector<ProductFactor> taken, rest;
    for (std::size_t i = 0; i < factors.size(); ++i)
      (std::find(indices.begin(), indices.end(), i) != indices.end() ? taken : rest).push_back(factors[i]);
    return FactorTaken{product_text(taken), product_text(rest), sign_of(factors)};
  };
  std::vector<std::vector<std::size_t>> const turns = turns_among(factors);
  for (bool const with_turn : {false, true})
    for (std::size_t i = 0; i < factors.size(); ++i) {
      if (!is_own_number(factors, i)) continue;
      if (!with_turn)
        if (auto const found = take({i})) return found;
      for (std::vector<std::size_t> turn : turns) {
        if (!with_turn || std::find(turn.begin(), turn.end(), i) != turn.end()) continue;
        turn.push_back(i);
        if (auto const found = take(turn)) return found;
      }
    }
  return std::nullopt;
}

std::string with_turns_moved(ast::Expression const& tree, bool multiply) {
  // One factor of 2 and those of pi, by which cycles and radians are converted, are counted only.
  std::vector<ProductFactor> others;
  int pi_above = 0, pi_below = 0, twos = 0;
  std::vector<ProductFactor> const factors = product_factors(tree);
  for (ProductFactor const& factor : factors) {
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
  std::string const sign = sign_of(factors);
  if (multiply) return fmt::format("{}2*pi*{}{}", sign, top, below == 0 ? "" : below > 1 ? "/(" + bottom + ")" : "/" + bottom);
  return fmt::format("{}{}/(2*pi{}{})", sign, top, below == 0 ? "" : "*", bottom);
}

}  // namespace sysid
