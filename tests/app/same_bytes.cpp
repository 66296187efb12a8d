// The same answer twice: draws, summary and predictions are the same bytes for any threads, lanes, instruction set, and after
// resuming.
#include <doctest/doctest.h>

#include <map>

#include "app/running.hpp"
#include "core/numeric/instruction_set.hpp"

using namespace sysid;

namespace {

// Four chains of the Duffing case, shortened, with a prediction of each kind.
std::string shortened() {
  std::string text = read_file(std::filesystem::path(SYSID_SOURCE_DIR) / "models/duffing/duffing.sysid");
  text = with(text, "samples = 25000, burn_in = 5000, thin = 10, chains = 4", "samples = 900, burn_in = 400, thin = 5, chains = 4");
  text = with(text, "draws(200)", "draws(30)");
  return text + "redrawn = predict posterior on bench.test with draws(20), redraw = step, seed = 2\n";
}

std::map<std::string, std::string> promised_files(std::filesystem::path const& folder) {
  std::map<std::string, std::string> files;
  for (auto const& entry : std::filesystem::recursive_directory_iterator(folder)) {
    std::string const name = entry.path().filename().string();
    if (name.starts_with("draws_") || name == "summary.json" || name.starts_with("predict"))
      files[std::filesystem::relative(entry.path(), folder).string()] = read_file(entry.path());
  }
  return files;
}

std::map<std::string, std::string> files_of(RunOptions options) {
  TemporaryFolder folder;
  options.output = folder.path() / "results";
  run_text(std::filesystem::path(SYSID_SOURCE_DIR) / "models/duffing/duffing.sysid", shortened(), options);
  return promised_files(options.output);
}

std::map<std::string, std::string> const& reference() {
  static std::map<std::string, std::string> const files = files_of({});
  return files;
}

RunOptions with_execution(int lanes, int threads) {
  RunOptions options;
  options.execution = {lanes, threads};
  return options;
}

}  // namespace

TEST_CASE("a run leaves draws of four chains, summaries and predictions") {
  CHECK(reference().size() == 4 + 3 + 3);  // draws; summary.json of fit and both predictions; predict.csv of all three
}

TEST_CASE("a second run gives the same bytes") { CHECK(files_of({}) == reference()); }

TEST_CASE("threads change nothing") {
  CHECK(files_of(with_execution(0, 2)) == reference());
  CHECK(files_of(with_execution(4, 8)) == reference());
}

TEST_CASE("lanes change nothing") {
  for (int const lanes : {1, 8, 64}) CHECK(files_of(with_execution(lanes, 1)) == reference());
}

TEST_CASE("the instruction set changes nothing") {
  InstructionSet const before = instruction_set();
  (void)reference();
  force_instruction_set(narrowest_instruction_set);
  CHECK(files_of({}) == reference());
  if (supported_instruction_set() == InstructionSet::avx512) {
    force_instruction_set(InstructionSet::avx512);
    CHECK(files_of({}) == reference());
  }
  force_instruction_set(before);
}

TEST_CASE("a run interrupted three times and resumed gives the bytes of an unbroken one") {
  TemporaryFolder folder;
  RunOptions options;
  options.output = folder.path() / "results";
  auto const name = std::filesystem::path(SYSID_SOURCE_DIR) / "models/duffing/duffing.sysid";
  int interruptions = 0;
  // Polls before the first sample belong to the search; every later run resumes and stops some batches further on.
  for (std::uint64_t const polls : {120u, 20u, 15u}) {
    options.interrupt_after = polls;
    RunResult const result = run_text(name, shortened(), options);
    clear_interrupt();
    CHECK(result.exit == 75);
    interruptions += result.exit == 75;
    options.resume = true;
  }
  CHECK(interruptions == 3);
  options.interrupt_after = 0;
  RunResult const last = run_text(name, shortened(), options);
  CHECK(last.exit != 75);
  CHECK(promised_files(options.output) == reference());
}
