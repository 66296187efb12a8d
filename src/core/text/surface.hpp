// Where a message is read, the command line or the prompt, and what is typed there.
#pragma once
#include <string>
#include <string_view>

namespace sysid {

enum class Surface { command_line, prompt };

/// What to do, as it is typed at the command line and at the prompt.
struct Help {
  std::string command_line, prompt;
};

/// "--resume", "`resume`".
std::string_view to_resume(Surface surface);

// About results that a folder holds.
/// Run the task again over them; why: what stands before it, "the file was lost: ".
Help run_again(std::string_view why = {});
/// Replace them or write elsewhere.
Help replace_results();
/// The same of an interrupted run, which can also be continued.
Help resume_or_replace();

}  // namespace sysid
