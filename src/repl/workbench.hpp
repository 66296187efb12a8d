// A session at the prompt: the work so far, what its tasks have left, and what an entry does to them. Knows no terminal.
#pragma once
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <ostream>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "app/session/options.hpp"
#include "app/session/session.hpp"
#include "core/system/progress.hpp"
#include "core/text/diagnostic.hpp"
#include "repl/canvas.hpp"
#include "repl/entry.hpp"
#include "repl/quantity.hpp"
#include "repl/result.hpp"
#include "repl/work.hpp"

namespace sysid {}

namespace sysid::repl {

/// Where what is said goes: answers, and messages about them.
struct Voices {
  std::ostream& answers;
  std::ostream& messages;
  bool colour = false;                              // of messages
  std::function<int()> columns = [] { return 0; };  // of the terminal that shows the answers; 0: there is none
};

/// A word at the prompt that is no statement of the language.
struct CommandRow;

class Workbench {
 public:
  /// options: where results go, the seed of tasks that state none, threads. Of `force`: results that were there before the session
  /// may be replaced; its own always are.
  Workbench(RunOptions options, Progress& progress, Voices voices);
  ~Workbench();

  /// Statements, expressions or a command; a whole entry, of several lines where a statement has them. False when it failed: the
  /// work is then what it was before the statement that failed.
  bool enter(std::string const& entry);
  /// Whether the entry needs no further line.
  bool complete(std::string const& entry) const;
  /// After `quit`.
  bool over() const { return over_; }
  /// Whether the work holds statements that no file holds.
  bool unsaved() const { return unsaved_; }

  Work const& work() const { return work_; }
  /// As the front end understood it; null before the first statement.
  CheckedFile const* checked() const { return checked_ ? &checked_->file : nullptr; }
  std::deque<Result> const& results() const { return results_; }
  /// The model that statements of a model change; empty when there is none.
  std::string const& current_model() const { return model_; }
  std::string const& current_data() const { return data_; }
  /// Tests: ask for an interruption at the n-th safe point of the next task; 0: never.
  void interrupt_after(std::uint64_t polls) { options_.interrupt_after = polls; }
  void set_plot_size(PlotSize size) { plot_size_ = size; }

 private:
  friend struct CommandRow;
  friend std::span<CommandRow const> commands();

  /// A text that passed the front end.
  struct Checked {
    Source source;
    CheckedFile file;
  };
  using Arguments = std::string const&;

  // --- workbench.cpp
  bool enter_parts(std::string const& entry);
  /// Puts a part into the draft; tasks to run when it has been checked. False when it cannot be.
  bool draft(EntryPart const& part, std::string const& entry, Work& work, std::vector<std::string>& tasks,
             std::vector<std::string>& notices);
  /// Checks the draft and makes it the work, or shows what is wrong with it.
  bool adopt(Work draft, std::string const& entry);
  /// Asks the files of data blocks that a draft adds or changes for their columns, as far as the files are there.
  void ask_for_columns(Work const& draft, Source const& source, CheckedFile const& file, Diagnostics& diagnostics);
  void show(Diagnostics const& diagnostics, std::string const& entry);
  /// Diagnostics about the text of a work: places in what was typed are shown there.
  void show(Diagnostics const& diagnostics, Source const& source, Work const& work, std::string const& entry);
  bool refuse(std::string const& message, std::string const& help = "");
  void say(std::string const& line);
  /// What tasks print, numbers, plots: wrapped for the terminal. Sources are answered as they are.
  void answer_lines(std::string const& text);
  /// Runs what may throw; false when it did, with what it said.
  bool guarded(Source const& source, std::function<bool()> const& act);
  std::set<std::string> tasks_run() const;

  // --- tasks.cpp
  bool run_task(std::string const& name, std::shared_ptr<Checked const> const& checked, bool resume);
  void keep(Session& session, Task const& task, int index, std::string summary);
  Result* find_result(std::string_view task);
  /// With a seed, so that the file that is saved gives the same numbers.
  std::string with_seed(std::string const& task) const;
  std::string free_task_name(std::string const& like) const;

  // --- file_commands.cpp
  bool take_file(std::filesystem::path const& path);
  bool load(Arguments path);
  bool reload(Arguments);
  bool save(Arguments path);
  bool columns(Arguments path);

  // --- task_commands.cpp
  bool check(Arguments);
  bool run(Arguments tasks);
  bool refit(Arguments);
  bool compare(Arguments tasks);
  /// The model of a task by the name of `list`, where what it ran on is kept beside what it has become.
  std::string model_of_work(std::string const& task, std::string model) const;
  bool resume(Arguments task);

  // --- work_commands.cpp
  bool command(CommandRow const& row, std::string const& arguments);
  bool list(Arguments topic);
  bool show_text(Arguments name);
  bool change(Arguments block);
  bool drop(Arguments name);
  bool help(Arguments word);
  bool quit(Arguments);

  // --- answers.cpp
  bool answer(ast::Expression const& tree, std::string const& text);
  std::optional<std::string> plot(ast::Call const& call, Evaluator& evaluator, Diagnostics& diagnostics) const;
  std::string plot_result(Result const& result) const;

  RunOptions options_;
  Progress& progress_;
  Voices voices_;
  Work work_;
  std::shared_ptr<Checked const> checked_;
  std::deque<Result> results_;                 // the oldest first
  std::map<std::string, FittedModel> fitted_;  // by task
  std::map<std::string, std::vector<SelectedCandidate>> selected_;
  std::map<std::string, std::shared_ptr<Checked const>> interrupted_;  // by task: what it ran from
  std::set<std::string> made_;                                         // folders of results that this session has made
  std::set<std::string> warned_;                                       // warnings that have been shown
  std::string model_, data_;
  std::filesystem::path loaded_;
  PlotSize plot_size_;
  bool over_ = false, unsaved_ = false;
};

struct CommandRow {
  std::string_view name, usage, summary;
  bool (Workbench::*run)(std::string const& arguments);
};
/// All commands, in the order in which `help` lists them.
std::span<CommandRow const> commands();
/// The command that an entry is, and the rest of its line; null where it is none: `load = fit ...` names a task.
CommandRow const* command_of(std::string_view entry, std::string& arguments);

/// What a message of the command line says in the words of the prompt: `help E2001` for `sysid explain E2001`.
std::string at_the_prompt(std::string text);

}  // namespace sysid::repl
