// The run path that counts is that of the object which calls dlopen: of the program, the Python module or libsysid.
#include "core/system/module.hpp"

#include <dlfcn.h>

namespace sysid::detail {

void const* opened_module(char const* file, char const* entry, ModuleNames names, std::string& why) {
  void* const library = dlopen(file, RTLD_NOW | (names == ModuleNames::open_to_all ? RTLD_GLOBAL : RTLD_LOCAL));
  if (library == nullptr) {
    char const* const reason = dlerror();
    why = reason != nullptr ? reason : std::string(file) + " cannot be loaded";
    return nullptr;
  }
  auto const table = reinterpret_cast<void const* (*)()>(dlsym(library, entry));
  if (table == nullptr) why = std::string(file) + " belongs to another version of the program";
  return table != nullptr ? table() : nullptr;
}

}  // namespace sysid::detail
