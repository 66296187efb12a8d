// How far a long job is, reported to an interface; jobs do not know the terminal.
#pragma once
#include <cstdint>
#include <string_view>

namespace sysid {

class Progress {
 public:
  virtual ~Progress() = default;
  virtual void begin(std::string_view what, std::uint64_t total) = 0;
  /// The job turns out longer or shorter than `begin` was told.
  virtual void expect(std::uint64_t /*total*/) {}
  /// done: units of `total` finished so far; note: a few words of the current state ("acceptance 0.24").
  virtual void advance(std::uint64_t done, std::string_view note) = 0;
  /// finished: false where the job was stopped on the way.
  virtual void end(bool finished = true) = 0;
};

/// Shows nothing.
class SilentProgress : public Progress {
 public:
  void begin(std::string_view, std::uint64_t) override {}
  void advance(std::uint64_t, std::string_view) override {}
  void end(bool) override {}
};

}  // namespace sysid
