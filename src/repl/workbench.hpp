// A session at the prompt: takes entries and shows their results. Does not know the terminal.
#pragma once
#include <cstdint>
#include <deque>
#include <string>

#include "repl/commands.hpp"
#include "repl/context.hpp"

namespace sysid::repl {

class Workbench {
 public:
  /// options: where results go, the seed of tasks that state none, threads. Of `force`: results that were there before the session
  /// may be replaced; its own always are.
  Workbench(RunOptions options, Progress& progress, Voices voices);

  /// Statements, expressions or a command; a whole entry, of several lines where a statement has them. False when it failed: the
  /// work is then what it was before the statement that failed.
  bool enter(std::string const& entry);
  /// Whether the entry needs no further line.
  bool complete(std::string const& entry) const;
  /// After `quit`.
  bool over() const { return context_.over; }
  /// Whether the work holds statements that no file holds.
  bool unsaved() const { return context_.work.unsaved; }

  Workspace const& work() const { return context_.work.statements; }
  /// As the front end understood it; null before the first statement.
  CheckedFile const* checked() const { return context_.work.checked ? &context_.work.checked->file : nullptr; }
  std::deque<Result> const& results() const { return context_.results.all; }
  /// The model that statements of a model change; empty when there is none.
  std::string const& current_model() const { return context_.work.model; }
  std::string const& current_data() const { return context_.work.data; }
  /// Tests: ask for an interruption at the n-th safe point of the next task; 0: never.
  void interrupt_after(std::uint64_t polls) { context_.options.interrupt_after = polls; }
  void set_plot_size(PlotSize size) { context_.plot_size = size; }

 private:
  Context context_;
};

}  // namespace sysid::repl
