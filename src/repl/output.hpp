// What a session at the prompt writes: answers, and messages about them.
#pragma once
#include <functional>
#include <ostream>
#include <set>
#include <string>
#include <string_view>
#include <vector>

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
  /// Whether no such warning of that statement has been shown; from now on it has. item: the statement of the file that it stands
  /// in, since places move while statements are typed.
  bool is_new(Diagnostic const& warning, std::string_view item);
  /// Runs what may throw; false when it did, with what it said.
  bool guarded(Source const& source, std::function<bool()> const& act);

 private:
  Voices voices_;
  std::set<std::vector<std::string>> warned_;
};

}  // namespace sysid::repl
