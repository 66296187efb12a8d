// Compiled loops by name.
#include "native/machine_code.hpp"

#include <algorithm>
#include <atomic>

namespace sysid::native {
namespace {

/// [s] of interpretation, of which a job that has less never waits for the compiler to be loaded.
constexpr double smallest_job = 0.05;

/// Times the compilation of a loop, of interpretation that is known to come.
constexpr double much = 4;

/// Whether that has been tried: loops cost no more than their own compilation then.
std::atomic<bool> compiler_was_loaded = false;

}  // namespace

Function MachineCode::function(LoopName const& name, std::function<Loop()> const& write) {
  std::lock_guard const lock(mutex_);
  auto found = machines_.find(name);
  if (found == machines_.end()) {
    std::unique_ptr<Machine> machine;
    std::string why;
    if (Module const* const compiler = module()) machine = compiler->compile(write(), why);
    compiler_was_loaded = true;
    found = machines_.emplace(name, std::move(machine)).first;
  }
  return found->second ? found->second->function() : nullptr;
}

Function MachineCode::compiled(LoopName const& name) {
  std::lock_guard const lock(mutex_);
  auto const found = machines_.find(name);
  return found != machines_.end() && found->second ? found->second->function() : nullptr;
}

bool MachineCode::pays(LoopName const& name, double seconds, double compilation) {
  std::lock_guard const lock(mutex_);
  expected_ = std::max(0.0, expected_ - seconds);
  auto const found = machines_.find(name);
  if (found != machines_.end()) return found->second != nullptr;
  double& spent = spent_[name];
  spent += seconds;
  double of_all_loops = 0;
  for (auto const& [_, each] : spent_) of_all_loops += each;
  // Of much that is to come, a part tells in which loops it does.
  bool const worth = spent >= (expected_ >= much * compilation ? compilation / much : compilation);
  return worth && (compiler_was_loaded || of_all_loops + expected_ >= smallest_job);
}

void MachineCode::expect(double seconds) {
  std::lock_guard const lock(mutex_);
  expected_ += seconds;
}

}  // namespace sysid::native
