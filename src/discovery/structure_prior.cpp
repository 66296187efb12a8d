// Odds of one term, each by itself.
#include "discovery/structure_prior.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <variant>

#include "core/numeric/elementary.hpp"
#include "discovery/found_structure.hpp"
#include "syntax/walk.hpp"

namespace sysid {
namespace {

constexpr double expected_terms = 0.5;
constexpr double most_probable = 0.5;  // of a term, where few are offered
constexpr double highest_power = 9;

/// A whole number from 1 on, as an exponent is; 0: something else.
double whole_power(ast::Expression const& exponent) {
  auto const* number = std::get_if<ast::Number>(&exponent.node);
  bool const whole =
      number != nullptr && number->value >= 1 && number->value <= highest_power && std::floor(number->value) == number->value;
  return whole ? number->value : 0;
}

bool is_number(ast::Expression const& tree) { return std::holds_alternative<ast::Number>(tree.node); }

}  // namespace

double simplicity(ast::Expression const& term) {
  double weight = 1;
  each_expression(term, [&](ast::Expression const& part) {
    if (auto const* call = std::get_if<ast::Box<ast::Call>>(&part.node)) {
      std::string const& name = (*call)->function.text;
      weight *= name == "abs" || name == "sign" ? simplicity_of_factor : simplicity_of_function;
    } else if (std::holds_alternative<ast::Box<ast::Conditional>>(part.node)) {
      weight *= simplicity_of_function;
    } else if (auto const* binary = std::get_if<ast::Box<ast::Binary>>(&part.node)) {
      ast::Binary const& of = **binary;
      if (of.symbol == "*" && !is_number(*of.left) && !is_number(*of.right)) weight *= simplicity_of_factor;
      if (of.symbol == "/" && !is_number(*of.right)) weight *= simplicity_of_function;
      if (of.symbol == "^") {
        double const power = whole_power(*of.right);
        weight *= power > 0 ? std::pow(simplicity_of_factor, power - 1) : simplicity_of_function;
      }
    }
  });
  return weight;
}

std::vector<double> log_odds_of(std::vector<double> const& weights) {
  std::vector<double> odds(weights.size(), 0);
  double sum = 0;
  for (double const weight : weights) sum += weight;
  for (std::size_t j = 0; j < weights.size(); ++j) {
    if (!(weights[j] > 0)) continue;
    double const probability = std::min(expected_terms * weights[j] / sum, most_probable);
    odds[j] = elementary::log(probability / (1 - probability));
  }
  return odds;
}

std::vector<double> log_term_odds(std::vector<DictionaryTerm> const& terms, regression::FoundEquation const& equation) {
  std::vector<double> weights(terms.size(), 0);
  for (std::size_t j = 0; j < terms.size(); ++j)
    if (!terms[j].in_target && is_offered(equation, j)) weights[j] = simplicity(terms[j].tree);
  return log_odds_of(weights);
}

}  // namespace sysid
