// A session at the prompt in its parts: the work, what its tasks have left, and where its answers go.
#pragma once
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "app/session/options.hpp"
#include "app/session/session.hpp"
#include "core/system/progress.hpp"
#include "repl/canvas.hpp"
#include "repl/output.hpp"
#include "repl/result.hpp"
#include "repl/work/workspace.hpp"

namespace sysid::repl {

/// A text that passed the front end.
struct CheckedText {
  Source source;
  CheckedFile file;
};

/// The statements of a session and what belongs to them.
struct CheckedWork {
  Workspace statements;
  std::shared_ptr<CheckedText const> checked;  // null before the first statement
  std::string model, data;                     // the blocks that statements typed change; empty: none
  std::filesystem::path file;                  // loaded or saved last
  bool unsaved = false;
};

/// What tasks have left, by task.
struct TaskResults {
  std::deque<Result> all;  // the oldest first
  std::map<std::string, FittedModel> fitted;
  std::map<std::string, std::vector<SelectedCandidate>> selected;
  std::map<std::string, std::shared_ptr<CheckedText const>> interrupted;  // what it ran from
  std::set<std::string> made;                                             // folders of results that this session has made

  /// Null when there is none.
  Result const* find(std::string_view task) const;
  std::set<std::string> tasks() const;
  /// Forgets the result of a task with its draws. That it was interrupted, and that its folder is the session's, stays.
  void erase(std::string_view task);
};

struct Context {
  RunOptions options;
  Progress& progress;
  Output output;
  CheckedWork work = {};
  TaskResults results = {};
  PlotSize plot_size = {};
  bool over = false;  // after `quit`
};

}  // namespace sysid::repl
