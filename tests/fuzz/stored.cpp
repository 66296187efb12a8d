// fuzz_stored [COUNT [SEED [FOLDER...]]]: so many changes of each file of a stored result, of one made here or of those of the
// folders, which are copied. Built with sanitizers; ends with 1 and the bytes where a change was read as something else.
#include "fuzz/stored.hpp"

#include <cstdio>
#include <cstdlib>

#include "temporary_folder.hpp"

namespace {

bool changes_of(std::filesystem::path const& folder, std::vector<sysid::fuzz::StoredFile> const& files, std::uint64_t count,
                std::uint64_t seed) {
  for (auto const& file : files) {
    auto const outcome = sysid::fuzz::mutate(folder, file, count, seed);
    std::printf("%-24s %8llu refused, %llu read as written\n", file.name.c_str(), static_cast<unsigned long long>(outcome.refused),
                static_cast<unsigned long long>(outcome.same));
    std::fflush(stdout);
    if (outcome.fault.empty()) continue;
    std::fwrite(outcome.fault.data(), 1, outcome.fault.size(), stderr);
    return false;
  }
  return true;
}

}  // namespace

int main(int argument_count, char** arguments) {
  std::uint64_t const count = argument_count > 1 ? std::strtoull(arguments[1], nullptr, 10) : 100000;
  std::uint64_t const seed = argument_count > 2 ? std::strtoull(arguments[2], nullptr, 10) : 1;
  sysid::TemporaryFolder const work;
  if (argument_count < 4) return changes_of(work.path(), sysid::fuzz::write_example(work.path()), count, seed) ? 0 : 1;
  for (int i = 3; i < argument_count; ++i) {
    std::filesystem::path const copy = work.path() / std::to_string(i);
    std::filesystem::copy(arguments[i], copy);
    std::printf("%s\n", arguments[i]);
    if (!changes_of(copy, sysid::fuzz::stored_files(copy), count, seed)) return 1;
  }
  return 0;
}
