// Detects predictions whose fit has been run again since; they are not deleted.
#include "app/session/made_from.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/session/task_rows.hpp"
#include "core/system/digest.hpp"
#include "core/system/files.hpp"
#include "report/file/replacement.hpp"
#include "report/file/stored_files.hpp"

namespace sysid {
namespace {

constexpr char const* task_key = "made_from";
constexpr char const* digest_key = "made_from_sha256";

/// "made_from", "made_from_2": an average is made from several.
std::string numbered(char const* key, std::size_t place) { return place == 0 ? key : fmt::format("{}_{}", key, place + 1); }

std::optional<std::string> digest_of(std::filesystem::path const& folder) {
  auto const summary = folder / "summary.json";
  if (!summary_stands(folder)) return std::nullopt;
  return sha256(read_regular_file(summary));
}

}  // namespace

Facts made_from(Session const& session, Task const& task) {
  auto const* prediction = std::get_if<PredictTask>(&task.what);
  if (prediction == nullptr) return {};
  Facts facts;
  std::vector<int> const needs = task_row(task).needs(task);
  for (std::size_t k = 0; k < needs.size(); ++k) {
    Task const& source = session.file.tasks[static_cast<std::size_t>(needs[k])];
    auto const digest = digest_of(session.result_folder(source));
    if (!digest) continue;
    facts.emplace_back(numbered(task_key, k), source.name);
    facts.emplace_back(numbered(digest_key, k), *digest);
  }
  return facts;
}

std::optional<Finding> made_from_earlier(std::filesystem::path const& folder) {
  auto const path = folder / "summary.json";
  if (!summary_stands(folder)) return std::nullopt;
  auto const summary = nlohmann::json::parse(read_summary(folder));
  auto const text = [&](std::string const& key) {
    auto const& versions = summary.at("versions");
    return versions.contains(key) && versions[key].is_string() ? versions[key].get<std::string>() : std::string();
  };
  std::string source;
  for (std::size_t k = 0; !(source = text(numbered(task_key, k))).empty(); ++k) {
    auto const now = digest_of(std::filesystem::absolute(folder).lexically_normal() / ".." / source);
    if (now && *now != text(numbered(digest_key, k))) break;
  }
  if (source.empty()) return std::nullopt;
  return Finding{FindingCode::made_from_earlier,
                 Severity::warning,
                 {source},
                 fmt::format("this prediction was made from an earlier run of `{}`, which has been run again since", source),
                 "run it again: `sysid predict FILE --force`"};
}

void add_source(std::filesystem::path const& fit, Report& report) {
  auto const summary = nlohmann::json::parse(read_summary(fit));
  std::vector<std::string> failed, doubtful;
  std::string const name = interpreted(fit / "summary.json", [&] {
    for (auto const& finding : summary.at("findings")) {
      std::string const severity = finding.value("severity", ""), code = finding.value("code", "");
      std::vector<std::string>* const codes = severity == "error" ? &failed : severity == "warning" ? &doubtful : nullptr;
      if (codes != nullptr && std::find(codes->begin(), codes->end(), code) == codes->end()) codes->push_back(code);
    }
    return summary.value("task", std::string());
  });
  if (!failed.empty())
    report.findings.push_back(
        {FindingCode::from_doubtful_fit,
         Severity::error,
         {name},
         fmt::format("the fit `{}`, from which these draws are taken, failed its checks: {}", name, fmt::join(failed, ", ")),
         "follow the help in the verdict of the fit, then predict again"});
  else if (!doubtful.empty())
    report.findings.push_back(
        {FindingCode::from_doubtful_fit,
         Severity::warning,
         {name},
         fmt::format("the fit `{}`, from which these draws are taken, has warnings: {}", name, fmt::join(doubtful, ", ")),
         "read the verdict of the fit"});
}

}  // namespace sysid
