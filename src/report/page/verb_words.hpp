// What the page of a task says of its numbers, by the verb of the task.
#pragma once
#include <string_view>

#include "result/report.hpp"

namespace sysid {

struct VerbWords {
  std::string_view name;      // the verb
  std::string_view numbers;   // that a reader would use
  std::string_view broken;    // where a check failed, behind "Until this is fixed, "
  std::string_view sound;     // where none did
  std::string_view failures;  // what becomes of a simulation that fails
  std::string_view repeated;  // what the same seed gives again
};

VerbWords const& verb_words(Report const& report);

}  // namespace sysid
