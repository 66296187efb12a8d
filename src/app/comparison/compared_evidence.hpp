// Evidences side by side: odds, how strong they are, and what of them is owed to the widths of the priors.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "result/comparison.hpp"

namespace sysid {

/// Into the fits: log Bayes factors B against the model of the highest evidence and probabilities P under equal prior odds, both
/// with the standard errors s of the evidences Z carried through.
///
///   log B_i = log Z_i - log Z_best,   P_i = Z_i / sum_j Z_j                                    Kass and Raftery 1995
///   sd P_i = P_i sqrt((1 - P_i)^2 s_i^2 + sum over j != i of P_j^2 s_j^2)
///
/// models: for each fit what model it is of; of several fits of a model the one whose evidence is known best stands for all: one
/// that is confirmed, with the smallest error. Nothing where a single model among several has an evidence.
void weigh_models(std::vector<std::string> const& models, std::vector<ComparedFit>& fits);

/// Fits of one model whose evidences differ by more than their errors.
std::vector<std::string> disagreements(std::vector<std::string> const& models, std::vector<ComparedFit> const& fits);

/// The words of Kass and Raftery (1995, section 3.2) for a natural logarithm of a Bayes factor, its sign aside.
std::string evidence_strength(double log_bayes_factor);

/// For every model that the best one does not rule out: between which values its log Bayes factor lies if the prior of one
/// parameter, or all of them, are half or twice as wide. A parameter of both models is widened in both. evidences: the `evidence`
/// of each fit's summary.
std::vector<std::string> prior_width_notes(std::vector<std::string> const& models, std::vector<ComparedFit> const& fits,
                                           std::vector<nlohmann::json> const& evidences);

}  // namespace sysid
