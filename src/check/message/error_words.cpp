// Lists in words, guesses, and the two shapes of a message.
#include "check/message/error_words.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/text/words.hpp"

namespace sysid::errors {

Diagnostic error(std::string code, Span span, std::string message, std::string help, std::string label) {
  return {Severity::error, std::move(code), std::move(message), Label{span, std::move(label)}, {}, std::move(help)};
}

Diagnostic as_warning(Diagnostic diagnostic) {
  diagnostic.severity = Severity::warning;
  return diagnostic;
}

Diagnostic conflict(std::string code, Span span, std::string label, Span other, std::string other_label, std::string message,
                    std::string help) {
  Diagnostic result = error(std::move(code), span, std::move(message), std::move(help), std::move(label));
  result.secondary.push_back({other, std::move(other_label)});
  return result;
}

Diagnostic about(Names names, Diagnostic diagnostic, std::string kind) {
  diagnostic.names = std::move(names);
  diagnostic.kind = std::move(kind);
  return diagnostic;
}

Diagnostic also_about(Names const& names, Diagnostic diagnostic) {
  for (std::string const& each : names)
    if (std::find(diagnostic.names.begin(), diagnostic.names.end(), each) == diagnostic.names.end())
      diagnostic.names.push_back(each);
  return diagnostic;
}

Names with_bare(std::string const& component) {
  Names names{component};
  if (std::size_t const end = component.find('\''); end != std::string::npos && end > 0) names.push_back(component.substr(0, end));
  return names;
}

Subject named(std::string const& name) { return {"`" + name + "`", with_bare(name)}; }
Subject named(std::string_view before, std::string const& name) { return {fmt::format("{} `{}`", before, name), with_bare(name)}; }

std::string guess_or(std::string const& text, Names const& known, std::string fallback) {
  std::string guess = did_you_mean(text, known);
  return guess.empty() ? std::move(fallback) : guess;
}

std::string choose(Names const& known, std::string const& what) {
  if (known.empty()) return fmt::format("there is no {} here", what);
  return fmt::format("available: {}", quoted(known));
}

std::string positive_prior(Names const& names) {
  if (names.empty()) return "write a positive value";
  return fmt::format(
      "check the {} of {} and what is computed from {}: `half_normal(sd = 1)` and `log_uniform(0.1, 10)` have only positive "
      "values",
      plural("prior", names.size()), quoted(names), names.size() == 1 ? "it" : "them");
}

std::string measure(Unit const& unit) {
  bool const angle = unit.radian.numerator != 0 && !unit.text.empty();
  if (unit.dimensionless() && !angle) return "a pure number";
  return fmt::format("in [{}]", unit.text_or_dimension());
}

std::string primed(std::string const& name, int primes) { return name + std::string(static_cast<std::size_t>(primes), '\''); }
std::string primed(ast::Reference const& reference) { return primed(reference.name.text, reference.primes); }

namespace {

// Our word for a foreign one, if it is among the known; whatever the capitals.
std::string synonym(std::span<Synonym const> table, std::string_view written, Names const& known) {
  std::string const text = in_small_letters(written);
  for (Synonym const& each : table)
    if (each.foreign == text && std::find(known.begin(), known.end(), each.ours) != known.end())
      return fmt::format("did you mean `{}`?", each.ours);
  return {};
}

}  // namespace

std::string guess_or(std::span<Synonym const> table, std::string const& text, Names const& known, std::string fallback) {
  std::string guess = synonym(table, text, known);
  return guess.empty() ? guess_or(text, known, std::move(fallback)) : guess;
}

}  // namespace sysid::errors
