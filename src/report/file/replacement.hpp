// Puts the files of a new result in the place of an earlier one, so that at every moment one of the two is whole.
//
//   1. Every new file is written as NAME.partial, flushed. The earlier result is as it was, and stays so where this fails.
//   2. `result.staged` is written, which names them: from here on the new result is the one that stays.
//   3. The earlier summary.json goes, then earlier files that have no successor; the new ones get their names, the summary last.
//   4. `result.staged` goes.
//
// What a run leaves that is killed before 2 is removed by the next (`remove_partial`). After one that is killed later, the next
// that comes to the folder, a run or a reader, does what is left of 3.
#pragma once
#include <filesystem>
#include <set>
#include <string>
#include <string_view>

namespace sysid {

/// The names of the new files, a line each, while they take their places.
inline constexpr char const* staged_list = "result.staged";

class NewFiles {
 public:
  explicit NewFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}
  /// Removes what is staged, where it has not come to `replace`.
  ~NewFiles();
  NewFiles(NewFiles const&) = delete;

  /// name: in the folder, "draws_1.csv", or "figures/pairs.svg". IoError where it cannot be written.
  void write(std::string const& name, std::string_view bytes);
  /// One that has been written under `partial_path` already, and flushed, or has its name. InternalError for a name that is none of
  /// a result: whoever completes this would not know it.
  void take(std::string const& name);
  /// Steps 2 to 4. There is a summary among them. IoError names what failed; what can be foreseen fails before step 2, and after it
  /// the next that comes tries again.
  void replace();

 private:
  std::filesystem::path folder_;
  std::set<std::string> names_;
  std::filesystem::path made_;  // the folder of figures, if there was none
  bool decided_ = false;
};

/// Steps 3 and 4, where a killed run has come to 2; pictures of before behind a figures/ that is a link stay. To be called by
/// whoever holds the folder's lock.
void complete_replacement(std::filesystem::path const& folder);

/// Whether a summary stands there, and so a whole result; `complete_replacement` comes first, unless a run is just doing so, its
/// figures/ is a link, or it fails: then it is left to the next run. Throws nothing of the files.
bool summary_stands(std::filesystem::path const& folder);

}  // namespace sysid
