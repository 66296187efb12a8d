// Errors of all candidate rows are moved and corrected side by side with the filter.
#include "tracking/change_detector.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/normal_quantile.hpp"

namespace sysid {
namespace {

constexpr int spacing = 8, per_octave = 8;
constexpr double clear_lead = 20;  // of z^2: twice the logarithm of a likelihood ratio
constexpr int most_waited = 100;   // rows
/// As many samples as must agree: one or two far ones begin a louder noise as often as a change.
constexpr double least_samples = 4;
constexpr double clearly_larger = 8;  // twice a logarithm of a likelihood ratio: of innovations that are larger than expected

}  // namespace

bool is_kept(std::int64_t row, std::int64_t age, int window) {
  if (age > window) return false;
  std::int64_t apart = spacing;
  while (age > apart * per_octave) apart *= 2;
  return row % apart == 0;
}

int most_candidates(int window) {
  // A row that is kept is looked at before the next is: of ages 0 to 64, then four in each octave.
  int most = per_octave + 1;
  for (int reach = spacing * per_octave; reach < window; reach *= 2) most += per_octave / 2;
  return most;
}

ChangeDetector::ChangeDetector(int states, int parameters, double rate, int window)
    : states_(states),
      parameters_(parameters),
      size_(states + parameters),
      window_(window),
      threshold_(-standard_normal_quantile(rate / (2.0 * std::max(1, most_candidates(window) * parameters)))),
      scales_(static_cast<std::size_t>(parameters), 1.0),
      scratch_(static_cast<std::size_t>(std::max(1, states) * parameters)) {}

void ChangeDetector::move(double const* transition) {
  for (Candidate& each : candidates_) {
    std::fill(scratch_.begin(), scratch_.end(), 0.0);
    for (int i = 0; i < states_; ++i) {
      double* const row = scratch_.data() + i * parameters_;
      for (int k = 0; k < size_; ++k) {
        double const factor = transition[i * size_ + k];
        double const* const error = each.errors.data() + k * parameters_;
        for (int j = 0; j < parameters_; ++j) row[j] += factor * error[j];
      }
    }
    std::copy_n(scratch_.begin(), states_ * parameters_, each.errors.begin());
  }
}

void ChangeDetector::observe(Innovated const& sample) {
  std::vector<double> shift(static_cast<std::size_t>(parameters_));
  for (Candidate& each : candidates_) {
    each.squares += sample.innovation * sample.innovation / sample.variance;
    each.samples += 1;
    std::fill(shift.begin(), shift.end(), 0.0);
    for (int k = 0; k < size_; ++k)
      for (int j = 0; j < parameters_; ++j)
        shift[static_cast<std::size_t>(j)] += sample.slopes[k] * each.errors[static_cast<std::size_t>(k * parameters_ + j)];
    for (int j = 0; j < parameters_; ++j) {
      auto const p = static_cast<std::size_t>(j);
      each.information[p] += shift[p] * shift[p] / sample.variance;
      double const term = shift[p] * sample.innovation / sample.variance;
      each.score[p] += term;
      each.score_squares[p] += term * term;
    }
    for (int k = 0; k < size_; ++k)
      for (int j = 0; j < parameters_; ++j)
        each.errors[static_cast<std::size_t>(k * parameters_ + j)] -= sample.gains[k] * shift[static_cast<std::size_t>(j)];
  }
}

void ChangeDetector::set_back(std::span<double const> gain) {
  for (Candidate& each : candidates_) {
    // Of x = m + G (theta - mu) the error d of x becomes d + G (e - d'), where d' was that of theta and e is the whole jump.
    for (int i = 0; i < states_; ++i)
      for (int j = 0; j < parameters_; ++j)
        for (int l = 0; l < parameters_; ++l) {
          double const error = each.errors[static_cast<std::size_t>((states_ + l) * parameters_ + j)];
          each.errors[static_cast<std::size_t>(i * parameters_ + j)] +=
              gain[static_cast<std::size_t>(i * parameters_ + l)] * ((l == j ? 1 : 0) - error);
        }
    for (int l = 0; l < parameters_; ++l)
      for (int j = 0; j < parameters_; ++j) each.errors[static_cast<std::size_t>((states_ + l) * parameters_ + j)] = l == j ? 1 : 0;
    std::ranges::fill(each.information, 0.0);
    std::ranges::fill(each.score, 0.0);
    std::ranges::fill(each.score_squares, 0.0);
    each.squares = each.samples = 0;
  }
}

double ChangeDetector::against_threshold(Candidate const& candidate, double statistic) const {
  if (candidate.samples < 2) return std::fabs(statistic);
  double const left = (candidate.squares - statistic * statistic) / (candidate.samples - 1);
  bool const larger = left > 1 && candidate.samples * (left - 1 - std::log(left)) > clearly_larger;
  return larger ? std::fabs(statistic) / std::sqrt(left) : std::fabs(statistic);
}

std::optional<DetectedJump> ChangeDetector::detect() {
  Candidate const* found = nullptr;
  explained_ = 0;
  DetectedJump best;
  std::vector<double> largest(static_cast<std::size_t>(parameters_));
  for (Candidate const& each : candidates_)
    for (int j = 0; j < parameters_; ++j) {
      auto const p = static_cast<std::size_t>(j);
      double const information = each.information[p];
      if (!(information * scales_[p] * scales_[p] > 25)) continue;
      double const z = each.score[p] / std::sqrt(information);
      bool const exceeds = std::fabs(z) > threshold_;
      if (exceeds && against_threshold(each, z) <= threshold_) continue;
      // Of a change whose samples are still few it is not yet known that it is one; a louder noise waits for that.
      explained_ = std::max(explained_, z * z);
      // The samples that agree: 1 where one of them is all of the score. Few weigh little as a rival, and give no alarm.
      double const agreeing = each.score_squares[p] > 0 ? each.score[p] * each.score[p] / each.score_squares[p] : 0;
      double const rival = z * std::sqrt(std::min(1.0, agreeing / least_samples));
      if (std::fabs(rival) > std::fabs(largest[p])) largest[p] = rival;
      if (!exceeds || agreeing < least_samples || std::fabs(z) <= std::fabs(best.statistic)) continue;
      found = &each;
      best.parameter = j;
      best.statistic = z;
    }
  if (found == nullptr) {
    waited_ = 0;
    return std::nullopt;
  }
  for (int j = 0; j < parameters_; ++j)
    if (j != best.parameter && std::fabs(largest[static_cast<std::size_t>(j)]) > std::fabs(best.other_statistic)) {
      best.other = j;
      best.other_statistic = largest[static_cast<std::size_t>(j)];
    }
  double const lead = best.statistic * best.statistic - best.other_statistic * best.other_statistic;
  if (lead < clear_lead && ++waited_ <= most_waited) return std::nullopt;
  auto const p = static_cast<std::size_t>(best.parameter);
  best.row = found->row;
  best.size = found->score[p] / found->information[p];
  best.sd = 1 / std::sqrt(found->information[p]);
  for (int k = 0; k < size_; ++k) best.moves.push_back(found->errors[static_cast<std::size_t>(k * parameters_ + best.parameter)]);
  best.mean_before = found->means[p];
  best.variance_before = found->variances[p];
  return best;
}

void ChangeDetector::keep(std::int64_t row, std::span<double const> means, std::span<double const> variances) {
  std::erase_if(candidates_, [&](Candidate const& each) { return !is_kept(each.row, row - each.row, window_); });
  if (row % spacing != 0 || parameters_ == 0) return;
  Candidate candidate;
  candidate.row = row;
  candidate.errors.assign(static_cast<std::size_t>(size_ * parameters_), 0.0);
  for (int j = 0; j < parameters_; ++j) candidate.errors[static_cast<std::size_t>((states_ + j) * parameters_ + j)] = 1;
  candidate.information.assign(static_cast<std::size_t>(parameters_), 0.0);
  candidate.score = candidate.score_squares = candidate.information;
  candidate.means.assign(means.begin(), means.end());
  candidate.variances.assign(variances.begin(), variances.end());
  candidates_.push_back(std::move(candidate));
}

}  // namespace sysid
