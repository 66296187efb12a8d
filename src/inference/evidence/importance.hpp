// The evidence as the mean weight of draws of a mixture.
#pragma once
#include "inference/evidence/sample.hpp"

namespace sysid::marginal {

struct ImportanceEstimate {
  double log_evidence = 0;
  double error = 0;        // one standard error, nats
  double effective = 0;    // number of equally weighted draws that they are worth
  double plain_error = 0;  // of the mean weight alone
};

/// log of the mean of w = p / q over draws of q, with what is known of q's parts as control variates:
///
///   Z = mean w - b' mean h,   h_j = q_j / q - 1, whose mean is 0            Owen and Zhou 2000; Owen 2013, ch. 9
///
/// exact where the posterior is one of the parts, or a mixture of them. b, the error and the effective number are means over q that
/// are taken from the draws of both kinds, N of q and M of the posterior, each with the weight q / (N q + M p / Z) (the balance
/// heuristic, Veach and Guibas 1995): a few hundred draws of q alone do not see the large weights that decide them. guess: log Z
/// for this. Where the draws of q alone say that the error is larger, it is: those of the posterior may miss a mode. log_evidence
/// is -infinity where no draw has a density.
ImportanceEstimate importance(Mixture const& mixture, MixtureSample const& sample, PosteriorSample const& posterior, double guess);

}  // namespace sysid::marginal
