// What the model of a fit adds to its stored draws: likelihoods and predictive samples, simulated once more.
#pragma once
#include "app/session/session.hpp"
#include "exchange/inference_data.hpp"

namespace sysid {

/// observed_data, constant_data, log_likelihood, posterior_predictive, prior and prior_predictive. Nothing is fitted; up to `draws`
/// of the stored draws, as many of each chain, are simulated once more, and as many of the prior. Of a model with processes over
/// its rows: posterior_predictive alone beside the data. The session's results are those of `stored`. UserError, IoError where
/// model or data do not belong to them.
void add_simulated(Session& session, int fit, StoredResult const& stored, int draws, InferenceData& data);

}  // namespace sysid
