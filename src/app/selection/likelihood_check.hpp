// Model probabilities by the likelihood, to set beside those of a selection without one.
#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "inference/backend/selector.hpp"
#include "likelihood/model_target.hpp"
#include "search/local_searches.hpp"

namespace sysid {

/// The posterior mode of a model's likelihood, climbed to from the nearest of the particles (at most 8 of them, spread over the
/// distances of the nearest half), noise parameters from their prior; from draws of its
/// priors where it never had a particle; nothing when no climb ends at a finite density. Modes that
/// are one are counted once; the first has the largest mass, shares are among those found. A model that cannot come to
/// `least_log_mass` is not climbed to the end.
LocalSearches modes_near(ModelTarget const& target, SelectedModel const& model, double least_log_mass, std::uint64_t seed,
                         Ledger& ledger, std::function<bool()> const& stop = {}, Journal* journal = nullptr);

/// log of the sum of the masses: Laplace's evidence; -infinity without modes.
double log_evidence(std::vector<Mode> const& modes);

/// Where a model's probability by weights and by likelihood differ by more than this, it is said; of a model that died, when the
/// likelihood leaves it more than that.
constexpr double tolerable_difference = 0.2, tolerable_loss = 0.02;
/// A threshold further above the noise floor than this leaves more than the noise does; one that is as far below it leaves only
/// what follows this noise.
constexpr double far_from_floor = 1.15;
/// One finding that names each such model, the largest difference first. by_likelihood: per model; nothing where no climb ended at
/// a finite likelihood. floor: of the distance, where it is known: what to do depends on which side of it the run has ended.
Findings compare_probabilities(SelectionResult const& result, std::vector<std::optional<double>> const& by_likelihood,
                               std::optional<double> floor = std::nullopt);

}  // namespace sysid
