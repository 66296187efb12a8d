// Whether a batch is divided: what an exchange takes is measured when ranks join, and corrected by what exchanges really take.
#pragma once

namespace sysid::ranks {

/// The same on all ranks, as long as all are told the same.
class Worth {
 public:
  Worth() = default;
  /// [s] of an exchange of nothing at the best, bytes/s; crowded: a node has more ranks than processors, so that a rank may have to
  /// wait until another leaves it one.
  Worth(double least, double rate, bool crowded);

  /// Whether work that takes so much longer on one rank than shared [s] is worth the exchange of so many bytes. Where exchanges
  /// have become too slow it agrees now and then, to see whether they still are: this takes a fiftieth of the time at most.
  bool worth(double seconds, double bytes);
  /// False where `worth` cannot agree.
  bool perhaps(double seconds) const { return seconds > 2 * least_; }
  /// An exchange of so many bytes has taken so long, without the time that the slowest rank has computed.
  void learn(double seconds, double bytes);

  /// [s] of an exchange of nothing, as it is expected now.
  double exchange() const { return exchange_; }

 private:
  double least_ = 0, exchange_ = 0, rate_ = 1;
  double refused_ = 0;  // [s] of work since the last look
};

}  // namespace sysid::ranks
