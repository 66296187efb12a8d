// The families, as the user could have written their terms.
#include "check/dictionary/generators.hpp"

#include <optional>
#include <string>

#include "check/elaborate/tree.hpp"
#include "core/setting/table.hpp"

namespace sysid {
namespace {

using Expressions = std::vector<ast::Expression>;
using Arguments = std::span<ast::Expression const>;

ast::Expression call(std::string name, ast::Expression argument, Span place) {
  return tree::call({{place}, std::move(name)}, {std::move(argument)}, place);
}

ast::Expression product(ast::Expression left, ast::Expression right, Span place) {
  return tree::binary("*", std::move(left), std::move(right), place);
}

ast::Expression power(ast::Expression const& base, int exponent, Span place) {
  return exponent == 1 ? base : tree::binary("^", base, tree::number(exponent, place), place);
}

/// All of total degree 1 to `degree`, by degree, then by the power of the first, the second, ... falling.
Expressions polynomial(Arguments variables, int degree, ast::Expression const*, Span place) {
  Expressions terms;
  std::vector<int> exponents(variables.size(), 0);
  auto const add = [&] {
    std::optional<ast::Expression> term;
    for (std::size_t i = 0; i < variables.size(); ++i) {
      if (exponents[i] == 0) continue;
      ast::Expression factor = power(variables[i], exponents[i], place);
      term = term ? product(std::move(*term), std::move(factor), place) : std::move(factor);
    }
    terms.push_back(std::move(*term));
  };
  auto const spread = [&](auto const& self, std::size_t from, int left) -> void {
    if (from + 1 == variables.size()) {
      exponents[from] = left;
      add();
      return;
    }
    for (int here = left; here >= 0; --here) {
      exponents[from] = here;
      self(self, from + 1, left - here);
    }
  };
  for (int total = 1; total <= degree; ++total) spread(spread, 0, total);
  return terms;
}

/// sin(k v) and cos(k v) of each v, k = 1 to `harmonics`.
Expressions trigonometric(Arguments variables, int harmonics, ast::Expression const*, Span place) {
  Expressions terms;
  for (ast::Expression const& variable : variables)
    for (int k = 1; k <= harmonics; ++k)
      for (char const* name : {"sin", "cos"})
        terms.push_back(call(name, k == 1 ? variable : product(tree::number(k, place), variable, place), place));
  return terms;
}

/// The laws of stdlib/damping that are linear in their coefficients: viscous v, quadratic v |v|; and v^3.
Expressions damping(Arguments velocities, int, ast::Expression const*, Span place) {
  Expressions terms;
  for (ast::Expression const& v : velocities) {
    terms.push_back(v);
    terms.push_back(product(call("abs", v, place), v, place));
    terms.push_back(power(v, 3, place));
  }
  return terms;
}

/// Dry friction and the viscous part beside it; with a velocity of Stribeck, what the static friction has more than the kinetic
/// one, in the form of stdlib/damping.
Expressions friction(Arguments velocities, int, ast::Expression const* stribeck, Span place) {
  Expressions terms;
  for (ast::Expression const& v : velocities) {
    terms.push_back(call("sign", v, place));
    terms.push_back(v);
    if (stribeck == nullptr) continue;
    ast::Expression const ratio = tree::binary("/", v, *stribeck, place);
    ast::Expression const fall = call("exp", tree::unary("-", power(ratio, 2, place), place), place);
    terms.push_back(product(fall, call("sign", v, place), place));
  }
  return terms;
}

GeneratorRow const all[] = {
    {"polynomial",
     "all products of powers up to a total degree, without the constant 1",
     {"degree", GeneratorOption::Kind::whole, true, 20, "polynomial(y, y', degree = 3)"},
     &polynomial},
    {"trigonometric",
     "sin and cos of each argument and of its multiples",
     {"harmonics", GeneratorOption::Kind::whole, true, 100, "trigonometric(angle, harmonics = 2)"},
     &trigonometric},
    {"damping", "of each velocity v: v, abs(v)*v, v^3", {.example = "damping(y')"}, &damping},
    {"friction",
     "of each velocity v: sign(v), v; with `stribeck` also exp(-(v/stribeck)^2)*sign(v)",
     {"stribeck", GeneratorOption::Kind::expression, false, 0, "friction(y', stribeck = 1 [mm/s])"},
     &friction},
};

}  // namespace

std::span<GeneratorRow const> generators() { return all; }

std::vector<std::string> generator_names() {
  std::vector<std::string> names;
  for (GeneratorRow const& row : all) names.emplace_back(row.name);
  return names;
}

GeneratorRow const* find_generator(std::string_view name) { return row_named(all, name); }

}  // namespace sysid
