// The table of scores.
#include "result/score.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace sysid {

namespace {

constexpr ScoreRow score_rows[] = {
    {ScoreKind::log_score, "log_score"},
    {ScoreKind::nmse, "nmse", ScoreUnit::percent},
    {ScoreKind::nmse_left_out, "nmse_left_out", ScoreUnit::percent},
    {ScoreKind::rmse, "rmse", ScoreUnit::of_channel},
    {ScoreKind::coverage_95, "coverage_95"},
    {ScoreKind::coverage_3sd, "coverage_3sd"},
    {ScoreKind::chi_squared, "chi_squared_per_sample"},
    {ScoreKind::whiteness, "whiteness_p", ScoreUnit::none, true},
    {ScoreKind::input_correlation, "input_correlation_p", ScoreUnit::none, true},
};

constexpr bool scores_in_order() {
  for (std::size_t i = 0; i < std::size(score_rows); ++i)
    if (static_cast<std::size_t>(score_rows[i].kind) != i) return false;
  return score_rows[std::size(score_rows) - 1].kind == ScoreKind::input_correlation;
}
static_assert(scores_in_order(), "a row for every score, in the order of ScoreKind");

}  // namespace

ScoreRow const& row_of(ScoreKind kind) { return score_rows[static_cast<std::size_t>(kind)]; }

std::string text_of(ScoreName const& name) {
  std::string_view const word = row_of(name.kind).word;
  return name.input.empty() ? std::string(word) : fmt::format("{}({})", word, name.input);
}

std::optional<ScoreName> score_name(std::string_view text) {
  std::string_view const word = text.substr(0, text.find('('));
  auto const* const row =
      std::find_if(std::begin(score_rows), std::end(score_rows), [&](ScoreRow const& each) { return each.word == word; });
  if (row == std::end(score_rows)) return {};
  if (word.size() == text.size()) return ScoreName{row->kind};
  if (row->kind != ScoreKind::input_correlation || !text.ends_with(')')) return {};
  return ScoreName{row->kind, std::string(text.substr(word.size() + 1, text.size() - word.size() - 2))};
}

std::optional<double> find_score(std::vector<Score> const& scores, ScoreName const& name) {
  auto const found = std::find_if(scores.begin(), scores.end(), [&](Score const& each) { return each.name == name; });
  return found == scores.end() ? std::nullopt : std::optional(found->value);
}

}  // namespace sysid
