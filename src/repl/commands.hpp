// Words at the prompt that are no statements of the language, one row each.
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace sysid::repl {

struct Context;

struct CommandRow {
  std::string_view name, usage, summary;
  bool (*run)(Context& context, std::string const& arguments);
};
/// All commands, in the order in which `help` lists them.
std::span<CommandRow const> commands();
/// The command that an entry is, and the rest of its line; null where it is none: `load = fit ...` names a task.
CommandRow const* command_of(std::string_view entry, std::string& arguments);
/// "write `drop k`" of `delete k`, a command of other prompts; empty where the entry does not begin with such a word.
std::string instead_of_command(std::string_view entry);

/// False where a command failed, with a message.
namespace command {

// file_commands, task_commands, refit, disturb, work_commands
bool load(Context& context, std::string const& arguments);
bool reload(Context& context, std::string const& arguments);
bool save(Context& context, std::string const& arguments);
bool columns(Context& context, std::string const& arguments);
bool check(Context& context, std::string const& arguments);
bool run(Context& context, std::string const& arguments);
bool refit(Context& context, std::string const& arguments);
bool disturb(Context& context, std::string const& arguments);
bool compare(Context& context, std::string const& arguments);
bool resume(Context& context, std::string const& arguments);
bool list(Context& context, std::string const& arguments);
bool show(Context& context, std::string const& arguments);
bool change(Context& context, std::string const& arguments);
bool drop(Context& context, std::string const& arguments);
bool help(Context& context, std::string const& arguments);
bool quit(Context& context, std::string const& arguments);

}  // namespace command

}  // namespace sysid::repl
