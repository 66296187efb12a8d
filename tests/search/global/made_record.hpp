// A made record, searched as a whole or from its first rows.
#pragma once
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "inference/targets.hpp"
#include "search/global/growing_search.hpp"

namespace sysid::testing {

/// A record at unit steps with normal noise of known sd, and the curve that is fitted to it.
struct MadeRecord {
  using Curve = std::function<double(std::vector<double> const& w, double t)>;
  std::vector<std::string> names;
  std::vector<Prior> priors;
  std::vector<double> truth;
  Curve curve;
  int rows;
  double sd;
  double slip = 0;  // of the time, by a coarse solver: its part of t^2; each refinement leaves a sixteenth
  int finest = 0;
  std::vector<double> samples = {};
  mutable int calls = 0;
  int last = std::numeric_limits<int>::max();  // call from which on all is given up

  bool given_up() const { return calls >= last; }
};

/// What is seen of it: so many rows.
class RowsSeen : public TestTarget {
 public:
  RowsSeen(MadeRecord const& record, int rows, int finer = 0)
      : TestTarget(record.names, record.priors, rows, 0,
                   [&record, rows, slip = record.slip / std::pow(16, finer)](std::vector<double> const& w, std::vector<double>& r) {
                     for (int i = 0; i < rows; ++i) {
                       auto const at = static_cast<std::size_t>(i);
                       r[at] = (record.samples[at] - record.curve(w, i + slip * i * i)) / record.sd;
                     }
                   }),
        record_(record) {}
  void residuals(ConstLanes theta, Lanes out, Ledger& ledger) const override {
    TestTarget::residuals(theta, out, ledger);
    if (++record_.calls < record_.last) return;
    for (int w = 0; w < out.width(); ++w)
      for (int r = 0; r < out.rows(); ++r) out(r, w) = infinity;
  }

 private:
  MadeRecord const& record_;
};

inline MadeRecord make_record(MadeRecord record, std::uint64_t seed, MadeRecord::Curve const& made = {}) {
  Stream stream({seed, Purpose::test, 0, 0});
  for (int i = 0; i < record.rows; ++i)
    record.samples.push_back((made ? made : record.curve)(record.truth, i) + record.sd * stream.normal());
  return record;
}

inline ShorterRecords parts_of(MadeRecord const& record) {
  return {record.rows, record.finest, [&record](double share, int finer) {
            int const rows = static_cast<int>(std::ceil(share * record.rows));
            return FirstPart{std::make_unique<RowsSeen>(record, rows, finer), static_cast<double>(rows) / record.rows};
          }};
}

inline MadeRecord oscillation() {
  return {{"rate", "size", "phase"},
          {{Prior::log_uniform, 1e-3, 1}, {Prior::log_uniform, 0.1, 10}, {Prior::uniform, 0, 6}},
          {0.137, 1, 2},
          [](std::vector<double> const& w, double t) { return w[1] * std::sin(w[0] * t + w[2]); },
          10'000,
          0.3};
}

}  // namespace sysid::testing
