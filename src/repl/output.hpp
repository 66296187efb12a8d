// What a session at the prompt writes: answers, and messages about them.
#pragma once
#include <functional>
#include <ostream>
#include <set>
#include <string>

#include "core/text/diagnostic.hpp"
#include "repl/work/workspace.hpp"

namespace sysid::repl {

/// Where answers and messages go.
struct Voices {
  std::ostream& answers;
  std::ostream& messages;
  bool colour = false;                              // of messages
  std::function<int()> columns = [] { return 0; };  // of the terminal that shows the answers; 0: there is none
};

class Output {
 public:
  explicit Output(Voices voices) : voices_(std::move(voices)) {}

  /// For text that is not wrapped: sources, tables.
  std::ostream& answers() { return voices_.answers; }
  std::ostream& messages() { return voices_.messages; }
  int columns() const { return voices_.columns(); }

  void say(std::string const& line);
  /// What tasks print, numbers, plots: wrapped for the terminal.
  void answer(std::string const& text);
  /// False.
  bool refuse(std::string const& message, std::string const& help = "");
  /// Diagnostics about an entry.
  void show(Diagnostics const& diagnostics, std::string const& entry);
  void show(Diagnostics const& diagnostics, Source const& source);
  /// Diagnostics about the text of a work: places in what was typed are shown there. A warning is shown once in a session.
  void show(Diagnostics const& diagnostics, Source const& source, Workspace const& work, std::string const& entry);
  /// Whether no such warning has been shown; from now on it has.
  bool is_new(Diagnostic const& warning);
  /// Runs what may throw; false when it did, with what it said.
  bool guarded(Source const& source, std::function<bool()> const& act);

 private:
  Voices voices_;
  std::set<std::string> warned_;
};

/// What a message of the command line says in the words of the prompt: `help E2001` for `sysid explain E2001`.
std::string at_the_prompt(std::string text);

}  // namespace sysid::repl
