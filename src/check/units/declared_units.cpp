// Words for units that are missing, from the names and units that the file uses.
#include "check/units/declared_units.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <utility>

#include "check/units/changed_power.hpp"
#include "check/units/unit_errors.hpp"
#include "syntax/unparse.hpp"
#include "syntax/walk.hpp"

namespace sysid {
namespace {

// A factor of a product that is a number without a unit; null when there is none.
ast::Expression const* bare_factor(ast::Expression const& tree) {
  if (auto const* number = std::get_if<ast::Number>(&tree.node)) return number->unit ? nullptr : &tree;
  if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&tree.node)) return bare_factor(*(*unary)->operand);
  auto const* binary = std::get_if<ast::Box<ast::Binary>>(&tree.node);
  if (binary == nullptr || ((*binary)->symbol != "*" && (*binary)->symbol != "/")) return nullptr;
  ast::Expression const* left = bare_factor(*(*binary)->left);
  return left != nullptr || (*binary)->symbol == "/" ? left : bare_factor(*(*binary)->right);
}

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

// A unit in coherent SI, without the name it was written by.
Unit plain(Unit const& unit) {
  Unit result;
  result.dimension = unit.dimension;
  return result;
}

std::vector<std::string> names_in(ast::Expression const& tree) {
  std::vector<std::string> names;
  each_reference(tree, [&](ast::Reference const& reference) { names.push_back(reference.name.text); });
  return names;
}

// A declared unit times a factor, in the names that it is written with where they have one for it.
Unit changed(Unit const& unit, Dimension const& missing) {
  Unit factor;
  factor.dimension = missing;
  Unit result = multiply(plain(unit), factor);
  result.text = with_changed_power(unit.text, missing);
  return result;
}

// Whether it is what somebody measured, and no factor of a formula such as 2, 0.5 or 3/4.
bool is_measured_number(ast::Expression const& tree) {
  auto const* number = std::get_if<ast::Number>(&tree.node);
  auto const fraction = number == nullptr ? std::nullopt : to_rational(number->value);
  constexpr int of_formulas = 4;
  return number != nullptr && (!fraction || fraction->denominator > of_formulas);
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

// How often a name is a factor of a product, -1 below the fraction line; nothing where it stands elsewhere as well, as in a sum.
std::optional<int> factor_power(ast::Expression const& tree, std::string const& name) {
  std::vector<std::string> const used = names_in(tree);
  if (std::find(used.begin(), used.end(), name) == used.end()) return 0;
  if (std::holds_alternative<ast::Reference>(tree.node)) return 1;
  if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&tree.node)) return factor_power(*(*unary)->operand, name);
  auto const* binary = std::get_if<ast::Box<ast::Binary>>(&tree.node);
  if (binary == nullptr || ((*binary)->symbol != "*" && (*binary)->symbol != "/")) return std::nullopt;
  auto const left = factor_power(*(*binary)->left, name), right = factor_power(*(*binary)->right, name);
  if (!left || !right) return std::nullopt;
  return (*binary)->symbol == "*" ? *left + *right : *left - *right;
}

}  // namespace

void DeclaredUnits::declare(DeclaredUnit declared) {
  add_unit_names(declared.unit.text, names_in_use_);
  declared_.push_back(std::move(declared));
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

std::string DeclaredUnits::named(Dimension const& dimension, std::vector<std::string> const& but) const {
  Unit second;
  second.dimension[2] = {1, 1};
  std::string text;
  int count = 0;
  for (DeclaredUnit const& each : declared_) {
    if (std::find(but.begin(), but.end(), each.name) != but.end() || !may_stand_here(each.name)) continue;
    std::string name;
    if (each.unit.dimension == dimension)
      name = each.name;
    else if (each.moves && divide(each.unit, second).dimension == dimension)
      name = each.name + "'";
    if (name.empty() || ++count > 2) continue;
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
  std::vector<std::string> but;
  if (pure && odd != nullptr) but = names_in(*odd);
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
  auto const by_factor = [&](std::string_view what) { return factor_cure(what, wanted, odd != nullptr, but); };
  if (odd != nullptr && !pure)
    if (auto const declared = declared_otherwise(*odd, missing, is_term)) {
      std::string const other = errors::declare_in(declared->name, words(declared->unit));
      return is_term && is_power_of_moving(*odd, missing) ? other + ", or " + by_factor("this term") : other;
    }
  // `x + 9.81*m`: the number is a quantity.
  if (ast::Expression const* number = odd == nullptr || pure ? nullptr : bare_factor(*odd);
      number != nullptr && number != odd && is_measured_number(*number))
    return errors::tag_the_number(unparse(*number), unit_of_number(*odd, wanted));
  return by_factor("this");
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
std::string DeclaredUnits::factor_cure(std::string_view what, Wanted const& wanted, bool in_text,
                                       std::vector<std::string> const& but) const {
  Dimension const& missing = wanted.missing;
  if (std::string const names = named(missing, but); !names.empty())
    return errors::multiply_by(what, kind_words(missing, names_in_use_), names);
  if (std::string const names = named(inverse(missing), but); !names.empty())
    return errors::divide_by(what, kind_words(inverse(missing), names_in_use_), names);
  if (wanted.of_a_number && in_text)
    return errors::multiply_by(what, kind_words(missing, names_in_use_), "`1 [" + wanted.unit + "]`");
  if (is_plain_kind(missing)) return errors::multiply_by(what, kind_words(missing, names_in_use_), "");
  if (is_plain_kind(inverse(missing))) return errors::divide_by(what, kind_words(inverse(missing), names_in_use_), "");
  return errors::should_be_in(what, wanted.unit);
}

bool DeclaredUnits::is_power_of_moving(ast::Expression const& odd, Dimension const& missing) const {
  std::vector<std::string> const used = names_in(odd);
  return std::any_of(declared_.begin(), declared_.end(), [&](DeclaredUnit const& each) {
    return each.moves && (each.unit.dimension == missing || each.unit.dimension == inverse(missing)) &&
           std::find(used.begin(), used.end(), each.name) != used.end();
  });
}

// A coefficient that multiplies something that moves, as in k3*y^3: its declaration is as likely to be wrong as the power of y,
// unless what is missing is no power of y but another name: a mass, where the other terms are accelerations. Of a unit that is no
// kind of its own, such as 1/m^2, a name would be a factor by accident: a noise precision has that one.
std::optional<DeclaredUnit> DeclaredUnits::declared_otherwise(ast::Expression const& odd, Dimension const& missing,
                                                              bool is_term) const {
  std::vector<std::string> const used = names_in(odd);
  bool const moves = std::any_of(declared_.begin(), declared_.end(), [&](DeclaredUnit const& each) {
    return each.moves && std::find(used.begin(), used.end(), each.name) != used.end();
  });
  if (!moves) return std::nullopt;
  bool const another_name = !named(inverse(missing), {}).empty() || (is_plain_kind(missing) && !named(missing, {}).empty());
  if (another_name && !(is_term && is_power_of_moving(odd, missing))) return std::nullopt;
  std::optional<DeclaredUnit> coefficient = only_coefficient(odd, declared_);
  std::optional<int> const power = coefficient ? factor_power(odd, coefficient->name) : std::nullopt;
  if (!power || std::abs(*power) != 1) return std::nullopt;
  coefficient->unit = changed(coefficient->unit, *power == 1 ? missing : inverse(missing));
  if (coefficient->unit.dimensionless()) return std::nullopt;
  return coefficient;
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
