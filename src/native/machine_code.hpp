// The machine code of one program: each loop is compiled once, when it is first wanted, and shared by all who run it.
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <tuple>

#include "native/module.hpp"

namespace sysid::native {

/// Which of a program's loops, for which vectors.
struct LoopName {
  LoopKind kind = LoopKind::observe;
  bool wide = false;
  int width = 4;  // lanes
  bool one_step = true;
  friend auto operator<=>(LoopName const&, LoopName const&) = default;
};

class MachineCode {
 public:
  /// The function of the loop, which `write` describes where it has not been compiled yet; null where it cannot be. The first
  /// caller compiles, the others wait.
  Function function(LoopName const& name, std::function<Loop()> const& write);
  /// Null where it has not been compiled.
  Function compiled(LoopName const& name);

  /// Whether the machine code of a loop pays: adds `seconds` of interpretation to what this loop would have saved so far, and
  /// compares with the seconds that its compilation takes. Where it has been compiled, it does. As much as there was may well come
  /// again; a job below 50 ms never waits for a compiler.
  bool pays(LoopName const& name, double seconds, double compilation);

  /// Adds `seconds` of interpretation that are known to come, in loops that are not known yet: until then a loop pays sooner.
  void expect(double seconds);

 private:
  std::mutex mutex_;
  std::map<LoopName, std::unique_ptr<Machine>> machines_;  // null: it could not be
  std::map<LoopName, double> spent_;                       // [s] predicted
  double expected_ = 0;                                    // [s] to come
};

}  // namespace sysid::native
