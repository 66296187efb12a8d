// The options behind `with`, verb by verb, without those of back ends: names and meanings.
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
/// The verbs that have an option of this name.
std::vector<std::string> verbs_with_option(std::string_view option);

}  // namespace sysid
