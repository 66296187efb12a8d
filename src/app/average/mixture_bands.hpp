// Members of an average to one band: weighed draws, where their variance comes from, and scores of all on the same samples.
#pragma once
#include <string>
#include <vector>

#include "app/average/member_along.hpp"
#include "result/average.hpp"
#include "result/prediction.hpp"

namespace sysid {

/// Where members of no more weight than this have no value, the average is of the others.
inline constexpr double negligible_weight = 0.01;

/// A quantity of one member alone.
struct MemberBand {
  PredictedQuantity band;  // of a channel: the mean of the response, and the band with noise
  int undefined = 0;       // rows without a value, though another member or a measured sample has one there
};

struct AveragedBand {
  PredictedQuantity average;
  std::vector<MemberBand> members;
};

/// The quantities that all members have, by the names of those of `lead`; channels with noise. Members without a trajectory that
/// stays finite are left out, the weights of the others scaled up. Rows that members cannot predict whose weight is more than
/// negligible have no average. Interrupted on request.
std::vector<AveragedBand> averaged_bands(std::vector<MemberAlong> const& members, std::vector<double> const& weights,
                                         std::size_t lead);

struct ScoredChannel {
  AveragedChannel scores;
  std::vector<std::uint8_t> rows;  // [N] 1: of these samples
};

/// Of each measured channel the scores of the average and of each member, over the samples that all members with a weight score.
/// bands: with what was measured; those of members get it.
std::vector<ScoredChannel> averaged_scores(std::vector<MemberAlong> const& members, std::vector<double> const& weights,
                                           std::string const& experiment, std::vector<AveragedBand>& bands);

/// Of each quantity of an average the shares of its variance; NaN where the noise has none.
std::vector<VarianceShares> variance_shares(Prediction const& average);

}  // namespace sysid
