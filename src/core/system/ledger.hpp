// The failure ledger: every failed solve has a class and a place, is counted and reported; failures are results, not hidden state.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

enum class FailureClass {
  non_finite,
  step_limit,    // the work budget is spent, or no step is short enough for the tolerance
  convergence,   // an implicit step has no solution that its iteration finds
  inconsistent,  // no values of the algebraic states satisfy the constraints
};

struct Failure {
  FailureClass kind = FailureClass::non_finite;
  std::string where;  // the sub-expression in the user's words, e.g. "k3*y^3 at duffing.sysid:12"
  std::uint64_t count = 0;
  double time = 0;                      // of the first example [s]; NaN: not looked into
  std::vector<double> example;          // its parameters, declared units
  std::vector<std::string> names = {};  // of them; empty: those of the target, in its order
};

class Ledger {
 public:
  /// Where the failures lie that are counted without a look at each.
  static constexpr char const* untraced = "place not determined, which is done for a few failures only";
  /// Ends the place of failures that are counted together.
  static constexpr std::string_view not_traced = ", place not determined";
  void add_solves(std::uint64_t count) { solves_ += count; }
  /// Counts a failure; `example`, its `names` and `time` are kept for the first one of its (kind, where).
  void add_failure(FailureClass kind, std::string const& where, double time, std::vector<double> example, std::uint64_t count = 1,
                   std::vector<std::string> names = {});
  /// Adds another ledger's counts; merging in a fixed order gives the same ledger for any number of threads.
  void merge(Ledger const& other);

  std::uint64_t solves() const { return solves_; }
  std::uint64_t failed() const;
  std::vector<Failure> const& failures() const { return failures_; }

 private:
  std::uint64_t solves_ = 0;
  std::vector<Failure> failures_;
};

std::string name(FailureClass kind);

}  // namespace sysid
