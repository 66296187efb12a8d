// The commands of the prompt, one row each, and how they are distinguished from statements of the language.
#include "repl/commands.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/text/words.hpp"
#include "repl/words.hpp"
#include "syntax/words.hpp"

namespace sysid::repl {
namespace {

/// {}: what is entered behind the word. alone: what is said where nothing is.
struct ForeignCommand {
  std::string_view word, ours, alone;
};

constexpr std::string_view of_drop = "`drop NAME` removes one statement or task",
                           of_folder = "paths are relative to the folder in which the session was started",
                           of_undo = "there is no undo: `reload` goes back to the file as it was last loaded or saved",
                           of_values = "enter the name of a quantity; `show NAME` shows a statement or the result of a task",
                           of_plots = "write `plot(FIT)`, `plot(QUANTITY)` or `plot(residual(CHANNEL))`";
constexpr ForeignCommand foreign_commands[] = {
    {"clear", "drop {}", of_drop},
    {"delete", "drop {}", of_drop},
    {"del", "drop {}", of_drop},
    {"remove", "drop {}", of_drop},
    {"rm", "drop {}", of_drop},
    {"erase", "drop {}", of_drop},
    {"plot", "plot({})", of_plots},
    {"print", "{}", of_values},
    {"disp", "{}", of_values},
    {"display", "{}", of_values},
    {"who", "list", {}},
    {"whos", "list", {}},
    {"ls", "list", {}},
    {"vars", "list", {}},
    {"dir", "list", {}},
    {"undo", {}, of_undo},
    {"revert", {}, of_undo},
    {"edit", {}, "enter the statement anew: it takes the place of the one with its name"},
    {"reset", {}, "`drop NAME` removes one statement or task, `load FILE` begins with a file"},
    {"rename", {}, "enter the statement under its new name, and remove the old one: `drop NAME`"},
    {"head", "show {}", of_values},
    {"open", "load {}", "write `load FILE`"},
    {"source", "load {}", "write `load FILE`"},
    {"cd", {}, of_folder},
    {"pwd", {}, of_folder},
    {"explain", "help {}", "write `help WORD`"},
    {"man", "help {}", "write `help WORD`"},
    {"doc", "help {}", "write `help WORD`"},
    {"bye", "quit", {}},
    {"q", "quit", {}},
};

/// Commands that editors of text begin with a colon.
constexpr std::string_view foreign_ends[] = {":q", ":q!", ":quit", ":exit", ":wq", ":x"};

}  // namespace

std::span<CommandRow const> commands() {
  static constexpr CommandRow rows[] = {
      {"load", "load FILE", "loads the statements of a file into the session; runs nothing", &command::load},
      {"reload", "reload", "loads again the file that was last loaded or saved", &command::reload},
      {"save", "save FILE", "writes the session as a file for `sysid run`", &command::save},
      {"columns", "columns FILE.csv", "shows the columns of a data file", &command::columns},
      {"list", "list, list TOPIC",
       "lists the session; or functions, distributions, disturbances, kernels, backends, discovery, solvers, reading or "
       "modules",
       &command::list},
      {"show", "show, show NAME", "shows the text of the session or of one of its statements, or the result of a task",
       &command::show},
      {"check", "check", "checks what the data can determine, before any sampling", &command::check},
      {"run", "run, run TASK ...", "runs the tasks of the session that have not been run, or those given", &command::run},
      {"refit", "refit [FIT] [as NAME] [with ...]", "fits the current model again, starting where the last fit ended",
       &command::refit},
      {"disturb", "disturb [FIT]", "fits the model of the last fit with a disturbance that was not measured, and compares both",
       &command::disturb},
      {"compare", "compare, compare TASK ...", "compares fits and predictions: evidence and errors", &command::compare},
      {"resume", "resume", "continues a task that was stopped by Ctrl-C", &command::resume},
      {"change", "change NAME", "selects the model or data block that the next statements change", &command::change},
      {"drop", "drop NAME", "removes a statement from the session, or a declaration from the model", &command::drop},
      {"help", "help, help WORD", "shows this help, or explains a word of the language or a message", &command::help},
      {"quit", "quit", "ends the session, like Ctrl-D", &command::quit},
  };
  return rows;
}

CommandRow const* command_of(std::string_view entry, std::string& arguments) {
  std::string const text(trimmed(entry));
  if (text.empty()) return nullptr;
  auto const row = [](std::string_view name) {
    auto const all = commands();
    return &*std::find_if(all.begin(), all.end(), [&](CommandRow const& each) { return each.name == name; });
  };
  if (text.front() == '?') {
    arguments = trimmed(std::string_view(text).substr(1));
    return row("help");
  }
  std::size_t end = 0;
  while (end < text.size() && words::continues_name(text[end])) ++end;
  std::string const word = text == "exit" ? "quit" : text.substr(0, end);
  auto const all = commands();
  if (std::none_of(all.begin(), all.end(), [&](CommandRow const& each) { return each.name == word; })) return nullptr;
  arguments = trimmed(std::string_view(text).substr(end));
  if (arguments.empty()) return row(word);
  // What an operator follows is a name: `load = fit ...`, `load*y + x`. A path may begin with / . or ~.
  bool const apart = text[end] == ' ' || text[end] == '\t';
  char const next = arguments.front();
  bool const path = (next == '/' || next == '~' || next == '.') && arguments.size() > 1 && arguments[1] != ' ';
  bool const names = words::continues_name(next) || next == '"' || path || (next == '[' && word == "help");
  bool const operation = arguments.starts_with("and ") || arguments.starts_with("or ");
  if (!apart || !names || operation) return nullptr;
  return row(word);
}

std::string instead_of_command(std::string_view entry) {
  std::string const text(trimmed(entry));
  if (std::ranges::find(foreign_ends, text) != std::end(foreign_ends)) return "write `quit`";
  std::size_t end = 0;
  while (end < text.size() && words::continues_name(text[end])) ++end;
  std::string const rest(trimmed(std::string_view(text).substr(end)));
  for (ForeignCommand const& each : foreign_commands) {
    if (each.word != std::string_view(text).substr(0, end)) continue;
    // What an operator follows is a name.
    bool const behind = !rest.empty() && words::begins_name(rest.front());
    bool const all = rest == "all" && each.alone == of_drop;
    if (!rest.empty() && !behind && each.alone != of_folder) return {};
    if (each.ours.empty() || ((rest.empty() || all) && !each.alone.empty())) return std::string(each.alone);
    return fmt::format("write `{}`", fmt::format(fmt::runtime(each.ours), rest));
  }
  return {};
}

}  // namespace sysid::repl
