// CBOR in the task's result folder.
#include "app/session/task_checkpoint.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "app/session/results.hpp"
#include "core/ranks/ranks.hpp"
#include "core/system/files.hpp"
#include "core/text/diagnostic.hpp"
#include "inference/backend/checkpoint.hpp"
#include "report/file/sealed_cbor.hpp"
#include "report/file/standing_files.hpp"
#include "search/journal.hpp"

namespace sysid {
namespace {

using json = nlohmann::json;

// Of the file and of all that back ends store in it: raised with any change of either. A file of another form is refused.
constexpr int form = 9;

UserError refused(char const* code, std::filesystem::path const& path, std::string const& what, char const* help) {
  return UserError({Severity::error, code, fmt::format("`{}` {}", path.string(), what), std::nullopt, {}, help});
}

// What differs between two runs, in words.
std::string other_than(json const& stored, json const& now) {
  constexpr std::pair<char const*, char const*> parts[] = {{"model", "another text of the file"},
                                                           {"data", "other data"},
                                                           {"task", "another task"},
                                                           {"seed", "another seed"},
                                                           {"verb", "another command"}};
  std::vector<std::string> differing;
  for (auto const& [key, words] : parts)
    if (!stored.is_object() || stored.value(key, json()) != now.value(key, json())) differing.emplace_back(words);
  return fmt::format("{}", fmt::join(differing, ", "));
}

UserError damaged(std::filesystem::path const& path) { return refused("E6207", path, "is damaged", "start again with --force"); }

// With the members `who` and `content`. That of the leader: the others may look when it has stored another.
std::optional<json> read(std::filesystem::path const& path) {
  bool const there = !files_are_left() && std::filesystem::exists(path);
  std::string const found = ranks::from_leader(there ? "+" + read_regular_file(path) : "");
  if (found.empty()) return std::nullopt;
  json stored;
  switch (open_cbor(found.substr(1), form, stored)) {
    case Seal::other_form:
      throw refused("E6208", path, "was written by another version of sysid",
                    "continue with that version, or start again with --force");
    case Seal::damaged:
      throw damaged(path);
    case Seal::whole:
      break;
  }
  // What only the seal vouches for: anyone can seal anything.
  if (!stored.is_object() || !stored.contains("who") || !stored.contains("content")) throw damaged(path);
  return stored;
}

// A run that drew its seed goes on with that one.
std::uint64_t seed_of(Session& session, Task const& task, std::optional<std::uint64_t> const& stated,
                      std::filesystem::path const& path) {
  if (session.options.resume && !session.options.seed && !stated)
    if (auto const stored = read(path)) {
      json const& who = stored->at("who");
      if (!who.is_object() || !who.contains("seed") || !who["seed"].is_number_unsigned()) throw damaged(path);
      return who["seed"].get<std::uint64_t>();
    }
  return session.seed(task, stated);
}

}  // namespace

TaskCheckpoint::TaskCheckpoint(Session& session, Task const& task, std::optional<std::uint64_t> const& stated, std::string verb)
    : session_(session),
      task_(task),
      path_(checkpoint_path(session.result_folder(task))),
      seed_(seed_of(session, task, stated, path_)),
      verb_(std::move(verb)) {}

void TaskCheckpoint::of_data(std::vector<ExperimentData> const& data) {
  for (ExperimentData const& each : data) digests_.emplace_back(each.experiment.name, each.record.digest);
}

json TaskCheckpoint::who() const {
  json digests = json::array();
  for (auto const& [name, digest] : digests_) digests.push_back({name, digest});
  json who = {{"model", session_.source.all_text()}, {"data", std::move(digests)}, {"task", task_.name}, {"seed", seed_}};
  if (!verb_.empty()) who["verb"] = verb_;
  return who;
}

std::shared_ptr<json const> TaskCheckpoint::stored() const {
  if (!session_.options.resume || path_.empty()) return nullptr;
  auto const stored = read(path_);
  if (!stored) return nullptr;
  if (stored->at("who") != who())
    throw refused("E6208", path_, "belongs to a run with " + other_than(stored->at("who"), who()),
                  "restore what differs, or start again with --force; every character of the file counts, comments and blanks too");
  return std::make_shared<json const>(stored->at("content"));
}

void TaskCheckpoint::reading(std::function<void()> const& read) const {
  try {
    read();
  } catch (checkpoint::Mismatch const& mismatch) {
    throw does_not_fit(mismatch.what());
  } catch (json::exception const&) {
    throw damaged(path_);
  }
}

Preparation TaskCheckpoint::preparation(json const& content) const {
  Preparation preparation;
  reading([&] { preparation = restore_preparation(content.at("preparation")); });
  return preparation;
}

bool TaskCheckpoint::keep_steps(json const* stored, std::function<json(json const&)> const& content,
                                std::function<bool(Journal&)> const& work) {
  bool ended = false;
  reading([&] {
    Journal journal([&](json const& steps) { save(content(steps)); }, session_.options.checkpoint_interval, stored);
    ended = work(journal);
    if (!ended && (!journal.empty() || holds_result(path_.parent_path()))) journal.save();
  });
  return ended;
}

UserError TaskCheckpoint::does_not_fit(std::string const& why) const {
  return refused("E6207", path_, "is damaged: " + why, "start again with --force");
}

void TaskCheckpoint::drop() {
  if (saved_) remove_file(path_);
}

void TaskCheckpoint::save(json const& content) {
  if (path_.empty()) return;
  saved_ = true;
  write_file(path_, sealed_cbor({{"who", who()}, {"content", content}}, form));
}

bool TaskCheckpoint::kept() const { return (saved_ || session_.options.resume) && std::filesystem::exists(path_); }

}  // namespace sysid
