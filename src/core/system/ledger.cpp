// Counting failed solves by class and place.
#include "core/system/ledger.hpp"

namespace sysid {

void Ledger::add_failure(FailureClass kind, std::string const& where, double time, std::vector<double> example, std::uint64_t count,
                         std::vector<std::string> names) {
  if (count == 0) return;
  for (Failure& known : failures_) {
    if (known.kind == kind && known.where == where) {
      known.count += count;
      return;
    }
  }
  failures_.push_back({kind, where, count, time, std::move(example), std::move(names)});
}

void Ledger::merge(Ledger const& other) {
  add_solves(other.solves_);
  // A copy, so that a ledger may be merged with itself.
  std::vector<Failure> const added = other.failures_;
  for (Failure const& failure : added)
    add_failure(failure.kind, failure.where, failure.time, failure.example, failure.count, failure.names);
}

std::uint64_t Ledger::failed() const {
  std::uint64_t sum = 0;
  for (Failure const& failure : failures_) sum += failure.count;
  return sum;
}

std::string name(FailureClass kind) {
  switch (kind) {
    case FailureClass::non_finite:
      return "non-finite";
    case FailureClass::step_limit:
      return "step limit";
    case FailureClass::convergence:
      return "no convergence";
    case FailureClass::inconsistent:
      return "no consistent values";
  }
  return {};
}

}  // namespace sysid
