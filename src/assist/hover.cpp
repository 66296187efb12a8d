// Declarations in the user's words; units as declared, or as the checker finds them.
#include "assist/hover.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/catalogue/module_page.hpp"
#include "check/elaborate/elaborate.hpp"
#include "check/expression/scope.hpp"
#include "check/model/model.hpp"
#include "check/units/units.hpp"
#include "core/text/without_index.hpp"

namespace sysid::assist {
namespace {

std::string fenced(std::string_view text) { return fmt::format("```sysid\n{}\n```\n", text); }

/// Without the braces and what is between them.
std::string_view head(std::string_view text) {
  std::string_view first = text.substr(0, text.find('{'));
  while (!first.empty() && (first.back() == ' ' || first.back() == '\n')) first.remove_suffix(1);
  return first;
}

bool is_block(SymbolKind kind) {
  return kind == SymbolKind::model || kind == SymbolKind::data || kind == SymbolKind::candidates || kind == SymbolKind::dictionary;
}

/// Of a declaration that lists several names the part about this one.
std::string declaration_text(Reading const& reading, Symbol const& symbol) {
  std::string_view const whole = reading.source.text(symbol.statement);
  if (is_block(symbol.kind)) return std::string(head(whole));
  if (symbol.kind == SymbolKind::input || symbol.kind == SymbolKind::state) {
    std::string const word = symbol.kind == SymbolKind::input ? "input " : "state ";
    std::uint32_t const end = symbol.unit ? symbol.unit->span.end : symbol.declaration->end;
    std::string text(reading.source.text({symbol.declaration->begin, end}));
    if (symbol.unit) text += ']';
    return word + text;
  }
  return std::string(whole);
}

/// The definition made a derived quantity, so that a check of the model tells its unit.
std::optional<std::string> found_unit(Reading const& reading, Symbol const& symbol) {
  Diagnostics unsaid;
  Elaborated const flat = elaborate(reading.tree, reading.modules, unsaid);
  std::vector<ast::FunctionDefinition const*> functions;
  for (ast::Item const& item : flat.tree.items)
    if (auto const* function = std::get_if<ast::FunctionDefinition>(&item)) functions.push_back(function);
  for (ast::Item const& item : flat.tree.items) {
    auto const* model = std::get_if<ast::Model>(&item);
    if (model == nullptr) continue;
    ast::Model derived = *model;
    bool here = false;
    for (ast::ModelStatement& statement : derived.statements)
      if (auto* definition = std::get_if<ast::Definition>(&statement);
          definition != nullptr && definition->name.name.span == *symbol.declaration) {
        definition->kind = ast::DefinitionKind::derived;
        here = true;
      }
    if (!here) continue;
    auto const checked = check_model(derived, functions, unsaid);
    if (!checked) return std::nullopt;
    for (Derived const& each : checked->derived)
      if (without_index(each.name) == symbol.name && each.unit) return each.unit_of_numbers();
    return std::nullopt;
  }
  return std::nullopt;
}

std::string unit_line(Reading const& reading, Symbol const& symbol, int primes) {
  bool const definition =
      symbol.kind == SymbolKind::local || symbol.kind == SymbolKind::derived || symbol.kind == SymbolKind::constant;
  if (!symbol.unit) {
    if (!definition) return {};
    auto const found = found_unit(reading, symbol);
    return found ? fmt::format("unit: `[{}]`, from its value\n", found->empty() ? "-" : *found) : std::string();
  }
  Diagnostics unsaid;
  auto const unit = check_unit(symbol.unit, unsaid);
  if (!unit) return {};
  if (primes > 0) {
    auto const rate = rate_unit(unit, primes);
    std::string const text = rate->text_or_dimension();
    return fmt::format("`{}`: `[{}]`\n", primed_name(symbol.name, primes), text.empty() ? "-" : text);
  }
  std::string const si = format_dimension(unit->dimension);
  std::string_view const written = reading.source.text(symbol.unit->span);
  return fmt::format("unit: `[{}]`{}\n", written, si.empty() || si == written ? "" : fmt::format(", `[{}]` in SI", si));
}

std::string what_line(Reading const& reading, Symbol const& symbol) {
  std::string text(kind_name(symbol.kind));
  if (symbol.kind == SymbolKind::model_argument) text = "whole number, argument";
  if (symbol.kind == SymbolKind::function_argument) text = "argument";
  if (symbol.owner >= 0) {
    Symbol const& owner = reading.names.symbols[static_cast<std::size_t>(symbol.owner)];
    text += fmt::format(" of {} `{}`", kind_name(owner.kind), owner.name);
  }
  if (symbol.declaration) {
    Place const place = reading.source.place(symbol.declaration->begin);
    if (place.file > 0) text += fmt::format(", in `{}`", reading.source.name(place.file));
  }
  return text + "\n";
}

std::string module_text(std::string const& name) {
  for (LibraryModule const& module : library_modules())
    if (module.name == name) return fmt::format("module `{}` of the standard library: {}\n", name, module_summary(module));
  return fmt::format("module `{}`\n", name);
}

}  // namespace

std::optional<Hover> hover(Reading const& reading, std::uint32_t offset) {
  Occurrence const* found = reading.names.at(offset);
  if (found == nullptr) return std::nullopt;
  Symbol const& symbol = reading.names.symbols[static_cast<std::size_t>(found->symbol)];
  Hover result{found->span, {}};
  if (symbol.kind == SymbolKind::word) {
    result.markdown = fenced(symbol.signature.empty() ? symbol.name : symbol.signature) + symbol.summary + "\n";
  } else if (symbol.kind == SymbolKind::module) {
    result.markdown = module_text(symbol.name);
  } else if (symbol.kind == SymbolKind::column || symbol.kind == SymbolKind::file) {
    result.markdown = fmt::format("{}`{}`\n", symbol.kind == SymbolKind::column ? "column " : "file ", symbol.name);
    if (symbol.unit) result.markdown += fmt::format("unit: `[{}]`\n", reading.source.text(symbol.unit->span));
  } else {
    result.markdown = fenced(declaration_text(reading, symbol)) + what_line(reading, symbol);
    if (std::string const unit = unit_line(reading, symbol, found->primes); !unit.empty()) result.markdown += "\n" + unit;
  }
  return result;
}

}  // namespace sysid::assist
