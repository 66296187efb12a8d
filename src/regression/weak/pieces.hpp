// Taking a term apart for the weak form: which derivatives move onto the test function, and what must be integrated as it stands.
#pragma once
#include <optional>
#include <vector>

#include "regression/column/dictionary.hpp"

namespace sysid::regression {

/// A summand of a term. With phi the test function and z = y^(base) measured:
///
///   inputs      integral phi f(inputs, time)           by Gauss quadrature on the inputs' own polynomials
///   samples     integral phi f                         by the trapezoidal rule on samples
///   moved       integral phi y^(base + moves)          = (-1)^moves integral phi^(moves) z
///   potential   integral phi g(z) z'                   = -integral phi' G(z), G' = g
struct Piece {
  enum class Kind { inputs, samples, moved, potential };

  Kind kind = Kind::samples;
  double factor = 1;
  NodeId expression = 0;  // f or g
  int channel = -1;       // of z
  int moves = 0;
  bool smoothed = false;  // f reads derivatives that no channel measures: from a local polynomial
};

/// The summands of an expression; derivatives are moved wherever a summand is affine in those that no channel measures. Nothing
/// when it reads a state of which no derivative at or below the one read is measured. The graph gains nodes.
std::optional<std::vector<Piece>> weak_pieces(Dictionary& dictionary, NodeId expression);

}  // namespace sysid::regression
