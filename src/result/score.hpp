// The scores of a model on a channel: one enumerator and one row each. Adding a score is an enumerator, a row, a title in
// report/page/html_scores.cpp and what its values say in report/page/html_words.cpp.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

enum class ScoreKind {
  log_score,          // mean log predictive density of a sample
  nmse,               // normalised mean squared error
  nmse_left_out,      // the same of samples predicted from all others
  rmse,               // root mean square error
  coverage_95,        // share of the samples inside the 95 % band
  coverage_3sd,       // share of the samples within 3 sd of the predictive mean
  chi_squared,        // mean square of the standardised residuals
  whiteness,          // p-value: residuals uncorrelated in time
  input_correlation,  // p-value: residuals uncorrelated with past values of an input
};

enum class ScoreUnit { none, percent, of_channel };

struct ScoreRow {
  ScoreKind kind;
  std::string_view word;  // as summaries hold it
  ScoreUnit unit = ScoreUnit::none;
  bool p_value = false;
};

ScoreRow const& row_of(ScoreKind kind);

struct ScoreName {
  ScoreKind kind;
  std::string input = {};  // of input_correlation, where the model has several

  bool operator==(ScoreName const&) const = default;
};

/// "nmse", "input_correlation_p(force)".
std::string text_of(ScoreName const& name);

/// What text_of has written; nothing for a name that no score has.
std::optional<ScoreName> score_name(std::string_view text);

struct Score {
  ScoreName name;
  double value;
};

/// Nothing where it is not among them.
std::optional<double> find_score(std::vector<Score> const& scores, ScoreName const& name);

}  // namespace sysid
