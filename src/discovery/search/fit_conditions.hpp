// What a search learns about the record and the integrator from its leading structure: how fine steps have to be, what bounds the
// noise from below, and how it differs from sample to sample.
#pragma once
#include <algorithm>
#include <utility>
#include <vector>

#include "discovery/search/whole_dictionary.hpp"

namespace sysid {

/// Inputs that were written with so many digits.
struct RoundedInputs {
  std::vector<Experiment> otherwise;              // the records with other roundings; empty: inputs carry all digits
  std::vector<std::vector<Eigen::VectorXd>> sds;  // [experiments][rows], [inputs]
};

class RecordLimits {
 public:
  explicit RecordLimits(WholeDictionary const& dictionary);

  /// Smaller steps until the integrator is off by less than a fiftieth of the noise, and what bounds the noise from below: digits
  /// of samples and inputs, and the integrator. Whether fits before are of other steps.
  bool settle_step(FittedTerms const& lead, FitConditions& conditions);

  /// Noise near that bound has the shape of the digits, other noise is alike in all samples or grows with the signal. Whether a
  /// channel's is found to have another shape than before. Where all channels are near that bound, and inputs are rounded, errors
  /// of the inputs are carried along the motion.
  bool settle_noise(FittedTerms const& lead, FitConditions& conditions);

  /// Of a channel of the model, SI: ValidatedChannel::growth.
  double growth(std::size_t channel) const { return std::max(learnt_.shape[channel], 0.0); }

  /// What the leading structures have told so far, per channel. A search that goes back to an earlier structure takes it back too.
  struct Learnt {
    std::vector<double> other_errors;  // root mean squares
    std::vector<double> own_errors;    // of these, what is not of inputs
    std::vector<double> shape;         // where noise begins to grow; 0: alike; -1: that of the digits
  };
  Learnt const& learnt() const { return learnt_; }
  void take_back(Learnt before) { learnt_ = std::move(before); }

 private:
  using Relative = std::vector<std::vector<std::vector<double>>>;  // as NoiseShape has it
  bool settle_carried(FittedTerms const& lead, FitConditions& conditions);
  double shape_of_rounding(std::size_t channel, Relative& relative) const;
  double shape_of_growth(std::size_t channel, std::vector<SegmentSlopes> const& runs, std::vector<Segment> const& parts,
                         Relative& relative) const;

  WholeDictionary const& dictionary_;
  Relative rounding_of_samples_;
  std::vector<double> rounding_;  // per channel, root mean square
  Learnt learnt_;
  RoundedInputs rounded_;
};

}  // namespace sysid
