// Every stage prints what it made: the dumps of the Duffing case and of a set of candidates are recorded. SYSID_BLESS=1 rewrites
// the records.
#include <doctest/doctest.h>

#include <cstdlib>

#include "app/run/pipeline.hpp"
#include "core/system/files.hpp"

using namespace sysid;

namespace {

void compare_dumps(std::filesystem::path const& file, std::string const& name, std::initializer_list<char const*> stages) {
  std::filesystem::path const root(SYSID_SOURCE_DIR);
  Source source(name + ".sysid", read_file(root / file));
  for (std::string const stage : stages) {
    CAPTURE(stage);
    Diagnostics diagnostics;
    std::string const text = dump_stage(source, stage, diagnostics);
    CHECK_FALSE(diagnostics.has_errors());
    auto const record = root / "tests/golden/dump" / (name + "." + stage);
    if (std::getenv("SYSID_BLESS") != nullptr) write_file(record, text);
    CHECK(text == read_file(record));
  }
}

}  // namespace

TEST_CASE("the stages of the Duffing case print what is recorded") {
  compare_dumps("models/duffing/duffing.sysid", "duffing", {"ast", "model", "program"});
}

TEST_CASE("the stages of a set of candidates print what is recorded") {
  compare_dumps("tests/golden/dump/candidates.sysid", "candidates", {"ast", "flat", "model"});
}
