// What a data block needs of the columns of its file: no rule of how the file is written.
#pragma once
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

struct ColumnNeeds {
  std::string time{};                   // the column that the block calls the time: where stamps are looked for; empty: none
  std::vector<std::string> columns{};   // all that are read
  std::vector<std::string> complete{};  // those that need a number in every row: no word of theirs is proposed as missing

  bool whole(std::string_view column) const { return std::find(complete.begin(), complete.end(), column) != complete.end(); }
};

}  // namespace sysid
