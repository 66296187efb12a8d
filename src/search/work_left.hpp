// How far a search is: against a guess that grows with the work, or against a budget that is kept.
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
  WorkLeft(WorkLeft const&) = delete;  // `stop` holds on to it
  WorkLeft& operator=(WorkLeft const&) = delete;

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

/// What a search may use, in simulations of the whole record: announced at its beginning.
class SearchBudget {
 public:
  SearchBudget(RunContext& context, std::string const& what, std::uint64_t announced);
  SearchBudget(SearchBudget const&) = delete;  // `stop` holds on to it
  SearchBudget& operator=(SearchBudget const&) = delete;

  /// Counts the solves of `part`, each as `share` of one, beside those of the context; null: the context's alone.
  void count(Ledger const* part, double share);
  /// More than was announced at the beginning.
  void add(std::uint64_t simulations) { announced_ += simulations; }
  /// What is being done, and about how much follows it.
  void plan(std::string note, double later);
  double spent() const;
  double left() const { return static_cast<double>(announced_) - spent(); }
  /// Shows how far it is, and asks the context.
  std::function<bool()> stop();
  void end(bool finished) { context_.progress.end(finished); }

 private:
  RunContext& context_;
  std::uint64_t before_, announced_;
  double expected_;  // in all
  std::string note_;
  Ledger const* part_ = nullptr;
  double share_ = 1;
};

}  // namespace sysid
