// How far a search is that does not know how long it takes: shown against what is left at a guess that grows with the work.
#pragma once
#include <cstdint>
#include <functional>
#include <string>

#include "search/run_context.hpp"

namespace sysid {

/// Counts the solves of a job from its beginning. The job is in parts; of each its usual number is known, and a part that has gone
/// past three quarters of it is taken for a long one, of which a third of what is done is still to come.
class WorkLeft {
 public:
  /// usual: solves of the first part. Begins the job.
  WorkLeft(RunContext& context, std::string const& what, std::uint64_t usual);

  /// The next part, and what usually comes after it.
  void part(std::uint64_t usual, std::uint64_t later);
  /// That under another name.
  void next(std::string const& what, std::uint64_t usual, std::uint64_t later);
  /// Shows how far it is, and asks the context.
  std::function<bool()> stop();

 private:
  std::uint64_t done() const { return context_.ledger.solves() - before_; }
  std::uint64_t expected() const;

  RunContext& context_;
  std::uint64_t before_, begun_ = 0, usual_, later_ = 0;  // begun_: solves before the part
};

}  // namespace sysid
