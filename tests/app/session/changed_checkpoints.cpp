// Checkpoints as disks and editors leave them.
#include <doctest/doctest.h>

#include "fuzz/checkpoints.hpp"
#include "temporary_folder.hpp"

using namespace sysid;

TEST_CASE("no change of a checkpoint is resumed to another result") {
  TemporaryFolder const folder;
  for (fuzz::CheckpointCase const& each : fuzz::checkpoint_cases()) {
    CAPTURE(each.name);
    fuzz::CheckpointOutcome const outcome = fuzz::mutate_checkpoint(folder.path() / each.name, each, 12, 20, 1);
    CHECK(outcome.fault == "");
    CHECK(outcome.refused >= 10);
    CHECK(outcome.whole >= 20);
  }
}
