// A result that takes the place of another: killed at every call of the system, failed at every file, and whoever comes next.
#include "report/file/replacement.hpp"

#include <doctest/doctest.h>
#include <signal.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <functional>
#include <map>
#include <optional>

#include "core/system/files.hpp"
#include "core/system/folder_lock.hpp"
#include "core/text/diagnostic.hpp"
#include "report/file/standing_files.hpp"
#include "temporary_folder.hpp"

using namespace sysid;
namespace fs = std::filesystem;

namespace {

using FilesByName = std::map<std::string, std::string>;

FilesByName const earlier_result = {{"draws_1.csv", "old 1"},         {"draws_2.csv", "old 2"}, {"found.sysid", "old"},
                                    {"figures/pairs.svg", "old"},     {"report.html", "old"},   {"summary.json", "old"},
                                    {"figures/pairs.gnuplot", "old"}, {"resolved.sysid", "old"}};
FilesByName const later_result = {{"draws_1.csv", "new 1"}, {"draws_3.csv", "new 3"},         {"predict.csv", "new"},
                                  {"report.html", "new"},   {"figures/posterior.svg", "new"}, {"track.csv", "new"},
                                  {"summary.json", "new"}};
/// Of others, and of the task besides its result.
FilesByName const kept_beside = {{"notes.txt", "mine"}, {"figures/sketch.odg", "mine"}, {"checkpoint.cbor", "so far"}};

FilesByName with_kept(FilesByName files) {
  files.insert(kept_beside.begin(), kept_beside.end());
  return files;
}

void write_all(fs::path const& folder, FilesByName const& files) {
  make_folder(folder / "figures");
  for (auto const& [name, text] : files) write_file(folder / name, text);
}

FilesByName all_files(fs::path const& folder) {
  FilesByName out;
  for (fs::directory_entry const& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) out[fs::relative(entry.path(), folder)] = read_file(entry.path());
  return out;
}

void replace_by_later(fs::path const& folder) {
  NewFiles files(folder);
  for (auto const& [name, text] : later_result)
    if (name != "summary.json") files.write(name, text);
  files.write("summary.json", later_result.at("summary.json"));
  files.replace();
}

/// Runs `work` in a process that is killed at its stop before or after a call of the system with this number, from 0. False when
/// the work ends before; none where processes may not be traced.
std::optional<bool> killed_at(int stop, std::function<void()> const& work) {
  pid_t const child = fork();
  if (child == 0) {
    if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) _exit(3);
    raise(SIGSTOP);
    work();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status)) return std::nullopt;
  for (int k = 0; k <= stop; ++k) {
    if (ptrace(PTRACE_SYSCALL, child, nullptr, nullptr) != 0) break;
    waitpid(child, &status, 0);
    if (WIFEXITED(status)) return false;
  }
  kill(child, SIGKILL);
  waitpid(child, &status, 0);
  return true;
}

/// What the next run does that has the folder's lock.
void come_next(fs::path const& folder) {
  complete_replacement(folder);
  remove_partial(folder);
}

}  // namespace

