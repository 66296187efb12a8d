// What may stand behind `with`, verb by verb, but for back ends: names for messages, meanings for whoever asks.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

struct TaskOptionRow {
  std::string_view name;
  std::string_view usage;    // "start = estimated(rows = 50)"
  std::string_view summary;  // one line
  std::string_view choices;  // words that may be its value, separated by blanks
};

/// In the order in which messages name them; empty for what is no verb.
std::vector<TaskOptionRow> task_options(std::string_view verb);
std::vector<std::string> task_option_names(std::string_view verb);

}  // namespace sysid
