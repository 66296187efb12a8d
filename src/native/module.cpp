#include "native/module.hpp"

#include "core/system/module.hpp"

namespace sysid::native {
namespace {

OpenedModule<Module> const& opened() {
  static auto const once = open_module<Module>("sysid_native.so", module_entry);
  return once;
}

}  // namespace

Module const* module() { return opened().table; }

std::string const& why_unavailable() { return opened().why; }

}  // namespace sysid::native
