// CBOR in the task's result folder.
#include "app/session/task_checkpoint.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/session/results.hpp"
#include "core/system/files.hpp"
#include "core/text/diagnostic.hpp"

namespace sysid {
namespace {

using json = nlohmann::json;

// Of the file itself. A file of an older format has none and is refused as damaged: nothing of it can be taken up.
constexpr int file_version = 2;

std::optional<json> read(std::filesystem::path const& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  std::string const bytes = read_file(path);
  return json::from_cbor(bytes.begin(), bytes.end(), true, false);
}

// A run that drew its seed goes on with that one.
std::uint64_t seed_of(Session& session, Task const& task, std::optional<std::uint64_t> const& stated,
                      std::filesystem::path const& path) {
  if (session.options.resume && !session.options.seed && !stated)
    if (auto const stored = read(path);
        stored && stored->is_object() && stored->contains("who") && stored->at("who").contains("seed"))
      return stored->at("who").at("seed").get<std::uint64_t>();
  return session.seed(task, stated);
}

}  // namespace

TaskCheckpoint::TaskCheckpoint(Session& session, Task const& task, std::optional<std::uint64_t> const& stated)
    : session_(session),
      task_(task),
      path_(checkpoint_path(session.result_folder(task))),
      seed_(seed_of(session, task, stated, path_)) {}

void TaskCheckpoint::of_data(std::vector<ExperimentData> const& data) {
  for (ExperimentData const& each : data) digests_.emplace_back(each.experiment.name, each.record.digest);
}

json TaskCheckpoint::who() const {
  json digests = json::array();
  for (auto const& [name, digest] : digests_) digests.push_back({name, digest});
  return {{"model", session_.source.all_text()}, {"data", std::move(digests)}, {"task", task_.name}, {"seed", seed_}};
}

std::shared_ptr<json const> TaskCheckpoint::stored() const {
  if (!session_.options.resume) return nullptr;
  auto const stored = read(path_);
  if (!stored) return nullptr;
  if (stored->is_object() && stored->contains("version") && stored->at("version") != file_version)
    throw UserError({Severity::error,
                     "E6208",
                     fmt::format("`{}` was written by another version of sysid", path_.string()),
                     std::nullopt,
                     {},
                     "continue with that version, or start again with --force"});
  if (!stored->is_object() || !stored->contains("version") || !stored->contains("who") || !stored->contains("content"))
    throw UserError(
        {Severity::error, "E6207", fmt::format("`{}` is damaged", path_.string()), std::nullopt, {}, "start again with --force"});
  if (stored->at("who") != who())
    throw UserError({Severity::error,
                     "E6208",
                     fmt::format("`{}` belongs to another text, data or seed", path_.string()),
                     std::nullopt,
                     {},
                     "restore the files of that run, or start again with --force"});
  return std::make_shared<json const>(stored->at("content"));
}

void TaskCheckpoint::save(json const& content) const {
  std::vector<std::uint8_t> const bytes = json::to_cbor(json{{"version", file_version}, {"who", who()}, {"content", content}});
  write_file(path_, std::string_view(reinterpret_cast<char const*>(bytes.data()), bytes.size()));
}

}  // namespace sysid
