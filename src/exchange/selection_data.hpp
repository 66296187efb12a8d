// A selection as InferenceData: each living candidate has parameters of its own, and so a file of its own.
#pragma once
#include "exchange/inference_data.hpp"

namespace sysid {

struct CandidateData {
  std::string name;       // of the model: "bouc_wen(n = 2)"
  std::string file_name;  // what it is called in names of files
  std::size_t place = 0;  // among the candidates of the set, once its model is known
  InferenceData data;
};

/// A model that has draws.
struct LivingCandidate {
  std::string name, file_name;  // as of CandidateData
};
std::vector<LivingCandidate> living_candidates(StoredResult const& stored);

/// Per living candidate: posterior, its particles resampled to equal weights; weighted_posterior and weighted_sample_stats, the
/// particles themselves with weight, distance and population; polished_posterior, where chains on its likelihood were run.
std::vector<CandidateData> stored_candidates(StoredResult const& stored);

/// observed_data and constant_data of each, and its place in the set. The session's results are those that the candidates were read
/// from: UserError where its model or data do not belong to them.
void add_candidate_data(Session& session, int select, std::vector<CandidateData>& candidates);

}  // namespace sysid
