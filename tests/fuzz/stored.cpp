// fuzz_stored [COUNT [SEED [WHAT...]]]: so many changes of each stored file. WHAT: `example` (a result made here), a case of
// tests/fuzz/checkpoints.cpp (`mh`), a folder of results, which is copied, or a file, `stored.sysid`, which is run, and whose
// results are then read by later tasks too, all or that of a task, `stored.sysid:found`; example and all cases unless given. Built
// with sanitizers; ends with 1 and the bytes where a change was read as something else.
#include "fuzz/stored.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "fuzz/checkpoints.hpp"
#include "fuzz/later_tasks.hpp"
#include "temporary_folder.hpp"

namespace {

using namespace sysid;

/// Whether it was without a fault.
bool print(std::string const& name, fuzz::Outcome const& outcome) {
  std::printf("%-24s %8llu refused, %llu read as written\n", name.c_str(), static_cast<unsigned long long>(outcome.refused),
              static_cast<unsigned long long>(outcome.same));
  std::fflush(stdout);
  std::fwrite(outcome.fault.data(), 1, outcome.fault.size(), stderr);
  return outcome.fault.empty();
}

bool changes_of(std::filesystem::path const& folder, std::vector<fuzz::StoredFile> const& files, std::uint64_t count,
                std::uint64_t seed, std::function<std::string()> const& later = {}) {
  for (fuzz::StoredFile const& file : files)
    if (!print(file.name, fuzz::mutate(folder, file, count, seed, later))) return false;
  return true;
}

/// asked: of which task; empty: of all.
bool changes_of_run(std::filesystem::path const& file, std::string const& asked, std::filesystem::path const& folder,
                    std::uint64_t count, std::uint64_t seed) {
  fuzz::LaterTasks const tasks(file, folder);
  for (std::string const& name : tasks.names()) {
    if (!asked.empty() && name != asked) continue;
    std::printf("%s\n", name.c_str());
    if (!changes_of(folder / name, fuzz::stored_files(folder / name), count, seed, [&] { return tasks.read(name); })) return false;
  }
  return true;
}

}  // namespace

int main(int argument_count, char** arguments) {
  std::vector<std::string> const words(arguments + 1, arguments + argument_count);
  std::uint64_t const count = !words.empty() ? std::strtoull(words[0].c_str(), nullptr, 10) : 100000;
  std::uint64_t const seed = words.size() > 1 ? std::strtoull(words[1].c_str(), nullptr, 10) : 1;
  std::vector<std::string> asked(words.begin() + std::min<std::ptrdiff_t>(std::ssize(words), 2), words.end());
  auto const cases = fuzz::checkpoint_cases();
  if (asked.empty()) {
    asked.push_back("example");
    for (fuzz::CheckpointCase const& each : cases) asked.push_back(each.name);
  }
  TemporaryFolder const work;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    std::string const& what = asked[i];
    std::filesystem::path const folder = work.path() / std::to_string(i);
    auto const found =
        std::find_if(cases.begin(), cases.end(), [&](fuzz::CheckpointCase const& each) { return each.name == what; });
    bool clean = true;
    if (what == "example") {
      clean = changes_of(folder, fuzz::write_example(folder), count, seed);
    } else if (found != cases.end()) {
      fuzz::CheckpointOutcome const outcome = fuzz::mutate_checkpoint(folder, *found, count, seed, 100);
      clean = print("checkpoint of " + what, outcome);
      std::printf("  sealed again %11llu refused, %llu read; %llu whole runs\n",
                  static_cast<unsigned long long>(outcome.forged_refused), static_cast<unsigned long long>(outcome.forged_taken),
                  static_cast<unsigned long long>(outcome.whole));
    } else if (std::string const suffix = ".sysid"; what.find(suffix) != what.npos) {
      std::size_t const end = what.find(suffix) + suffix.size();
      clean = changes_of_run(what.substr(0, end), what.substr(std::min(end + 1, what.size())), folder, count, seed);
    } else {
      std::filesystem::copy(what, folder);
      std::printf("%s\n", what.c_str());
      clean = changes_of(folder, fuzz::stored_files(folder), count, seed);
    }
    if (!clean) return 1;
  }
  return 0;
}
