// Names decide: what a user keeps beside a result under a name of his own stays.
#include "report/file/standing_files.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/system/files.hpp"
#include "report/file/replacement.hpp"
#include "report/file/result_files.hpp"

namespace sysid {

namespace {

namespace fs = std::filesystem;

bool is_result_file(std::string const& name, std::string const& task) {
  return result_file_row(name) != nullptr || is_exported_file(name, task);
}

/// A folder of such a name is the user's; a link to one is removed as a file is.
bool is_folder(fs::directory_entry const& entry) {
  std::error_code ignored;
  return fs::is_directory(entry.symlink_status(ignored));
}

std::string task_of(fs::path const& folder) { return (folder / "").lexically_normal().parent_path().filename(); }

}  // namespace

bool is_figure_file(std::string const& name) {
  constexpr char const* endings[] = {".svg", ".png", ".pdf", ".txt", ".gnuplot"};
  return std::any_of(std::begin(endings), std::end(endings), [&](char const* ending) { return name.ends_with(ending); });
}

std::vector<std::string> files_of_result(fs::path const& folder) {
  std::vector<std::string> out;
  std::error_code ignored;
  for (fs::directory_entry const& entry : fs::directory_iterator(folder, ignored))
    if (std::string const name = entry.path().filename(); is_result_file(name, task_of(folder)) && !is_folder(entry))
      out.push_back(name);
  for (fs::directory_entry const& entry : fs::directory_iterator(folder / "figures", ignored))
    if (std::string const name = entry.path().filename(); is_figure_file(name) && !is_folder(entry))
      out.push_back("figures/" + name);
  return out;
}

bool holds_track(fs::path const& folder) {
  std::error_code ignored;
  fs::directory_entry const table(folder / tracked_rows, ignored);
  return fs::exists(table.symlink_status(ignored)) && !is_folder(table);
}

bool holds_result(fs::path const& folder) { return !files_of_result(folder).empty() || holds_track(folder); }

void require_no_result(fs::path const& folder) {
  if (!holds_result(folder)) return;
  if (!fs::exists(folder / "summary.json")) throw no_complete_result(folder, replace_results());
  throw UserError(result_error("", fmt::format("`{}` already contains results", folder.string()), replace_results()));
}

UserError no_complete_result(fs::path const& folder, Help help) {
  return UserError(result_error("", fmt::format("`{}` contains no complete result: it has no `summary.json`", folder.string()),
                                std::move(help)));
}

void remove_result(fs::path const& folder, fs::path const& but) {
  // The summary first: where it stands, the result is whole.
  std::vector<std::string> names = files_of_result(folder);
  if (holds_track(folder)) names.emplace_back(tracked_rows);
  std::partition(names.begin(), names.end(), [](std::string const& name) { return name == "summary.json"; });
  for (std::string const& name : names)
    if (folder / name != but) remove_file(folder / name);
}

void remove_partial(fs::path const& folder) {
  std::vector<fs::path> left;
  std::error_code ignored;
  auto const look = [&](fs::path const& where, auto const& written) {
    for (fs::directory_entry const& entry : fs::directory_iterator(where, ignored)) {
      fs::path const whole = entry.path().parent_path() / entry.path().stem();
      if (entry.path() == partial_path(whole) && written(whole.filename().string()) && !is_folder(entry))
        left.push_back(entry.path());
    }
  };
  look(folder, [&](std::string const& name) {
    return is_result_file(name, task_of(folder)) || name == "checkpoint.cbor" || name == "claim" || name == tracked_rows ||
           name == staged_list;
  });
  look(folder / "figures", &is_figure_file);
  for (fs::path const& file : left) remove_file(file);
}

}  // namespace sysid
