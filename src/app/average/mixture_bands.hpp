// Members of an average to one band: weighed draws, where their variance comes from, and scores of all on the same samples.
#pragma once
#include <string>
#include <vector>

#include "app/average/member_along.hpp"
#include "result/average.hpp"
#include "result/prediction.hpp"

namespace sysid {

/// The quantities that all members have, by the names of those of `lead`; channels with noise. Members without a trajectory that
/// stays finite are left out, the weights of the others scaled up.
std::vector<PredictedQuantity> averaged_quantities(std::vector<MemberAlong> const& members, std::vector<double> const& weights,
                                                   std::size_t lead);

/// Of each measured channel the scores of the average and of each member, over the samples that all score. quantities: the average
/// with what was measured.
std::vector<AveragedChannel> averaged_scores(std::vector<MemberAlong> const& members, std::vector<double> const& weights,
                                             Prediction const& average);

/// Of each quantity of an average the shares of its variance.
std::vector<VarianceShares> variance_shares(Prediction const& average);

}  // namespace sysid
