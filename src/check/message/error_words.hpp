// Phrases that the checker's messages share; the messages themselves are in errors_*.cpp.
#pragma once
#include <span>
#include <string>
#include <string_view>

#include "check/message/errors.hpp"
#include "core/text/words.hpp"

namespace sysid::errors {

Diagnostic error(std::string code, Span span, std::string message, std::string help = {}, std::string label = {});
Diagnostic as_warning(Diagnostic diagnostic);
Diagnostic conflict(std::string code, Span span, std::string label, Span other, std::string other_label, std::string message,
                    std::string help = {});

/// With the names that it concerns, and what the first was looked up as.
Diagnostic about(Names names, Diagnostic diagnostic, std::string kind = {});
/// What else it concerns, behind what it has.
Diagnostic also_about(Names const& names, Diagnostic diagnostic);
/// `y'` and `y`; one name where there are no primes.
Names with_bare(std::string const& component);

/// "did you mean ...", else the given fallback.
std::string guess_or(std::string const& text, Names const& known, std::string fallback);
/// "there are `a` and `b`".
std::string choose(Names const& known, std::string const& what);
/// Help where something positive reads these parameters and never is.
std::string positive_prior(Names const& names);
/// "in [N/m]", "a pure number".
std::string measure(Unit const& unit);
std::string primed(std::string const& name, int primes);
std::string primed(ast::Reference const& reference);

/// A word of another language or of papers, with ours.
struct Synonym {
  std::string_view foreign, ours;
};
/// Our word for a foreign one, if it is among the known, whatever the capitals; else a near name, else the fallback.
std::string guess_or(std::span<Synonym const> table, std::string const& text, Names const& known, std::string fallback);

}  // namespace sysid::errors
