// Compiled loops by name.
#include "native/machine_code.hpp"

#include <algorithm>

namespace sysid::native {
namespace {

constexpr double smallest_job = 0.05;  // [s]

}  // namespace

Function MachineCode::function(LoopName const& name, std::function<Loop()> const& write) {
  std::lock_guard const lock(mutex_);
  auto found = machines_.find(name);
  if (found == machines_.end()) {
    std::unique_ptr<Machine> machine;
    std::string why;
    if (Module const* const compiler = module()) machine = compiler->compile(write(), why);
    found = machines_.emplace(name, std::move(machine)).first;
  }
  return found->second ? found->second->function() : nullptr;
}

bool MachineCode::pays(LoopName const& name, double seconds, double compilation) {
  std::lock_guard const lock(mutex_);
  auto const found = machines_.find(name);
  if (found != machines_.end()) return found->second != nullptr;
  double& spent = spent_[name];
  spent += seconds;
  return spent >= std::max(smallest_job, compilation);
}

}  // namespace sysid::native
