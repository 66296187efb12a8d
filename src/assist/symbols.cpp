// Look-ups in a table of names.
#include "assist/symbols.hpp"

#include <algorithm>
#include <array>

namespace sysid::assist {

std::string_view kind_name(SymbolKind kind) {
  static constexpr std::array<std::string_view, 24> names{"module",
                                                          "model",
                                                          "argument of the model",
                                                          "part",
                                                          "time",
                                                          "input",
                                                          "state",
                                                          "disturbance",
                                                          "parameter",
                                                          "constant",
                                                          "local definition",
                                                          "derived quantity",
                                                          "function",
                                                          "unknown function",
                                                          "argument of the function",
                                                          "channel",
                                                          "data block",
                                                          "range of the data",
                                                          "set of candidates",
                                                          "dictionary",
                                                          "task",
                                                          "column",
                                                          "file",
                                                          "word"};
  return names[static_cast<std::size_t>(kind)];
}

Occurrence const* SymbolTable::at(std::uint32_t offset) const {
  auto const behind =
      std::partition_point(occurrences.begin(), occurrences.end(), [&](Occurrence const& each) { return each.span.end < offset; });
  Occurrence const* found = nullptr;
  for (auto each = behind; each != occurrences.end() && each->span.begin <= offset; ++each) found = &*each;
  return found;
}

std::vector<Occurrence> SymbolTable::all_of(int symbol) const {
  std::vector<Occurrence> all;
  int const wanted = group[static_cast<std::size_t>(symbol)];
  for (Occurrence const& each : occurrences)
    if (group[static_cast<std::size_t>(each.symbol)] == wanted) all.push_back(each);
  return all;
}

Block const* SymbolTable::block_at(std::uint32_t offset) const {
  for (Block const& each : blocks)
    if (each.span.begin <= offset && offset <= each.span.end) return &each;
  return nullptr;
}

}  // namespace sysid::assist
