// The words of the weights, in the order of the enumeration.
#include "core/setting/average_weights.hpp"

#include <array>
#include <cstddef>

namespace sysid {
namespace {

struct WeightsRow {
  std::string_view word, title;
};

constexpr std::array<WeightsRow, 4> weights_rows = {
    {{"evidence", "evidence"}, {"stacking", "stacking"}, {"pseudo_bma", "pseudo-BMA+"}, {"equal", "equal weights"}}};

}  // namespace

std::string_view word(AverageWeights weights) { return weights_rows.at(static_cast<std::size_t>(weights)).word; }

std::string_view title(AverageWeights weights) { return weights_rows.at(static_cast<std::size_t>(weights)).title; }

std::optional<AverageWeights> average_weights(std::string_view word) {
  for (std::size_t k = 0; k < weights_rows.size(); ++k)
    if (weights_rows[k].word == word) return static_cast<AverageWeights>(k);
  return std::nullopt;
}

std::vector<std::string> average_weights_words() {
  std::vector<std::string> words;
  for (WeightsRow const& row : weights_rows) words.emplace_back(row.word);
  return words;
}

}  // namespace sysid
