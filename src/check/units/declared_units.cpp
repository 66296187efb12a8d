// Words for units that are missing, from the names and units that the file uses.
#include "check/units/declared_units.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <utility>

#include "check/units/changed_power.hpp"
#include "check/units/product.hpp"
#include "check/units/term_shape.hpp"
#include "check/units/unit_errors.hpp"
#include "syntax/unparse.hpp"
#include "syntax/walk.hpp"

namespace sysid {
namespace {

// A factor of a product that is a name with primes or without; null when there is none.
ast::Reference const* named_factor(ast::Expression const& tree, std::vector<DeclaredUnit> const& declared) {
  if (auto const* reference = std::get_if<ast::Reference>(&tree.node)) {
    bool const moves = std::any_of(declared.begin(), declared.end(),
                                   [&](DeclaredUnit const& each) { return each.moves && each.name == reference->name.text; });
    return moves ? reference : nullptr;
  }
  if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&tree.node)) return named_factor(*(*unary)->operand, declared);
  auto const* binary = std::get_if<ast::Box<ast::Binary>>(&tree.node);
  if (binary == nullptr || ((*binary)->symbol != "*" && (*binary)->symbol != "/")) return nullptr;
  ast::Reference const* left = named_factor(*(*binary)->left, declared);
  return left != nullptr || (*binary)->symbol == "/" ? left : named_factor(*(*binary)->right, declared);
}

/// Declared in the model of a part, whose unit is right there.
bool is_of_part(std::string const& name) { return name.find('.') != std::string::npos; }

// A unit in coherent SI, without the name it was written by.
Unit plain(Unit const& unit) {
  Unit result;
  result.dimension = unit.dimension;
  return result;
}

// A declared unit times a factor, in the names that it is written with where they have one for it.
Unit changed(Unit const& unit, Dimension const& missing) {
  Unit factor;
  factor.dimension = missing;
  Unit result = multiply(plain(unit), factor);
  result.text = with_changed_power(unit.text, missing);
  return result;
}

// The one declared name in an expression that does not move and is no pure number: what its unit depends on, beside the states.
std::optional<DeclaredUnit> only_coefficient(ast::Expression const& tree, std::vector<DeclaredUnit> const& declared) {
  std::optional<DeclaredUnit> found;
  for (std::string const& name : names_in(tree))
    for (DeclaredUnit const& each : declared) {
      if (each.name != name || each.moves || each.unit.dimensionless()) continue;
      if (found) return std::nullopt;
      found = each;
    }
  return found;
}

// "h" of "1/h" and "1/h" of "h"; empty for all else.
std::string inverse_text(std::string const& unit) {
  bool const below = unit.starts_with("1/");
  std::string const name = below ? unit.substr(2) : unit;
  if (!unit_atom(name)) return {};
  return below ? name : "1/" + name;
}

}  // namespace

void DeclaredUnits::declare(DeclaredUnit declared) {
  add_unit_names(declared.unit.text, names_in_use_);
  declared_.push_back(std::move(declared));
}

void DeclaredUnits::note_places(std::string const& name, int places, bool in_widths_alone) {
  auto const found = roles_.find(name);
  if (found == roles_.end()) return;
  found->second.places = places;
  found->second.in_widths_alone = in_widths_alone;
}

std::string DeclaredUnits::words(Unit const& unit) const {
  if (unit.text.empty() && !unit.dimensionless())
    for (DeclaredUnit const& each : declared_)
      if (each.unit.dimension == unit.dimension && each.unit.scale == 1 && each.unit.offset == unit.offset &&
          each.unit.radian == unit.radian && each.unit.hertz == unit.hertz)
        return each.unit.text;
  return unit_words(unit, names_in_use_);
}

bool DeclaredUnits::may_stand_here(std::string const& name) const {
  using Kind = DeclaredRole::Kind;
  auto const is = [&](std::string const& whose, auto... kinds) {
    auto const found = roles_.find(whose);
    return found != roles_.end() && ((found->second.kind == kinds) || ...);
  };
  if (is(name, Kind::reported)) return false;
  if (auto const role = roles_.find(name); role != roles_.end() && role->second.in_widths_alone) return false;
  if (is(place_, Kind::constant) && !is(name, Kind::constant)) return false;
  bool const one_value = is(place_, Kind::fixed, Kind::varying);  // of a parameter, or an initial value
  std::vector<std::string> names = {name};                        // and all that it reads
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == place_ || (one_value && is(names[i], Kind::varying))) return false;
    auto const read = roles_.find(names[i]);
    if (read == roles_.end()) continue;
    for (std::string const& each : read->second.reads)
      if (std::find(names.begin(), names.end(), each) == names.end()) names.push_back(each);
  }
  return true;
}

