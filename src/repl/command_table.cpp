// The commands of the prompt, one row each, and how one is told from a statement of the language.
#include "repl/commands.hpp"

#include <algorithm>

#include "repl/words.hpp"
#include "syntax/words.hpp"

namespace sysid::repl {

std::span<CommandRow const> commands() {
  static constexpr CommandRow rows[] = {
      {"load", "load FILE", "takes the statements of a file into the work; runs nothing", &command::load},
      {"reload", "reload", "takes the file again that was loaded or saved last", &command::reload},
      {"save", "save FILE", "writes the work as a file that `sysid run` repeats", &command::save},
      {"columns", "columns FILE.csv", "what a data file holds", &command::columns},
      {"list", "list, list TOPIC", "the work; functions, distributions, kernels, backends, discovery, solvers or modules",
       &command::list},
      {"show", "show, show NAME", "the text of the work, of one of its statements, or what a task found", &command::show},
      {"check", "check", "what the data can tell, before any sampling", &command::check},
      {"run", "run, run TASK ...", "runs tasks of the work: those that have not been run, or those named", &command::run},
      {"refit", "refit [FIT] [as NAME] [with ...]", "fits the model as it is now again, beginning where the last fit ended",
       &command::refit},
      {"compare", "compare, compare TASK ...", "fits and predictions side by side: evidence and errors", &command::compare},
      {"resume", "resume", "goes on with a task that Ctrl-C has stopped", &command::resume},
      {"change", "change NAME", "the model or data block that statements typed from here on change", &command::change},
      {"drop", "drop NAME", "takes a statement out of the work, or a declaration out of the model", &command::drop},
      {"help", "help, help WORD", "this; what a word of the language or a message means", &command::help},
      {"quit", "quit", "ends the session, as Ctrl-D does", &command::quit},
  };
  return rows;
}

CommandRow const* command_of(std::string_view entry, std::string& arguments) {
  std::string const text = stripped(entry);
  if (text.empty()) return nullptr;
  auto const row = [](std::string_view name) {
    auto const all = commands();
    return &*std::find_if(all.begin(), all.end(), [&](CommandRow const& each) { return each.name == name; });
  };
  if (text.front() == '?') {
    arguments = stripped(std::string_view(text).substr(1));
    return row("help");
  }
  std::size_t end = 0;
  while (end < text.size() && words::continues_name(text[end])) ++end;
  std::string const word = text == "exit" ? "quit" : text.substr(0, end);
  auto const all = commands();
  if (std::none_of(all.begin(), all.end(), [&](CommandRow const& each) { return each.name == word; })) return nullptr;
  arguments = stripped(std::string_view(text).substr(end));
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

}  // namespace sysid::repl
