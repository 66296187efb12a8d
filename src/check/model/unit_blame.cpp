// Tries other units in a declaration: the model is checked again with each, and the messages are compared.
#include "check/model/unit_blame.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "check/model/mistakes.hpp"
#include "check/model/model_checker.hpp"
#include "check/units/changed_power.hpp"
#include "check/units/unit_errors.hpp"
#include "check/units/units.hpp"

namespace sysid {

namespace {

// A conflict of which a declaration is to blame says by which factor, up to the power with which the name enters.
constexpr Rational powers[] = {{1, 1}, {-1, 1}, {1, 2}, {-1, 2}, {1, 3}, {-1, 3}};
constexpr std::size_t most_factors = 4;

ast::UnitExpression written(Dimension const& dimension, Span span) {
  constexpr char const* bases[] = {"kg", "m", "s", "A", "K", "mol", "cd"};
  ast::UnitExpression unit{{span}, {}};
  for (std::size_t i = 0; i < dimension.size(); ++i) {
    if (dimension[i].numerator == 0) continue;
    ast::UnitFactor factor{{span}, ast::Name{{span}, bases[i]}, std::nullopt, false};
    double const exponent = static_cast<double>(dimension[i].numerator) / dimension[i].denominator;
    factor.exponent = ast::Box<ast::Expression>(ast::Expression{{span}, ast::Number{{span}, exponent, std::nullopt}});
    unit.factors.push_back(std::move(factor));
  }
  if (unit.factors.empty()) unit.factors.push_back({{span}, ast::Name{{span}, "-"}, std::nullopt, false});
  return unit;
}

Dimension product(Dimension const& a, Dimension const& b, Rational power) {
  Dimension result;
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = a[i] + b[i] * power;
  return result;
}

class Search {
 public:
  Search(ast::Model const& model, std::vector<ast::FunctionDefinition const*> const& shared, std::set<Mistake> before)
      : model_(model), shared_(shared), before_(std::move(before)) {}

  struct Blame {
    ast::Name name;
    std::string unit;
    std::set<Mistake> resolved;
  };

  std::optional<Blame> run() {
    Diagnostics said;
    ModelChecker checker(model_, shared_, said);
    checker.run();
    std::vector<Dimension> factors;
    for (Dimension const& each : checker.units().missing())
      if (factors.size() < most_factors && std::find(factors.begin(), factors.end(), each) == factors.end())
        factors.push_back(each);
    std::vector<ast::Declared> declared;  // elements of a vector share a place
    each_declared(model_, [&](ast::Declared const& each) {
      bool const fresh = std::none_of(declared.begin(), declared.end(),
                                      [&](ast::Declared const& other) { return other.name.span == each.name.span; });
      if (each.unit && fresh) declared.push_back(each);
    });
    std::optional<Blame> best;
    bool alone = true;
    for (ast::Declared const& each : declared) {
      if (resolved_by(each, std::nullopt).size() < 2) continue;
      auto const blame = best_unit(each, factors, checker.units());
      if (!blame) continue;
      if (!best || blame->resolved.size() > best->resolved.size()) {
        best = blame;
        alone = true;
      } else if (blame->resolved.size() == best->resolved.size()) {
        alone = false;
      }
    }
    return alone ? best : std::nullopt;
  }

 private:
  std::optional<Blame> best_unit(ast::Declared const& declared, std::vector<Dimension> const& factors, UnitCheck const& units) {
    Diagnostics said_before;
    auto const now = check_unit(*declared.unit, said_before);
    if (!now) return std::nullopt;
    std::optional<Blame> best;
    for (Dimension const& factor : factors)
      for (Rational const power : powers) {
        Unit unit;
        unit.dimension = product(now->dimension, factor, power);
        std::set<Mistake> resolved = resolved_by(declared, written(unit.dimension, declared.unit->span));
        if (resolved.size() >= 2 && (!best || resolved.size() > best->resolved.size())) {
          static Dimension const acceleration = unit_atom("g_n").value().dimension;
          Dimension const change = quotient(unit.dimension, now->dimension);
          std::string kept = change == acceleration ? with_force_for_mass(now->text) : std::string();
          if (kept.empty()) kept = with_changed_power(now->text, change);
          best = Blame{declared.name, kept.empty() ? units.words(unit) : kept, std::move(resolved)};
        }
      }
    return best;
  }

  // The errors that are gone with another unit, or none, in a declaration; nothing where there are new ones.
  std::set<Mistake> resolved_by(ast::Declared const& declared, std::optional<ast::UnitExpression> const& unit) {
    ast::Model changed = model_;
    each_declared(changed, [&](ast::Declared& each) {
      if (each.name.span == declared.name.span) each.unit = unit;
    });
    Diagnostics said;
    ModelChecker(changed, shared_, said).run();
    std::set<Mistake> const after = mistakes_from(0, said);
    std::set<Mistake> resolved;
    if (!std::includes(before_.begin(), before_.end(), after.begin(), after.end())) return resolved;
    std::set_difference(before_.begin(), before_.end(), after.begin(), after.end(), std::inserter(resolved, resolved.end()));
    return resolved;
  }

  ast::Model model_;
  std::vector<ast::FunctionDefinition const*> const& shared_;
  std::set<Mistake> before_;
};

}  // namespace

void blame_declaration(ast::Model const& model, std::vector<ast::FunctionDefinition const*> const& shared, std::size_t first,
                       Diagnostics& diagnostics) {
  std::set<Mistake> const before = mistakes_from(first, diagnostics);
  std::set<Mistake> conflicts;
  for (std::size_t i = first; i < diagnostics.all().size(); ++i)
    if (errors::is_unit_conflict(diagnostics.all()[i])) conflicts.insert(mistake_of(diagnostics.all()[i]));
  if (conflicts.size() < 2 || model.statements.size() > most_statements) return;
  auto const blame = Search(model, shared, before).run();
  if (!blame) return;
  replace_resolved(diagnostics, first, blame->resolved, [&](Diagnostic earliest) {
    return errors::blamed(std::move(earliest), blame->name, blame->unit, static_cast<int>(blame->resolved.size()));
  });
}

}  // namespace sysid
