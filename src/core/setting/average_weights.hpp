// What the fits of an averaged prediction are weighed by: what `weights = ...` may say.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

enum class AverageWeights { evidence, stacking, pseudo_bma, equal };

/// As the language has it: "evidence", "stacking", "pseudo_bma", "equal".
std::string_view word(AverageWeights weights);
std::optional<AverageWeights> average_weights(std::string_view word);
/// All of them.
std::vector<std::string> average_weights_words();
/// For people: "evidence", "stacking", "pseudo-BMA+", "equal weights".
std::string_view title(AverageWeights weights);

}  // namespace sysid
