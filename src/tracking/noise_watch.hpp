// Whether the noise of a channel has changed: innovations that are as uncorrelated as before but have another size.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

namespace sysid {

/// Samples of a channel from the first one on that was far from its prediction: of an outlier few of them are, of noise that has
/// grown many without an order, of states that are not where the filter has them many that follow each other smoothly.
class FarOffRun {
 public:
  /// innovation: in expected sds.
  void add(double innovation);
  void clear() { values_.clear(); }
  /// It began, and whose it is cannot be said yet.
  bool is_open() const;
  /// Many are far off, and each is much like the one before it or the one before that, or its opposite.
  bool is_smooth() const;

  static constexpr double far_off = 8;  // expected sds: no sample of a right model

 private:
  std::vector<double> values_;
};

struct NoiseChange {
  int channel = 0;
  std::int64_t row = 0;     // after which it came
  double statistic = 0;     // twice the logarithm of the likelihood ratio
  double factor = 1;        // of the variance of the noise
  bool correlated = false;  // successive innovations are related: it is not, or not only, the noise
};

/// With u = e^2/S of the n samples of a channel after a row, n (s - 1 - log s), s = mean u, is twice the logarithm of the
/// likelihood ratio of innovations of another size. By Chernoff's bound it exceeds T with a probability of at most exp(-T/2) on
/// either side if nothing has changed. Rows are kept as by the ChangeDetector; over them and the channels `rate` bounds the false
/// alarms of a row. A change of a parameter makes innovations larger, too: it goes before where it explains more. One below a fifth
/// of the sd is none. Squares count as at most 16, so that single outliers are no noise.
class NoiseWatch {
 public:
  NoiseWatch(int channels, double rate, int window);

  /// innovation: in expected sds. explained: the part of its variance that is not the noise of the sample.
  void observe(int channel, double innovation, double explained);
  /// explained: the largest z^2 of a change of a parameter.
  std::optional<NoiseChange> detect(double explained) const;
  /// From this row on the noise may have changed.
  void keep(std::int64_t row);
  void forget();

 private:
  struct Sums {
    double samples = 0, squares = 0, whole_squares = 0, explained = 0;
    double large = 0;  // squares above the limit
    double products = 0, second_products = 0;
  };
  static double statistic_of(Sums const& sums);
  static std::optional<NoiseChange> change_of(Sums const& sums);

  struct Candidate {
    std::int64_t row = 0;
    std::vector<Sums> channels;
  };
  struct Last {
    double one = 0, two = 0;
  };

  int window_;
  double threshold_;
  std::vector<Last> last_;
  std::vector<Candidate> candidates_;
};

}  // namespace sysid