TEST_CASE("a run that is killed at any moment of its writing has left the earlier result or its own, whole") {
  for (FilesByName const& before : {earlier_result, FilesByName()}) {
    CAPTURE(before.size());
    bool replaced = false, ended = false;
    for (int stop = 0; !ended; ++stop) {
      CAPTURE(stop);
      TemporaryFolder const folder;
      write_all(folder.path(), with_kept(before));
      auto const killed = killed_at(stop, [&] { replace_by_later(folder.path()); });
      if (!killed) {
        MESSAGE("processes cannot be traced here");
        return;
      }
      ended = !*killed;
      // Before anything is mended: where a summary stands, its files do, and without a list there is no other state.
      FilesByName left = all_files(folder.path());
      bool const listed = left.erase(staged_list) > 0;
      std::erase_if(left, [](auto const& each) { return each.first.ends_with(".partial"); });
      if (!listed || left.contains("summary.json")) CHECK((left == with_kept(before) || left == with_kept(later_result)));
      come_next(folder.path());
      FilesByName const now = all_files(folder.path());
      bool const own = now == with_kept(later_result);
      CHECK((own || now == with_kept(before)));
      CHECK_FALSE((replaced && !own));  // what has been decided stays so
      replaced = replaced || own;
      REQUIRE(stop < 10'000);
    }
    CHECK(replaced);
  }
}

TEST_CASE("what is killed while it finishes a killed run's work is finished by the next") {
  TemporaryFolder const folder;
  bool ended = false;
  for (int stop = 0; !ended && stop < 10'000; ++stop) {
    CAPTURE(stop);
    fs::remove_all(folder.path() / "a");
    write_all(folder.path() / "a", with_kept(earlier_result));
    for (auto const& [name, text] : later_result) stage_file(folder.path() / "a" / name, text);
    std::string list;
    for (auto const& [name, text] : later_result) list += name + "\n";
    write_file(folder.path() / "a" / staged_list, list);
    auto const killed = killed_at(stop, [&] { complete_replacement(folder.path() / "a"); });
    if (!killed) return;
    ended = !*killed;
    CHECK(summary_stands(folder.path() / "a"));  // a reader does the rest
    CHECK(all_files(folder.path() / "a") == with_kept(later_result));
  }
  CHECK(ended);
}

TEST_CASE("a result that cannot be written leaves the earlier one as it was, and nothing of its own") {
  auto const handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit before = {};
  REQUIRE(getrlimit(RLIMIT_FSIZE, &before) == 0);
  for (bool const first : {false, true}) {
    CAPTURE(first);
    TemporaryFolder const folder;
    if (!first) write_all(folder.path(), with_kept(earlier_result));
    rlimit little = before;
    little.rlim_cur = 100;
    REQUIRE(setrlimit(RLIMIT_FSIZE, &little) == 0);
    bool failed = false;
    try {
      NewFiles files(folder.path());
      files.write("draws_1.csv", "new 1");
      files.write("figures/pairs.svg", "new");
      files.write("summary.json", std::string(200, 'n'));
      files.replace();
    } catch (IoError const&) {
      failed = true;
    }
    REQUIRE(setrlimit(RLIMIT_FSIZE, &before) == 0);
    CHECK(failed);
    CHECK(all_files(folder.path()) == (first ? FilesByName() : with_kept(earlier_result)));
    CHECK(fs::exists(folder.path() / "figures") == !first);
  }
  std::signal(SIGXFSZ, handler);
}

TEST_CASE("a folder that has the name of a file is found before anything is replaced") {
  TemporaryFolder const folder;
  write_all(folder.path(), earlier_result);
  make_folder(folder.path() / "track.csv");
  CHECK_THROWS_AS(replace_by_later(folder.path()), IoError);
  CHECK(all_files(folder.path()) == earlier_result);
}

TEST_CASE("folders with names of result files are the user's: they stay, are no result, and stop nothing") {
  TemporaryFolder const folder;
  for (char const* name : {"draws_backup.csv", "track.csv", "report.html.partial", "figures/old.png", "figures/old.svg.partial"})
    make_folder(folder.path() / name);
  CHECK_FALSE(holds_result(folder.path()));
  NewFiles files(folder.path());
  files.write("summary.json", "new");
  files.replace();
  come_next(folder.path());
  for (char const* name : {"draws_backup.csv", "track.csv", "report.html.partial", "figures/old.png", "figures/old.svg.partial"})
    CHECK(fs::is_directory(folder.path() / name));
  remove_result(folder.path());
  CHECK_FALSE(holds_result(folder.path()));
  // In the place of a file that is to get its name one stops a killed run's completion before the earlier result is touched.
  write_file(folder.path() / "summary.json", "old");
  stage_file(folder.path() / "summary.json", "new");
  write_file(folder.path() / "track.csv.partial", "new");
  write_file(folder.path() / staged_list, "summary.json\ntrack.csv\n");
  CHECK(summary_stands(folder.path()));
  CHECK_THROWS_AS(complete_replacement(folder.path()), IoError);
  CHECK(read_file(folder.path() / "summary.json") == "old");
}

TEST_CASE("pictures that cannot be removed are found before anything is replaced") {
  constexpr uid_t nobody = 65534;
  TemporaryFolder const folder;
  write_all(folder.path(), earlier_result);
  fs::permissions(folder.path() / "figures", fs::perms::owner_read | fs::perms::owner_exec);
  bool const root = geteuid() == 0;  // to whom permissions are nothing
  if (root)
    for (char const* name : {"", "figures"}) REQUIRE(::chown((folder.path() / name).c_str(), nobody, static_cast<gid_t>(-1)) == 0);
  if (root) REQUIRE(::seteuid(nobody) == 0);
  bool failed = false;
  try {
    NewFiles files(folder.path());
    files.write("summary.json", "new");
    files.replace();
  } catch (IoError const&) {
    failed = true;
  }
  if (root) REQUIRE(::seteuid(0) == 0);
  fs::permissions(folder.path() / "figures", fs::perms::owner_all);
  CHECK(failed);
  CHECK(all_files(folder.path()) == earlier_result);
}

TEST_CASE("the table of a track goes with its result, and stays where it is of the new one") {
  for (bool const tracks : {false, true}) {
    TemporaryFolder const folder;
    write_all(folder.path(), {{"summary.json", "old"}, {"track.csv", "rows"}});
    NewFiles files(folder.path());
    if (tracks) files.take(tracked_rows);  // as it followed it has its name
    files.write("summary.json", "new");
    files.replace();
    CHECK(fs::exists(folder.path() / "track.csv") == tracks);
  }
}

TEST_CASE("a name that whoever completes a replacement would not know is refused when it is written") {
  TemporaryFolder const folder;
  NewFiles files(folder.path());
  for (char const* name : {"notes.txt", "figures/a/b.svg", "../draws_1.csv", "figures/sketch.odg"}) {
    CHECK_THROWS_AS(files.write(name, "new"), InternalError);
    CHECK_THROWS_AS(files.take(name), InternalError);
  }
  files.write("draws_1.csv", "new");
  CHECK_THROWS_AS(files.replace(), InternalError);  // a result has a summary
}

TEST_CASE("a link to a folder is followed, one to a file is replaced, and permissions are kept") {
  TemporaryFolder const folder;
  write_all(folder.path() / "real", earlier_result);
  write_file(folder.path() / "elsewhere", "mine");
  fs::remove(folder.path() / "real/report.html");
  fs::create_symlink("../elsewhere", folder.path() / "real/report.html");
  fs::permissions(folder.path() / "real/draws_1.csv", fs::perms::owner_read | fs::perms::owner_write);
  fs::create_directory_symlink("real", folder.path() / "link");
  replace_by_later(folder.path() / "link");
  CHECK(fs::is_symlink(folder.path() / "link"));
  CHECK(all_files(folder.path() / "real") == later_result);
  CHECK(read_file(folder.path() / "elsewhere") == "mine");
  CHECK(fs::status(folder.path() / "real/draws_1.csv").permissions() == (fs::perms::owner_read | fs::perms::owner_write));
}

TEST_CASE("while a run has the lock its renames are left to it") {
  TemporaryFolder const folder;
  stage_file(folder.path() / "summary.json", "new");
  write_file(folder.path() / staged_list, "summary.json\n");
  {
    FolderLock const run(folder.path());
    CHECK_FALSE(summary_stands(folder.path()));
    CHECK(fs::exists(folder.path() / staged_list));
  }
  CHECK(summary_stands(folder.path()));
  CHECK(all_files(folder.path()) == FilesByName{{"summary.json", "new"}});
}

TEST_CASE("what a folder from elsewhere asks for removes nothing behind a link to figures; a new result does") {
  TemporaryFolder const folder;
  fs::path const results = folder.path() / "results";
  make_folder(results);
  write_file(folder.path() / "mine.svg", "mine");
  fs::create_directory_symlink("..", results / "figures");
  stage_file(results / "summary.json", "new");
  write_file(results / staged_list, "summary.json\n");
  CHECK_FALSE(summary_stands(results));
  CHECK(fs::exists(folder.path() / "mine.svg"));
  complete_replacement(results);
  CHECK(summary_stands(results));
  CHECK(read_file(results / "summary.json") == "new");
  CHECK(fs::exists(folder.path() / "mine.svg"));
  NewFiles files(results);  // of a run that was told to replace what is there
  files.write("summary.json", "newer");
  files.replace();
  CHECK_FALSE(fs::exists(folder.path() / "mine.svg"));
}

TEST_CASE("a list that is none of ours moves and removes nothing") {
  for (char const* text : {"", "mine", "summary.json\n../draws_1.csv\n", "summary.json\nfigures/../notes.svg\n", "draws_1.csv\n"}) {
    CAPTURE(text);
    TemporaryFolder const folder;
    write_all(folder.path(), with_kept(earlier_result));
    write_file(folder.path() / "summary.json.partial", "half");
    write_file(folder.path() / staged_list, text);
    auto const before = all_files(folder.path());
    complete_replacement(folder.path());
    CHECK(all_files(folder.path()) == before);
  }
}

TEST_CASE("files without a summary are neither results nor nothing") {
  TemporaryFolder const folder;
  auto const message = [&] {
    try {
      require_no_result(folder.path());
      return std::string();
    } catch (UserError const& error) {
      return error.diagnostic().message;
    }
  };
  std::string const name = "`" + folder.path().string() + "`";
  CHECK(message().empty());
  for (char const* file : {"draws_1.csv", "track.csv"}) {
    write_file(folder.path() / file, "left");
    CHECK(message() == name + " contains no complete result: it has no `summary.json`");
    remove_file(folder.path() / file);
  }
  write_file(folder.path() / "draws_1.csv.partial", "half");
  CHECK(message().empty());
  write_file(folder.path() / "summary.json", "whole");
  CHECK(message() == name + " already contains results");
}
