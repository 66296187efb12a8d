// Errors told apart by code and place, and one in the place of several.
#include "check/model/mistakes.hpp"

#include <optional>
#include <utility>
#include <vector>

#include "check/units/unit_errors.hpp"

namespace sysid {

Mistake mistake_of(Diagnostic const& each) {
  return {each.code, each.primary ? each.primary->span.begin : 0, each.primary ? each.primary->span.end : 0};
}

std::set<Mistake> mistakes_from(std::size_t first, Diagnostics const& diagnostics) {
  std::set<Mistake> places;
  for (std::size_t i = first; i < diagnostics.all().size(); ++i) {
    Diagnostic const& each = diagnostics.all()[i];
    bool const of_units = each.code.starts_with("E2") || errors::is_unit_conflict(each);
    if (each.severity == Severity::error && of_units) places.insert(mistake_of(each));
  }
  return places;
}

void replace_resolved(Diagnostics& diagnostics, std::size_t first, std::set<Mistake> const& resolved,
                      std::function<Diagnostic(Diagnostic earliest)> const& in_their_place) {
  std::vector<Diagnostic> kept;
  std::optional<Diagnostic> earliest;
  for (std::size_t i = 0; i < diagnostics.all().size(); ++i) {
    Diagnostic const& each = diagnostics.all()[i];
    if (i < first || !resolved.contains(mistake_of(each)))
      kept.push_back(each);
    else if (!earliest || each.primary->span.begin < earliest->primary->span.begin)
      earliest = each;
  }
  if (!earliest) return;
  kept.push_back(in_their_place(*std::move(earliest)));
  diagnostics.replace(std::move(kept));
}

}  // namespace sysid
