// What a model declares: a name, its unit and its place.
#pragma once
#include <optional>
#include <string>

#include "core/numeric/unit.hpp"
#include "core/text/source.hpp"

namespace sysid {

/// A declared thing: the user's name, unit (absent: undeclared) and where it stands.
struct Quantity {
  std::string name;
  std::optional<Unit> unit;
  Span span;

  /// Declared number -> SI and back; offsets never enter equations.
  double to_si(double declared) const { return unit ? declared * unit->scale : declared; }
  double from_si(double si) const { return unit ? si / unit->scale : si; }
  std::string unit_text() const { return unit ? unit->text : std::string(); }
};

}  // namespace sysid
