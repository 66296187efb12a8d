// The evidence by bridge sampling: from draws of a mixture and draws of the posterior together.
#pragma once
#include "inference/evidence/sample.hpp"

namespace sysid::marginal {

struct BridgeEstimate {
  double log_evidence = 0;
  double error = 0;                // one standard error, nats
  double posterior_effective = 0;  // number of independent draws that those of the posterior are worth here
  double unseen = 0;  // share of the posterior's draws whose weight p / q is larger than that of every draw of the mixture
};

/// The fixed point of
///
///   Z = mean over q of p / (s p + t q Z)  /  mean over the posterior of q / (s p + t q Z)           Meng and Wong 1996, eq. 4.1
///
/// with the optimal s and t = 1 - s, the shares of both kinds of draws in their effective number. The draws of the posterior
/// must not be those that q was fitted to. The error counts autocorrelation and chains that disagree (Fruehwirth-Schnatter 2004,
/// sec. 3.4). log_evidence is not finite where there is nothing to bridge.
BridgeEstimate bridge(MixtureSample const& sample, PosteriorSample const& posterior);

}  // namespace sysid::marginal
