// What `sysid list` prints, from the tables the language is made of.
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace sysid {

struct ListRow {
  std::string_view name;  // the topic
  std::string (*text)();
};

std::span<ListRow const> lists();
/// nullptr where there is no such topic.
ListRow const* find_list(std::string_view topic);
/// "functions, distributions, ... or modules".
std::string list_topics();

}  // namespace sysid
