// The checkpoint of a task on disk: whose it is, and what its back end stored.
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/session/preparation.hpp"
#include "app/session/session.hpp"
#include "experiment/experiments.hpp"

namespace sysid {

class Journal;

/// Of a task of which nothing is kept.
struct Unkept {
  std::uint64_t seed;
};

class TaskCheckpoint {
 public:
  TaskCheckpoint(Session& session, Task const& task, Unkept unkept) : session_(session), task_(task), seed_(unkept.seed) {}
  /// stated: the seed in the file. The seed in force is the command line's, the file's, that of a checkpoint to go on from, or one
  /// drawn and printed. verb: of another work on the task than its own, whose checkpoints are not those of the task.
  TaskCheckpoint(Session& session, Task const& task, std::optional<std::uint64_t> const& stated, std::string verb = {});

  std::uint64_t seed() const { return seed_; }
  std::filesystem::path const& path() const { return path_; }
  /// Digests of the data, which a checkpoint must agree with.
  void of_data(std::vector<ExperimentData> const& data);
  /// What is stored, else null, when going on was asked for and something is; UserError when it is damaged (E6207) or of another
  /// text, data or seed (E6208).
  std::shared_ptr<nlohmann::json const> stored() const;
  /// Of what `stored` gives; UserError (E6207) when it is none.
  Preparation preparation(nlohmann::json const& content) const;
  /// Takes the place of an earlier run's checkpoint; its results stay until there are new ones.
  void save(nlohmann::json const& content);
  /// Runs `work` with a journal that is kept in what `content` makes of its steps. stored: the steps that are kept already, or
  /// null. What `work` returns: whether it came to its end, else it was interrupted and the journal is saved, if it has something
  /// or a run that goes on would find earlier results in place of it. UserError (E6207) where what is stored cannot be read.
  bool keep_steps(nlohmann::json const* stored, std::function<nlohmann::json(nlohmann::json const& steps)> const& content,
                  std::function<bool(Journal&)> const& work);
  /// What `read` makes of stored values; UserError (E6207) where they are none.
  void reading(std::function<void()> const& read) const;
  /// A run that will never have a result leaves nothing to go on from.
  void drop();
  /// Whether there is one of this run, to go on from.
  bool kept() const;

 private:
  nlohmann::json who() const;
  UserError does_not_fit(std::string const& why) const;

  Session& session_;
  Task const& task_;
  std::filesystem::path path_;  // empty: kept nowhere
  std::uint64_t seed_;
  std::string verb_;  // empty: the task's own
  bool saved_ = false;
  std::vector<std::pair<std::string, std::string>> digests_;  // of each experiment, by its name
};

}  // namespace sysid
