// Names of scores, as summaries hold them.
#include "result/score.hpp"

#include <doctest/doctest.h>

namespace sysid {

TEST_CASE("the name of a score is read back as it was written") {
  for (int kind = 0; kind <= static_cast<int>(ScoreKind::input_correlation); ++kind) {
    ScoreName const name{static_cast<ScoreKind>(kind)};
    CHECK(row_of(name.kind).kind == name.kind);
    CHECK(score_name(text_of(name)) == name);
  }
  ScoreName const crossed{ScoreKind::input_correlation, "force"};
  CHECK(text_of(crossed) == "input_correlation_p(force)");
  CHECK(score_name("input_correlation_p(force)") == crossed);
}

TEST_CASE("a name that no score has is none") {
  for (char const* text : {"", "nmse ", "NMSE", "nmse(force)", "input_correlation_p(force", "(force)"})
    CHECK_FALSE(score_name(text));
}

TEST_CASE("a score is found by its name, input included") {
  std::vector<Score> const scores = {{{ScoreKind::rmse}, 2}, {{ScoreKind::input_correlation, "force"}, 0.25}};
  CHECK(find_score(scores, {ScoreKind::rmse}) == 2);
  CHECK(find_score(scores, {ScoreKind::input_correlation, "force"}) == 0.25);
  CHECK_FALSE(find_score(scores, {ScoreKind::input_correlation}));
  CHECK_FALSE(find_score(scores, {ScoreKind::nmse}));
}

}  // namespace sysid
