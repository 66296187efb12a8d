// Every step of putting files in their places may be done twice, so that it does not matter where the one before was stopped.
#include "report/file/replacement.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <set>
#include <sstream>

#include "core/system/files.hpp"
#include "core/system/folder_lock.hpp"
#include "core/text/diagnostic.hpp"
#include "report/file/result_files.hpp"
#include "report/file/standing_files.hpp"

namespace sysid {
namespace {

namespace fs = std::filesystem;

constexpr char const* summary_name = "summary.json";
constexpr std::string_view figures_begin = "figures/";

/// What is renamed has one of these names, so that a list that someone else has written moves nothing else.
bool may_be_staged(std::string const& name) {
  if (!name.starts_with(figures_begin))
    return name.find('/') == name.npos && (result_file_row(name) != nullptr || name == tracked_rows);
  std::string const figure = name.substr(figures_begin.size());
  return is_figure_file(figure) && figure.find('/') == figure.npos;
}

/// None where there is no list, or a file of that name that is none.
std::optional<std::set<std::string>> staged_names(fs::path const& folder) {
  std::error_code ignored;
  if (!fs::is_regular_file(folder / staged_list, ignored)) return std::nullopt;
  std::set<std::string> names;
  std::istringstream lines(read_regular_file(folder / staged_list));
  for (std::string line; std::getline(lines, line);) names.insert(line);
  bool const known = std::all_of(names.begin(), names.end(), &may_be_staged) && names.contains(summary_name);
  return known ? std::optional(std::move(names)) : std::nullopt;
}

enum class BehindLinks { stays, goes };  // pictures without a successor, where figures/ is a link

/// What of an earlier result has no successor among the names: draws of more chains, pictures, the table of a track.
std::vector<std::string> without_successor(fs::path const& folder, std::set<std::string> const& names, BehindLinks behind_links) {
  std::vector<std::string> out = files_of_result(folder);
  if (holds_track(folder)) out.emplace_back(tracked_rows);
  std::error_code ignored;
  bool const pictures = behind_links == BehindLinks::goes || !fs::is_symlink(folder / "figures", ignored);
  std::erase_if(out, [&](std::string const& name) {
    return name == summary_name || names.contains(name) || (!pictures && name.starts_with(figures_begin));
  });
  return out;
}

/// IoError for what would stop the steps on their way, when the earlier summary has gone. Returns what goes without a successor.
std::vector<std::string> require_place(fs::path const& folder, std::set<std::string> const& names, BehindLinks behind_links) {
  std::vector<std::string> going = without_successor(folder, names, behind_links);
  for (std::string const& name : names) require_no_folder(folder / name);
  for (std::string const& name : going) require_removable(folder / name);
  return going;
}

void put_in_place(fs::path const& folder, std::set<std::string> const& names, BehindLinks behind_links) {
  std::vector<std::string> const going = require_place(folder, names, behind_links);
  remove_file(folder / summary_name);
  for (std::string const& name : going) remove_file(folder / name);
  for (std::string const& name : names)
    if (name != summary_name) rename_staged(folder / name);
  if (std::error_code ignored; fs::is_directory(folder / "figures", ignored)) flush_folder(folder / "figures");
  flush_folder(folder);
  rename_staged(folder / summary_name);
  flush_folder(folder);
}

/// Flushed, so that no list of before comes back beside files that a later run has only begun.
void remove_list(fs::path const& folder) {
  remove_file(folder / staged_list);
  flush_folder(folder);
}

}  // namespace

NewFiles::~NewFiles() {
  if (decided_ || files_are_left()) return;
  std::error_code ignored;  // of one that was never begun, or of a disk that takes nothing any more
  for (std::string const& name : names_) fs::remove(partial_path(folder_ / name), ignored);
  if (!made_.empty()) fs::remove(made_, ignored);
}

void NewFiles::write(std::string const& name, std::string_view bytes) {
  take(name);
  fs::path const path = folder_ / name;
  if (!fs::exists(path.parent_path())) {
    make_folder(path.parent_path());
    made_ = path.parent_path();
  }
  stage_file(path, bytes);
}

void NewFiles::take(std::string const& name) {
  if (!may_be_staged(name))
    throw InternalError(fmt::format("`{}` is in no row of the files of a result (src/report/file/result_files.cpp)", name));
  names_.insert(name);
}

void NewFiles::replace() {
  if (!names_.contains(summary_name)) throw InternalError("a result without a summary");
  if (files_are_left()) return;
  (void)require_place(folder_, names_, BehindLinks::goes);
  std::error_code ignored;
  if (fs::is_directory(folder_ / "figures", ignored)) flush_folder(folder_ / "figures");
  write_file(folder_ / staged_list, fmt::format("{}\n", fmt::join(names_, "\n")));
  decided_ = true;
  put_in_place(folder_, names_, BehindLinks::goes);
  remove_list(folder_);
}

void complete_replacement(fs::path const& folder) {
  auto const names = staged_names(folder);
  if (!names) return;
  // The summary is the last to be renamed: without a staged one all have their names.
  if (std::error_code ignored; fs::exists(partial_path(folder / summary_name), ignored))
    put_in_place(folder, *names, BehindLinks::stays);
  remove_list(folder);
}

bool summary_stands(fs::path const& folder) {
  std::error_code ignored;
  // Reading a folder that comes from elsewhere must not remove pictures behind a link in it.
  bool const own = !fs::is_symlink(folder / "figures", ignored);
  if (own && !files_are_left() && fs::exists(folder / staged_list, ignored)) {
    try {
      FolderLock const lock(folder);
      complete_replacement(folder);
    } catch (UserError const&) {  // a run writes there
    } catch (IoError const&) {    // and nobody can; the next run says why
    }
  }
  return fs::exists(folder / summary_name, ignored);
}

}  // namespace sysid
