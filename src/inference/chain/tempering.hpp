// Replica exchange as a back end: for posteriors of several modes, or curved and flat ones, where one chain stays in a part.
#pragma once
#include "inference/backend/backend.hpp"

namespace sysid::tempering {

std::span<SettingRow const> settings();
std::string refuse(Settings const& settings);

/// `chains` independent ensembles of `temperatures` replicas each, all lanes of one batch: replica k moves under
/// prior x likelihood^b_k. The one with b = 0 is drawn from the prior anew at every iteration, the others make
/// differential-evolution moves; then neighbours are exchanged, even pairs and odd pairs in turn (Okabe, Kawata, Okamoto and Mikami
/// 2001; Syed et al. 2022), so that states travel from the prior to the posterior. Powers, archives and scales are learnt in
/// burn-in and then frozen. What is kept are the states with b = 1, every `thin`-th after burn-in.
FitResult run(Target const& target, Settings const& settings, RunContext& context);

}  // namespace sysid::tempering
