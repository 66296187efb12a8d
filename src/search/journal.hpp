// What a search has finished, so that one that was interrupted is not done again: it runs from its beginning and reads the steps
// that are kept in place of computing them.
#pragma once
#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

/// Steps are the loops that simulate. They come in the same order each time, so a step is known by its number; its kind is
/// stored to be compared.
///
///   if (json const* const kept = journal.begin("climb")) ...       its end, if `finished()`, else a state on the way
///   for ... {
///     if (stop()) return;                                           what the last turn computed may be worthless
///     if (journal.wants()) journal.reached(...);                    a state to go on from
///     ...
///   }
///   if (stop()) return;
///   journal.finish(...);
///
/// A step that begins where another was left unfinished is of a search that was given up: nothing is kept from there on.
class Journal {
 public:
  using Save = std::function<void(nlohmann::json const&)>;

  /// interval: seconds between two calls of `save`. stored: what `save` was given before, or null. Throws checkpoint::Mismatch
  /// where that is no journal.
  Journal(Save save, double interval, nlohmann::json const* stored = nullptr);

  /// What is kept of the next step, else null. Throws checkpoint::Mismatch where that is of another kind.
  nlohmann::json const* begin(std::string_view kind);
  /// Whether what `begin` has given is the step's end; the step is then over.
  bool finished() const { return was_finished_; }
  /// Whether the last state that is held is so old that work may be lost with it.
  bool wants() const;
  void reached(nlohmann::json state);
  void finish(nlohmann::json end);

  /// Whether there is nothing to go on from.
  bool empty() const { return finished_.empty() && part_.is_null(); }
  void save();

 private:
  using Clock = std::chrono::steady_clock;

  Save save_;
  double interval_;
  Clock::time_point saved_, held_;
  std::vector<nlohmann::json> finished_;  // [kind, end]
  nlohmann::json part_;                   // null, or [kind, state] of the step after the finished ones
  std::string kind_;
  std::size_t next_ = 0;  // the step that has begun, or begins
  bool was_finished_ = false, open_ = false, given_up_ = false;
};

}  // namespace sysid
