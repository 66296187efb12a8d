// The simulated motion to first order in all coefficients of a dictionary: a regression whose errors are those of the samples.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "likelihood/segments/arrowhead.hpp"
#include "likelihood/segments/segments.hpp"

namespace sysid {

/// Columns of the dictionary in a fixed order, over all equations.
using Terms = std::vector<int>;  // rising

/// A set of terms with what it is worth by the linearised motion.
struct WeighedTerms {
  Terms terms;
  double score = 0;              // log evidence and prior, up to a constant of the linearisation
  double log_likelihood = 0;     // up to the same constant for all sets of terms
  double squares = 0;            // S
  Eigen::VectorXd coefficients;  // of the terms
};

/// About a point c0 of the coefficients (0 where a term is out), with the best starts of the segments eliminated,
///
///   log L(c) = - N/2 log s^2 - S(c) / (2 s^2),   S(c) = |J (c - c0) + r|^2,   s^2 = S/N, at least `floor`
///
/// with J and r in units of the noise that the point leaves. Terms that are swapped for others that move the record alike are far
/// from c0, but their sum is not: to first order the motion is the same, so S is right where it is small.
class LinearisedMotion {
 public:
  struct Settings {
    double samples = 0;            // N
    double floor = 0;              // of s^2
    double signal = 1;             // of `log_coefficient_weight`
    std::vector<double> log_odds;  // per column: that it is in, before the record
    std::vector<char> always;      // per column: in every set of terms
  };

  /// slopes: by all coefficients, rows in units of their noise.
  LinearisedMotion(std::vector<SegmentSlopes> const& slopes, Eigen::VectorXd const& at, Settings settings);

  int columns() const { return static_cast<int>(columns_.cols()); }
  bool always(int column) const { return settings_.always[static_cast<std::size_t>(column)] != 0; }
  /// Whether a perturbation of it shows, and stays finite.
  bool usable(int column) const { return usable_[static_cast<std::size_t>(column)] != 0; }

  /// [states x segments]: how far the best starts are from where they were, with these coefficients.
  Eigen::MatrixXd start_moves(WeighedTerms const& terms) const;

  /// Log evidence and prior. terms: usable. -infinity where they are not determined.
  WeighedTerms weigh(Terms terms) const;
  /// S of the least squares on some terms, and of these with up to two of them out and up to two others in: what the search
  /// compares before it weighs.
  struct Move {
    double squares = 0;
    std::vector<int> out, in;
  };
  /// The `most` best moves of each kind: up to two out, up to two in.
  std::vector<Move> moves(Terms const& terms, int most) const;

 private:
  double log_prior(Terms const& terms) const;

  Settings settings_;
  Eigen::VectorXd at_;
  std::vector<EliminatedSegment> segments_;
  Eigen::MatrixXd columns_;  // of unit length
  Eigen::VectorXd known_, length_;
  Eigen::MatrixXd products_;  // of columns
  std::vector<char> usable_;
};

/// `others` with up to `most` terms more, whichever leave least, one or two at a time from the best few: what moves from a set with
/// many wrong terms do not reach. `others` itself is first.
std::vector<Terms> built_up(LinearisedMotion const& motion, Terms const& others, std::size_t most);

/// The best sets of terms near some, best first: from the best one that is known the best moves are weighed, again and again, until
/// several in a row bring nothing better.
std::vector<WeighedTerms> best_terms(LinearisedMotion const& motion, std::vector<Terms> const& from);

}  // namespace sysid
