// Folders of results as a killed run leaves them.
#pragma once
#include <filesystem>
#include <string>

#include "core/system/files.hpp"
#include "report/file/replacement.hpp"
#include "report/file/standing_files.hpp"

namespace sysid::test {

/// A whole result becomes that of a run that was killed while its files were written: none of them has its name.
inline void leave_half_written(std::filesystem::path const& folder) {
  for (std::string const& name : files_of_result(folder)) std::filesystem::rename(folder / name, partial_path(folder / name));
}

/// That of one that was killed while they got their names: every second one has it, the summary has not.
inline void leave_half_renamed(std::filesystem::path const& folder) {
  std::string list;
  int place = 0;
  for (std::string const& name : files_of_result(folder)) {
    list += name + "\n";
    if (++place % 2 == 0 || name == "summary.json") std::filesystem::rename(folder / name, partial_path(folder / name));
  }
  write_file(folder / staged_list, list);
}

}  // namespace sysid::test
