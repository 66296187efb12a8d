// One session reads again and again; what it has read before is forgotten each time.
#include "fuzz/later_tasks.hpp"

#include <algorithm>
#include <optional>
#include <ostream>

#include "app/run/pipeline.hpp"
#include "app/session/reporting.hpp"
#include "app/session/session.hpp"
#include "app/session/stored_draws.hpp"
#include "core/text/diagnostic.hpp"
#include "fuzz/files.hpp"

namespace sysid::fuzz {
namespace {

namespace fs = std::filesystem;

template <class Values>
void append(std::string& all, Values const& values) {
  for (double const value : values) all.append(reinterpret_cast<char const*>(&value), sizeof value);
}

std::string all_of(Draws const& draws) {
  std::string all;
  for (Chain const& chain : draws.chains) {
    for (auto const* column : {&chain.log_density, &chain.log_prior, &chain.log_likelihood, &chain.acceptance})
      append(all, *column);
    for (auto const& row : chain.values) append(all, row);
  }
  return all;
}

CheckedFile checked(Source& source) {
  Diagnostics diagnostics;
  auto file = load(source, diagnostics);
  if (!file) throw UserError(diagnostics.all().front());
  return std::move(*file);
}

RunOptions options_of(fs::path const& output) {
  RunOptions options;
  options.output = output;
  options.figures = false;
  options.execution.threads = 1;
  return options;
}

}  // namespace

struct LaterTasks::State {
  State(fs::path const& path, fs::path const& output)
      : source(path.string(), bytes_of(path)),
        file(checked(source)),
        options(options_of(output)),
        session(source, file, options, silent, nowhere, nowhere) {}

  Source source;
  CheckedFile file;
  RunOptions options;
  SilentProgress silent;
  std::ostream nowhere{nullptr};
  Session session;
};

LaterTasks::LaterTasks(fs::path const& file, fs::path const& output) : state_(std::make_unique<State>(file, output)) {
  (void)run_tasks(state_->source, state_->file, {}, state_->options, state_->silent, state_->nowhere, state_->nowhere);
}
LaterTasks::~LaterTasks() = default;

std::vector<std::string> LaterTasks::names() const {
  std::vector<std::string> all;
  for (Task const& task : state_->file.tasks)
    if (fs::exists(state_->session.result_folder(task) / "summary.json")) all.push_back(task.name);
  return all;
}

std::string LaterTasks::read(std::string const& name) const {
  auto const& tasks = state_->file.tasks;
  auto const found = std::find_if(tasks.begin(), tasks.end(), [&](Task const& each) { return each.name == name; });
  Session& session = state_->session;
  session.find_results_in(session.result_folder(*found), *found);
  if (auto const wrong = stored_otherwise(session, *found, std::nullopt)) throw UserError(*wrong);
  auto const index = static_cast<int>(found - tasks.begin());
  if (kind_of(*found) == TaskKind::fit) {
    FittedModel const& fitted = fitted_model(session, index);
    return all_of(fitted.draws) + fitted.solver.method;
  }
  std::string all;
  if (kind_of(*found) == TaskKind::select)
    for (SelectedCandidate const& each : selected_candidates(session, index)) {
      append(all, std::vector{each.probability});
      all += all_of(each.draws);
    }
  return all;
}

}  // namespace sysid::fuzz
