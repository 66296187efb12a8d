// What the checker could not compare, by cause: names without a unit, each with the terms that could not be checked because of it.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "check/expression/scope.hpp"
#include "syntax/unparse.hpp"
#include "syntax/walk.hpp"

namespace sysid {
namespace {

// "so `a*y` is not compared", "so `a*y`, `b*y` and 3 more are not compared".
std::string consequence(std::vector<std::string> const& terms) {
  if (terms.empty()) return "";
  constexpr std::size_t shown = 2;
  std::string text = fmt::format("`{}`", terms.front());
  if (terms.size() > 1) text += fmt::format("{} `{}`", terms.size() == shown ? " and" : ",", terms[1]);
  if (terms.size() > shown) text += fmt::format(" and {} more", terms.size() - shown);
  return fmt::format(", so {} {} not compared", text, terms.size() == 1 ? "is" : "are");
}

}  // namespace

// A longer list of names helps nobody.
constexpr std::size_t most_open_names = 100;

// The names that leave the unit of `tree` open; seen: definitions already looked into.
void Scope::open_names(ast::Expression const& tree, std::set<std::string>& names, std::set<std::string>& seen) const {
  each_reference(tree, [&](ast::Reference const& reference) {
    std::string const& name = reference.name.text;
    Symbol const* symbol = find(name);
    if (seen.size() == most_open_names) return;
    if (symbol == nullptr || symbol->unit || !seen.insert(name).second) return;
    auto const* definition = std::get_if<DefinitionSymbol>(&symbol->what);
    if (definition == nullptr) {
      names.insert(name);
      return;
    }
    auto const value = resolved_.find(definition->definition);
    if (value != resolved_.end() && value->second && value->second->kind == Typed::Kind::known) return;
    bool number = true;
    each_reference(definition->definition->value, [&](ast::Reference const&) { number = false; });
    if (number) names.insert(name);
    open_names(definition->definition->value, names, seen);
  });
}

std::vector<Unchecked> Scope::unchecked() const {
  std::vector<Unchecked> result;
  std::map<std::string, std::vector<std::string>> terms;
  for (UnitCheck::NotCompared const& each : units_.not_compared()) {
    std::set<std::string> names, seen;
    open_names(*each.tree, names, seen);
    std::string const text = unparse(*each.tree);
    if (names.empty() || !each.why.empty())
      result.push_back({text, each.tree->span, each.why.empty() ? "its unit is not known" : each.why});
    else
      for (std::string const& name : names)
        if (auto& known = terms[name]; text != name && std::find(known.begin(), known.end(), text) == known.end())
          known.push_back(text);
  }
  for (auto const& [name, symbol] : symbols_) {
    if (symbol.unit) continue;
    bool const number = std::holds_alternative<DefinitionSymbol>(symbol.what);
    if (number && !terms.contains(name)) continue;  // its value tells its unit, or the names in it are listed
    result.push_back({name, symbol.span, (number ? "a number without a unit" : "no unit is declared") + consequence(terms[name])});
  }
  std::sort(result.begin(), result.end(), [](Unchecked const& a, Unchecked const& b) { return a.span.begin < b.span.begin; });
  return result;
}

}  // namespace sysid
