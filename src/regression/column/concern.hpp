// Problems between the data and an equation, as values: kind, terms, number. The caller adds the user's words.
#pragma once
#include <string>
#include <vector>

#include "data/input_rule.hpp"

namespace sysid::regression {

struct Concern {
  enum class Kind {
    // no equation can be had; the discovery of it ends here. Up to nothing_left: `fatal` goes by this order
    not_measured,        // terms or the known side need a state that no channel measures (or `measured` lacks a derivative)
    unequal_steps,       // the record's time steps differ by more than 1e-6
    too_few_rows,        // fewer windows or samples are left than a choice among so many terms needs; value: how many there are
    at_rest,             // a channel does not move; value: its constant
    nothing_to_explain,  // the known side is zero on the whole record
    nothing_left,        // every term was left out
    // a term is left out of the choice; the rest goes on
    always_zero,  // terms: one that is zero on the whole record
    not_finite,   // terms: one that is infinite or not a number somewhere; value: rows where
    repeats,      // terms: the one kept, then those that say the same up to a factor
    collinear,    // terms: the one left out, then those whose sum it is; value: condition number of the scaled columns
    // the result stands, but look
    nearly_collinear,  // terms of a group that the data barely tell apart; value: condition index (Belsley et al. 1980)
    interchangeable,   // terms of which one is needed, but not which; value: probability that at least one is in
    unexplained,       // value: residual sd over that expected of the measurement noise: an input or a term is missing
    correlated,        // value: how many rows are worth one independent one
    not_white,         // of a difference equation; value: chi-squared over some lags
    short_runs,        // the same: missing samples leave few rows that follow one another; value: how many in the mean
    input_left,        // the same: its errors depend on `input`; value: the correlation
    outside_better,    // the same: a term that the dictionary lacks describes the record far better; value: by how many nats
    explains_nothing,  // no term is chosen
    other_rule,        // input, rule: the residual is far smaller with it; value: by which factor the squares
    smoothed,          // terms that needed a smoothed derivative inside the weak form
    missing,           // value: share of windows lost to missing samples
    no_convergence,    // value: iterations
  };

  Kind kind = Kind::unexplained;
  std::vector<int> terms = {};  // of the equation
  int channel = -1;             // where one is meant
  int input = -1;               // the same
  InputRule rule = InputRule::zero_order;
  double value = 0;
  std::string clause = {};  // one plain sentence, lower case, no full stop, naming terms and numbers
};

using Concerns = std::vector<Concern>;

/// Whether the discovery cannot go on with it.
bool fatal(Concern::Kind kind);
bool any_fatal(Concerns const& concerns);

}  // namespace sysid::regression
