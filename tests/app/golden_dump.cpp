// Every stage prints what it made: the dumps of the Duffing case are recorded. SYSID_BLESS=1 rewrites the records.
#include <doctest/doctest.h>

#include <cstdlib>

#include "app/pipeline.hpp"
#include "core/files.hpp"

using namespace sysid;

TEST_CASE("the stages of the Duffing case print what is recorded") {
  std::filesystem::path const root(SYSID_SOURCE_DIR);
  Source source("duffing.sysid", read_file(root / "models/duffing/duffing.sysid"));
  for (std::string const stage : {"ast", "model", "program"}) {
    CAPTURE(stage);
    Diagnostics diagnostics;
    std::string const text = dump_stage(source, stage, diagnostics);
    CHECK_FALSE(diagnostics.has_errors());
    auto const record = root / "tests/golden/dump" / ("duffing." + stage);
    if (std::getenv("SYSID_BLESS") != nullptr) write_file(record, text);
    CHECK(text == read_file(record));
  }
}
