// Libraries of the program's own that it opens when they are wanted: what only some runs need would cost every start.
#pragma once
#include <string>
#include <string_view>

namespace sysid {

/// Who sees the names of an opened library: itself, or all that is opened later, such as plug-ins that look for it.
enum class ModuleNames { own, open_to_all };

namespace detail {
/// What the function `entry` of the library returns; null, with the reason in `why`, where there is none.
void const* opened_module(char const* file, char const* entry, ModuleNames names, std::string& why);
}  // namespace detail

template <class Table>
struct OpenedModule {
  Table const* table = nullptr;
  std::string why;  // why there is none, in words for the user; else empty
};

/// Opens `file` beside the program (its run path says where) for good: libraries register what runs at exit. entry: the name of a
/// function without arguments that returns a Table, of which `version` is that of the program it was built with.
template <class Table>
OpenedModule<Table> open_module(char const* file, char const* entry, ModuleNames names = ModuleNames::own) {
  OpenedModule<Table> opened;
  opened.table = static_cast<Table const*>(detail::opened_module(file, entry, names, opened.why));
  if (opened.table != nullptr && std::string_view(opened.table->version) != SYSID_VERSION)
    return {nullptr, std::string(file) + " belongs to another version of the program"};
  return opened;
}

}  // namespace sysid
