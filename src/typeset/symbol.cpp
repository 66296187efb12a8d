// A table of Greek letters, and one pass over a name from its end.
#include "typeset/symbol.hpp"

#include <algorithm>
#include <array>

#include "core/text/utf8.hpp"

namespace sysid {

namespace {

constexpr std::array<GreekLetter, 34> greek{{
    {"alpha", "α", "\\alpha"},     {"beta", "β", "\\beta"},   {"gamma", "γ", "\\gamma"},     {"delta", "δ", "\\delta"},
    {"epsilon", "ε", "\\epsilon"}, {"zeta", "ζ", "\\zeta"},   {"eta", "η", "\\eta"},         {"theta", "θ", "\\theta"},
    {"iota", "ι", "\\iota"},       {"kappa", "κ", "\\kappa"}, {"lambda", "λ", "\\lambda"},   {"mu", "μ", "\\mu"},
    {"nu", "ν", "\\nu"},           {"xi", "ξ", "\\xi"},       {"pi", "π", "\\pi"},           {"rho", "ρ", "\\rho"},
    {"sigma", "σ", "\\sigma"},     {"tau", "τ", "\\tau"},     {"upsilon", "υ", "\\upsilon"}, {"phi", "φ", "\\phi"},
    {"chi", "χ", "\\chi"},         {"psi", "ψ", "\\psi"},     {"omega", "ω", "\\omega"},     {"Gamma", "Γ", "\\Gamma"},
    {"Delta", "Δ", "\\Delta"},     {"Theta", "Θ", "\\Theta"}, {"Lambda", "Λ", "\\Lambda"},   {"Xi", "Ξ", "\\Xi"},
    {"Pi", "Π", "\\Pi"},           {"Sigma", "Σ", "\\Sigma"}, {"Upsilon", "Υ", "\\Upsilon"}, {"Phi", "Φ", "\\Phi"},
    {"Psi", "Ψ", "\\Psi"},         {"Omega", "Ω", "\\Omega"},
}};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Of a name without a dot and without an underscore.
TypesetSymbol without_underscore(std::string_view name) {
  std::size_t end = name.size();
  while (end > 0 && is_digit(name[end - 1])) --end;
  std::string_view const word = name.substr(0, end);
  bool const one_letter = text_width(word) == 1 || greek_letter(word) != nullptr;
  if (end == name.size() || !one_letter) return {std::string(name), {}};
  return {std::string(word), {std::string(name.substr(end))}};
}

}  // namespace

GreekLetter const* greek_letter(std::string_view text) {
  auto const* const row =
      std::find_if(greek.begin(), greek.end(), [&](GreekLetter const& each) { return each.name == text || each.letter == text; });
  return row == greek.end() ? nullptr : &*row;
}

TypesetSymbol symbol(std::string_view name) {
  if (std::size_t const dot = name.rfind('.'); dot != std::string_view::npos) {
    TypesetSymbol out = symbol(name.substr(dot + 1));
    for (std::string_view path = name.substr(0, dot); !path.empty();) {
      std::size_t const next = path.rfind('.');
      std::size_t const begin = next == std::string_view::npos ? 0 : next + 1;
      out.indices.emplace_back(path.substr(begin));
      path = next == std::string_view::npos ? std::string_view() : path.substr(0, next);
    }
    return out;
  }
  std::size_t const underscore = name.find('_');
  if (underscore == 0 || underscore == std::string_view::npos || underscore + 1 == name.size()) return without_underscore(name);
  TypesetSymbol out = without_underscore(name.substr(0, underscore));
  std::string index(name.substr(underscore + 1));
  std::replace(index.begin(), index.end(), '_', ' ');
  out.indices.push_back(std::move(index));
  return out;
}

TypesetSymbol Symbols::operator()(std::string const& name) {
  TypesetSymbol const printed = symbol(name);
  auto const [known, first] = names_.emplace(printed, name);
  if (!first && known->second != name) alike_.insert({known->second, name});
  return alike_.contains(name) ? TypesetSymbol{name, {}} : printed;
}

}  // namespace sysid
