// Numbers of a quantity as its column has them in the file: what messages about a record quote.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "experiment/experiments.hpp"

namespace sysid {

/// A column of the record that a model's input or channel reads. Refers to the quantity.
class ColumnInFile {
 public:
  ColumnInFile(ExperimentData const& data, ColumnUse const& column, Quantity const& quantity);

  /// si: in SI units, as an experiment holds it.
  double value(double si) const;
  std::vector<double> values(std::vector<double> si) const;
  /// Empty where the numbers have none.
  std::string unit_text() const;
  /// `1.2 mm`.
  std::string text(double si) const;

 private:
  Quantity const& quantity_;
  std::optional<Unit> unit_;  // of the column
};

}  // namespace sysid