std::string DeclaredUnits::named(Dimension const& dimension, std::vector<std::string> const& but, Which which) const {
  Unit second;
  second.dimension[2] = {1, 1};
  std::string text;
  int count = 0;
  for (DeclaredUnit const& each : declared_) {
    if ((which == Which::fixed && each.moves) || !may_stand_here(each.name)) continue;
    std::string name;
    if (each.unit.dimension == dimension)
      name = each.name;
    else if (each.moves && divide(each.unit, second).dimension == dimension)
      name = each.name + "'";
    if (name.empty() || std::find(but.begin(), but.end(), name) != but.end() || ++count > 2) continue;
    text += (text.empty() ? "`" : " or `") + name + "`";
  }
  return text;
}

std::string DeclaredUnits::by_weight(ast::Expression const& odd, Wanted const& wanted) const {
  static Dimension const acceleration = unit_atom("g_n").value().dimension;
  if (wanted.missing != acceleration) return {};
  for (DeclaredUnit const& each : declared_)
    if (!each.moves && each.unit.dimension == acceleration) return {};
  auto const is_read = [](std::vector<std::string> const& names, std::string const& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  auto const needs_mass = [&](std::string const& name) {
    return std::any_of(wanted.agreeing.begin(), wanted.agreeing.end(),
                       [&](auto* each) { return is_read(names_in(*each), name); }) ||
           std::any_of(roles_.begin(), roles_.end(),
                       [&](auto const& each) { return each.first != place_ && is_read(each.second.reads, name); });
  };
  std::vector<std::string> const names = names_in(odd);
  for (DeclaredUnit const& each : declared_)
    if (is_read(names, each.name) && !needs_mass(each.name))
      if (std::string const force = with_force_for_mass(each.unit.text); !force.empty())
        return errors::declare_in(each.name, force);
  return {};
}

std::string DeclaredUnits::cure(ast::Expression const* odd, Wanted const& wanted) const {
  Dimension const& missing = wanted.missing;
  bool const pure = wanted.pure, is_term = wanted.is_term;
  KeptOut const but = odd == nullptr ? KeptOut{} : names_kept_out(*odd, pure);
  if (odd != nullptr && wanted.is_width)
    if (std::string width = width_cure(*odd, wanted); !width.empty()) return width;
  if (odd != nullptr && !pure)
    if (std::string written = writing_cure(*odd, wanted); !written.empty()) return written;
  if (odd != nullptr && !pure)
    if (std::string weight = by_weight(*odd, wanted); !weight.empty()) return weight;
  if (odd != nullptr && !pure) {
    // A number in the place of a coefficient: nothing else in the product could carry its unit.
    ast::Expression const* number = bare_factor(*odd);
    std::vector<std::string> const used = names_in(*odd);
    bool const coefficient = std::any_of(declared_.begin(), declared_.end(), [&](DeclaredUnit const& each) {
      return !each.moves && std::find(used.begin(), used.end(), each.name) != used.end();
    });
    if (number != nullptr && !coefficient && !used.empty())
      return errors::tag_the_number(unparse(*number), unit_of_number(*odd, wanted));
  }
  if (odd != nullptr && !pure)
    if (std::string inverse_meant = by_inverse(*odd, missing); !inverse_meant.empty()) return inverse_meant;
  // A prime too few or too many is likelier than a missing rate or time, whatever there is by that unit.
  ast::Reference const* moving = odd == nullptr || pure ? nullptr : named_factor(*odd, declared_);
  for (int const primes : {1, 2}) {
    Dimension time{};
    time[2] = {primes, 1};
    if (moving != nullptr && (missing == inverse(time) || (missing == time && moving->primes >= primes))) {
      auto const coefficient = only_coefficient(*odd, declared_);
      auto const power = coefficient ? factor_power(*odd, coefficient->name) : std::nullopt;
      bool const may_differ = power && std::abs(*power) == 1;
      std::string const other = may_differ ? words(changed(coefficient->unit, power == -1 ? inverse(missing) : missing)) : "";
      return errors::primes_wrong(moving->name.text, moving->primes, moving->primes + (missing == time ? -primes : primes),
                                  may_differ ? coefficient->name : "", other);
    }
  }
  if (odd != nullptr && wanted.is_reciprocal) return errors::reciprocal_meant(turned_over(*odd), wanted.unit);
  if (odd != nullptr && !pure)
    if (auto const declared = declared_otherwise(*odd, missing, is_term)) {
      std::string const other = errors::declare_in(declared->name, words(declared->unit));
      bool const by_name = is_power_of_moving(*odd, missing) || another_name(missing, but, Which::all);
      std::string const factor = is_term && by_name ? factor_cure("this term", wanted, true, but) : std::string();
      return factor.empty() ? other : other + ", or " + factor;
    }
  // `x + 9.81*m`: the number is a quantity.
  if (ast::Expression const* number = odd == nullptr || pure ? nullptr : bare_factor(*odd);
      number != nullptr && number != odd && is_measured_number(*number))
    return errors::tag_the_number(unparse(*number), unit_of_number(*odd, wanted));
  std::string const factor = factor_cure("this", wanted, odd != nullptr, but);
  return factor.empty() ? errors::should_be_in("this", wanted.unit) : factor;
}

std::string DeclaredUnits::unit_of_number(ast::Expression const& odd, Wanted const& wanted) const {
  Unit si;
  si.dimension = wanted.missing;
  auto const simple = [](std::string const& text) { return !text.empty() && text.find_first_of(" */^") == std::string::npos; };
  std::vector<std::string> used = names_in(odd);
  std::erase(used, "pi");
  Unit const* const other = used.size() == 1 && wanted.scale > 0 ? unit_of(used.front()) : nullptr;
  auto const is_si = [](double scale) { return std::fabs(scale - 1) < 1e-9; };  // of a product, rounded
  if (other == nullptr || (is_si(wanted.scale) && is_si(other->scale)) || !simple(wanted.unit) || !simple(other->text))
    return words(si);
  bool rate = false;
  each_reference(odd, [&](ast::Reference const& reference) { rate = rate || reference.primes > 0; });
  std::optional<int> const power = factor_power(odd, used.front());
  if (rate || !power || *power != 1) return words(si);
  return other->dimension == Dimension{} && other->scale == 1 ? wanted.unit : wanted.unit + "/" + other->text;
}

// `c/k` of a rate k, `c*tau` of a time: on the other side of the fraction line the coefficient would fit.
std::string DeclaredUnits::by_inverse(ast::Expression const& odd, Dimension const& missing) const {
  auto const coefficient = only_coefficient(odd, declared_);
  auto const power = coefficient ? factor_power(odd, coefficient->name) : std::nullopt;
  if (!power || std::abs(*power) != 1) return {};
  Dimension const& own = coefficient->unit.dimension;
  Dimension twice;
  for (std::size_t i = 0; i < own.size(); ++i) twice[i] = own[i] + own[i];
  if (missing != (*power == 1 ? inverse(twice) : twice)) return {};
  Unit meant;
  meant.dimension = inverse(own);
  std::string const turned = inverse_text(coefficient->unit.text);
  return errors::inverse_meant(coefficient->name, *power == 1, turned.empty() ? words(meant) : turned);
}

// The term as it is declared, with another factor.
std::string DeclaredUnits::factor_cure(std::string_view what, Wanted const& wanted, bool in_text, KeptOut const& but) const {
  Dimension const& missing = wanted.missing;
  Which const which = wanted.is_width ? Which::fixed : Which::all;
  if (std::string const names = named(missing, but.factors, which); !names.empty())
    return errors::multiply_by(what, kind_words(missing, names_in_use_), names);
  if (std::string const names = named(inverse(missing), but.divisors, which); !names.empty())
    return errors::divide_by(what, kind_words(inverse(missing), names_in_use_), names);
  if (wanted.is_width) return {};
  if (wanted.of_a_number && in_text)
    return errors::multiply_by(what, kind_words(missing, names_in_use_), "`1 [" + wanted.unit + "]`");
  if (is_plain_kind(missing)) return errors::multiply_by(what, kind_words(missing, names_in_use_), "");
  if (is_plain_kind(inverse(missing))) return errors::divide_by(what, kind_words(inverse(missing), names_in_use_), "");
  return {};
}

bool DeclaredUnits::is_power_of_moving(ast::Expression const& odd, Dimension const& missing) const {
  std::vector<std::string> const used = names_in(odd);
  return std::any_of(declared_.begin(), declared_.end(), [&](DeclaredUnit const& each) {
    return each.moves && (each.unit.dimension == missing || each.unit.dimension == inverse(missing)) &&
           std::find(used.begin(), used.end(), each.name) != used.end();
  });
}

// A coefficient that multiplies something that moves, as in k3*y^3: its declaration is as likely to be wrong as the power of y,
// unless what is missing is no power of y but another name: a mass, where the other terms are accelerations. A coefficient that
// nothing else reads is likelier to be declared wrongly than to lack another state. Of a unit that is no kind of its own, such as
// 1/m^2, a name would be a factor by accident: a noise precision has that one.
std::optional<DeclaredUnit> DeclaredUnits::declared_otherwise(ast::Expression const& odd, Dimension const& missing,
                                                              bool is_term) const {
  std::vector<std::string> const used = names_in(odd);
  bool const moves = std::any_of(declared_.begin(), declared_.end(), [&](DeclaredUnit const& each) {
    return each.moves && std::find(used.begin(), used.end(), each.name) != used.end();
  });
  if (!moves) return std::nullopt;
  std::optional<DeclaredUnit> coefficient = only_coefficient(odd, declared_);
  auto const role = coefficient ? roles_.find(coefficient->name) : roles_.end();
  Which const which = role != roles_.end() && role->second.places == 1 ? Which::fixed : Which::all;
  if (another_name(missing, names_kept_out(odd, false), which) && !(is_term && is_power_of_moving(odd, missing)))
    return std::nullopt;
  std::optional<int> const power = coefficient ? factor_power(odd, coefficient->name) : std::nullopt;
  if (!power || std::abs(*power) != 1 || is_of_part(coefficient->name)) return std::nullopt;
  coefficient->unit = changed(coefficient->unit, *power == 1 ? missing : inverse(missing));
  if (coefficient->unit.dimensionless()) return std::nullopt;
  return coefficient;
}

bool DeclaredUnits::another_name(Dimension const& missing, KeptOut const& but, Which which) const {
  return !named(inverse(missing), but.divisors, which).empty() ||
         (is_plain_kind(missing) && !named(missing, but.factors, which).empty());
}

// A term divided by a state that it contains is another term, or 0/0 at rest. As a factor such a state is one more power of it,
// unless it stands in a function: one more `y'` beside `sign(y')` is another law.
DeclaredUnits::KeptOut DeclaredUnits::names_kept_out(ast::Expression const& odd, bool pure) const {
  KeptOut out;
  auto const add = [&](ast::Expression const& part, std::vector<std::string>& names) {
    each_reference(part, [&](ast::Reference const& reference) {
      auto const found = std::ranges::find(declared_, reference.name.text, &DeclaredUnit::name);
      if (!pure && (found == declared_.end() || !found->moves)) return;
      names.push_back(reference.name.text + std::string(static_cast<std::size_t>(reference.primes), '\''));
      if (pure) names.push_back(reference.name.text);
    });
  };
  add(odd, out.divisors);
  // A definition of a state that stands there is that state by another name.
  std::vector<std::string> const contained = out.divisors;
  for (auto const& [name, role] : roles_) {
    auto const stands_here = [&](std::string const& read) {
      return std::ranges::any_of(contained, [&](std::string const& each) { return each == read || each == read + "'"; });
    };
    if (std::ranges::any_of(role.reads, stands_here)) out.divisors.push_back(name);
  }
  for (ProductFactor const& factor : product_factors(odd))
    if (pure || !simple_dimension(*factor.tree)) add(*factor.tree, out.factors);
  return out;
}

std::string DeclaredUnits::width_cure(ast::Expression const& odd, Wanted const& wanted) const {
  auto const* number = std::get_if<ast::Number>(&odd.node);
  if (number != nullptr && number->unit) return errors::should_be_in("this", wanted.unit);
  auto const* name = std::get_if<ast::Reference>(&odd.node);
  if (name == nullptr) return {};
  auto const declared = std::ranges::find(declared_, name->name.text, &DeclaredUnit::name);
  if (declared == declared_.end() || is_of_part(declared->name)) return {};
  if (declared->moves) return errors::should_be_in("this", wanted.unit);
  auto const role = roles_.find(name->name.text);
  int const places = role == roles_.end() ? 0 : role->second.places;
  if (places > 1) return roles_.contains(wanted.of) ? std::string() : errors::own_width(wanted.of, wanted.unit);
  auto const* location = wanted.location == nullptr ? nullptr : std::get_if<ast::Reference>(&wanted.location->node);
  for (int primes = 1; location != nullptr && primes <= location->primes; ++primes) {
    Dimension rate{};
    rate[2] = {-primes, 1};
    if (wanted.missing == rate)
      return errors::primes_wrong(location->name.text, location->primes, location->primes - primes, name->name.text, wanted.unit);
  }
  return errors::declare_in(name->name.text, wanted.unit);
}

std::optional<Dimension> DeclaredUnits::simple_dimension(ast::Expression const& factor) const {
  if (auto const* number = std::get_if<ast::Number>(&factor.node)) return number->unit ? std::nullopt : std::optional(Dimension{});
  if (auto const* binary = std::get_if<ast::Box<ast::Binary>>(&factor.node)) {
    auto const* exponent = std::get_if<ast::Number>(&(*binary)->right->node);
    bool const whole = exponent != nullptr && !exponent->unit && exponent->value >= 1 && exponent->value <= 9 &&
                       exponent->value == std::floor(exponent->value);
    auto base = (*binary)->symbol == "^" && whole ? simple_dimension(*(*binary)->left) : std::nullopt;
    if (base)
      for (Rational& each : *base) each = each * Rational{static_cast<int>(exponent->value), 1};
    return base;
  }
  auto const* name = std::get_if<ast::Reference>(&factor.node);
  if (name == nullptr) return std::nullopt;
  if (name->name.text == "pi") return Dimension{};
  Unit const* const unit = unit_of(name->name.text);
  if (unit == nullptr || !name->index.empty()) return std::nullopt;
  Dimension primes{};
  primes[2] = {name->primes, 1};
  return quotient(unit->dimension, primes);
}

std::string DeclaredUnits::writing_cure(ast::Expression const& odd, Wanted const& wanted) const {
  if (auto const* number = std::get_if<ast::Number>(&odd.node); number != nullptr && number->unit && number->value == 0)
    return errors::zero_in(wanted.unit);
  static Dimension const acceleration = unit_atom("g_n").value().dimension, mass = unit_atom("kg").value().dimension;
  if (wanted.missing == quotient(acceleration, mass))
    for (std::string const& name : names_in(odd))
      if (Unit const* const unit = unit_of(name); unit != nullptr && unit->text == "g" && factor_power(odd, name) == 1)
        return errors::declared_in_grams(name);
  // `b/m*L^2` of a term that fits as `b/(m*L^2)`.
  std::vector<ProductFactor> factors = product_factors(odd);
  for (std::size_t i = 0; i < factors.size(); ++i) {
    if (!factors[i].divides) continue;
    Dimension change{};
    for (std::size_t last = i + 1; last < factors.size() && !factors[last].divides; ++last) {
      auto const dimension = simple_dimension(*factors[last].tree);
      if (!dimension) break;
      for (std::size_t k = 0; k < change.size(); ++k) change[k] = change[k] + (*dimension)[k] + (*dimension)[k];
      if (change == Dimension{} || wanted.missing != inverse(change)) continue;
      for (std::size_t j = i + 1; j <= last; ++j) factors[j].divides = true;
      return errors::parentheses_lost(product_text(factors));
    }
  }
  return {};
}

bool DeclaredUnits::used_as_angular(ast::Expression const* cycles, Unit const& ours, ast::Expression const* other,
                                    Unit const& theirs) const {
  if (cycles == nullptr || ours.hertz.numerator == 0 || theirs.hertz.numerator != 0 || !(ours.radian == theirs.radian))
    return false;
  if (std::abs(ours.hertz.numerator) == 2 && ours.hertz.denominator == 1) return true;
  bool derivative = false;
  if (other != nullptr)
    each_reference(*other, [&](ast::Reference const& reference) { derivative = derivative || reference.primes > 0; });
  return derivative && std::any_of(declared_.begin(), declared_.end(), [&](DeclaredUnit const& each) {
           std::vector<std::string> const names = names_in(*cycles);
           bool const stands_here = std::find(names.begin(), names.end(), each.name) != names.end();
           return stands_here && each.moves && each.unit.hertz.numerator == 0;
         });
}

Unit const* DeclaredUnits::unit_of(std::string const& name) const {
  auto const found = std::ranges::find(declared_, name, &DeclaredUnit::name);
  return found == declared_.end() ? nullptr : &found->unit;
}

std::string DeclaredUnits::frequency_in(ast::Expression const& tree) const {
  for (std::string const& name : names_in(tree))
    for (DeclaredUnit const& each : declared_)
      if (each.name == name && each.unit.hertz.numerator != 0) return name;
  return {};
}

}  // namespace sysid
