// What a model declares: a name, its unit and its place.
#pragma once
#include <optional>
#include <string>
#include <vector>

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
  /// As the user wrote it: empty for a derived unit, too.
  std::string unit_text() const { return unit ? unit->text : std::string(); }
  /// Of its numbers; empty without a unit.
  std::string unit_of_numbers() const { return unit ? unit->text_or_dimension() : std::string(); }
};

/// From declared numbers of one quantity to those of another of the same dimension, zero points applied: 20 [degC] are 293.15 [K].
/// A quantity without a unit counts in coherent SI units.
class BetweenQuantities {
 public:
  BetweenQuantities(Quantity const& from, Quantity const& to)
      : from_(from.unit ? from.unit->scale : 1),
        to_(to.unit ? to.unit->scale : 1),
        shift_((from.unit ? from.unit->offset : 0) - (to.unit ? to.unit->offset : 0)) {}

  bool changes() const { return from_ != to_ || shift_ != 0; }
  /// Of a difference of two.
  double slope() const { return from_ / to_; }
  double operator()(double declared) const { return changes() ? (declared * from_ + shift_) / to_ : declared; }
  void apply(std::vector<std::vector<double>>& trajectories) const {
    if (!changes()) return;
    for (std::vector<double>& trajectory : trajectories)
      for (double& value : trajectory) value = (*this)(value);
  }

 private:
  double from_, to_, shift_;
};

}  // namespace sysid
