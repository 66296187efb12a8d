// Whether a tracked parameter has jumped: a generalised likelihood ratio of the innovations of a filter that knows of no jump.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace sysid {

/// What one sample of one channel says; slopes and gains as of TrackedProgram, [size].
struct Innovated {
  double innovation = 0, variance = 0;
  double const *slopes = nullptr, *gains = nullptr;
};

/// A jump that the innovations show.
struct DetectedJump {
  int parameter = 0;
  std::int64_t row = 0;     // after which it came
  double statistic = 0;     // z, standard normal where there is no jump
  double size = 0, sd = 0;  // of the jump, on the unbounded scale
  int other = -1;           // the next likeliest parameter, and its z
  double other_statistic = 0;
  std::vector<double> moves;                    // [size] what the entries of the filter are off by, per unit of the jump
  double mean_before = 0, variance_before = 0;  // of the parameter at `row`, on the unbounded scale
};

/// Willsky & Jones 1976, with a state x that holds the parameters. A jump of v in entry j after row r moves the expectation of the
/// innovation of a later sample by v H d, where d, the error of the filter per unit of the jump, follows
///   d = e_j at r,   d <- F d  from sample to sample,   d <- (I - K H) d  at each sample of a channel
/// With J = sum (H d)^2/S and b = sum (H d) e/S over these samples the estimate is v = b/J with variance 1/J, and z = b/sqrt(J) is
/// standard normal where there is no jump. Rows r are kept from 8 to 8 up to an age of 64, from 16 to 16 up to 128, and so on, so
/// that of a jump at least 7/8 of the samples after it count. An alarm: |z| above the quantile of `rate`/(2 M) of the normal,
/// where M is the most pairs of a row and a parameter there can be: by the union bound the probability of an alarm at a row without
/// a jump is at most `rate`. The first rows after a jump may be explained by several parameters: an alarm waits until the largest
/// z^2 leads that of any other parameter by 20, a likelihood ratio of e^10, but no longer than 100 rows.
///
/// A jump leaves innovations of the size expected behind it. Where those after r stay clearly larger, as where a sensor has become
/// noisier, z is divided by their rms before it is compared with the quantile, as in a t-test.
class ChangeDetector {
 public:
  /// states: before the `parameters` among the entries. window: the oldest row looked back for.
  ChangeDetector(int states, int parameters, double rate, int window);

  double threshold() const { return threshold_; }
  /// scales: [parameters] a jump that is large; one is looked for once its sd would be below a fifth of that.
  void set_scales(std::vector<double> scales) { scales_ = std::move(scales); }

  /// To the next sample: d(states)/d(entries before) [states x size].
  void move(double const* transition);
  void observe(Innovated const& sample);
  /// Once a row, after its samples.
  std::optional<DetectedJump> detect();
  /// From this row on a jump may have come. means, variances: of the parameters here, [parameters].
  void keep(std::int64_t row, std::span<double const> means, std::span<double const> variances);
  void forget() { candidates_.clear(), waited_ = 0; }
  /// The parameters of the filter were set back to what they were before all rows that are kept, its states along with them by the
  /// regression of states on parameters: gain, [states x parameters] by rows. What samples said so far is dropped.
  void set_back(std::span<double const> gain);
  /// The largest z^2 of the last call of `detect`, without those that a louder noise explains; 0 before the first.
  double explained() const { return explained_; }

 private:
  struct Candidate;
  double against_threshold(Candidate const& candidate, double statistic) const;

  struct Candidate {
    std::int64_t row = 0;
    std::vector<double> errors;                                // [size x parameters]: d
    std::vector<double> information, score, means, variances;  // [parameters]: J, b
    std::vector<double> score_squares;                         // of the terms of the score, summed
    double squares = 0, samples = 0;                           // sum of e^2/S, and how many
  };

  int states_, parameters_, size_;
  int window_;
  int waited_ = 0;  // rows since the threshold was exceeded
  double threshold_;
  double explained_ = 0;
  std::vector<double> scales_;
  std::vector<Candidate> candidates_;
  std::vector<double> scratch_;
};

/// The most rows that are kept at a time.
int most_candidates(int window);

/// Whether a row is still kept at an age: the older, the wider apart.
bool is_kept(std::int64_t row, std::int64_t age, int window);

}  // namespace sysid
