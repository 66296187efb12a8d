// Names and units of the file become statements of the language.
#include "data/look/paste_block.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "data/cell/unit_text.hpp"
#include "data/table/reading_rules.hpp"

namespace sysid {
namespace {

/// A name of the language for what a column is called: `Kraft (N)` is `kraft`.
std::string name_for(std::string const& column, std::set<std::string>& taken) {
  auto const split = split_name(column);
  std::string name;
  for (char const c : split ? split->name : column) {
    if (is_part_of_a_name(c))
      name += in_small_letters(c);
    else if (!name.empty() && name.back() != '_')
      name += '_';
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  if (name.empty() || !begins_a_name(name[0])) name = "y" + (name.empty() ? "" : "_" + name);
  static std::set<std::string> const reserved{"if", "then", "else", "and", "or", "not"};
  if (reserved.contains(name)) name += "_";
  std::string const plain = name;
  for (int number = 2; !taken.insert(name).second; ++number) name = fmt::format("{}_{}", plain, number);
  return name;
}

}  // namespace

std::string paste_block(RecordLook const& look) {
  std::set<std::string> taken;
  std::string const stem = std::filesystem::path(look.file).stem().stem().string();
  std::string out = fmt::format("data {} {{\n  file    {}\n", name_for(stem, taken), quoted_text(look.file));
  taken.clear();
  if (!look.reading.empty()) out += "  read    " + look.reading.substr(5) + "\n";
  if (look.time.rounded)
    out += fmt::format("  rate    {} [Hz]  # `{}` has these times, rounded to {} s\n", shortest(look.time.rounded->rate),
                       look.time.column, shortest(look.time.rounded->unit));
  else if (!look.time.column.empty())
    out += fmt::format("  time    {}\n", column_text(look.time.column, look.time.unit));
  else
    out += "  rate    1 [Hz]  # no column has the time: write the sampling rate here\n";
  for (ColumnLook const& column : look.columns) {
    if (!column.unread.empty() || column.name == look.time.column) continue;
    out += fmt::format("  measure {} = {}\n", name_for(column.name, taken), column_text(column.name, column.unit));
  }
  return out + "}\n";
}

}  // namespace sysid
