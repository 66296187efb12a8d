// fuzz_stored [COUNT [SEED]]: so many changes of each file of a stored result. Built with sanitizers; ends with 1 and the bytes
// where a change was read as something else.
#include "fuzz/stored.hpp"

#include <cstdio>
#include <cstdlib>

#include "temporary_folder.hpp"

int main(int argument_count, char** arguments) {
  std::uint64_t const count = argument_count > 1 ? std::strtoull(arguments[1], nullptr, 10) : 100000;
  std::uint64_t const seed = argument_count > 2 ? std::strtoull(arguments[2], nullptr, 10) : 1;
  sysid::TemporaryFolder const folder;
  for (auto const& file : sysid::fuzz::write_example(folder.path())) {
    auto const outcome = sysid::fuzz::mutate(folder.path(), file, count, seed);
    std::printf("%-16s %8llu refused, %llu read as written\n", file.name.c_str(), static_cast<unsigned long long>(outcome.refused),
                static_cast<unsigned long long>(outcome.same));
    std::fflush(stdout);
    if (outcome.fault.empty()) continue;
    std::fwrite(outcome.fault.data(), 1, outcome.fault.size(), stderr);
    return 1;
  }
  return 0;
}
