// The loader asks the dynamic linker, which looks in the program's own folder (its run path).
#include "native/module.hpp"

#include <dlfcn.h>

#include <string_view>

namespace sysid::native {
namespace {

struct Loaded {
  Module const* module = nullptr;
  std::string why;
};

Loaded load() {
  // Never closed: LLVM registers what runs at exit.
  void* const library = dlopen("sysid_native.so", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    char const* const reason = dlerror();
    return {nullptr, reason != nullptr ? reason : "sysid_native.so cannot be loaded"};
  }
  auto const entry = reinterpret_cast<ModuleEntry>(dlsym(library, module_entry));
  Module const* const module = entry != nullptr ? entry() : nullptr;
  if (module == nullptr || std::string_view(module->version) != SYSID_VERSION)
    return {nullptr, "sysid_native.so belongs to another version of the program"};
  return {module, ""};
}

Loaded const& loaded() {
  static Loaded const once = load();
  return once;
}

}  // namespace

Module const* module() { return loaded().module; }

std::string const& why_unavailable() { return loaded().why; }

}  // namespace sysid::native
