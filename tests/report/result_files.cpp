// The names of the files of a result: what is written is known, sealed where it is read back, and goes with its result.
#include "report/file/result_files.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "core/system/files.hpp"
#include "core/text/diagnostic.hpp"
#include "example.hpp"
#include "report/file/standing_files.hpp"
#include "report/file/stored_files.hpp"
#include "report/file/task_folder.hpp"
#include "temporary_folder.hpp"

using namespace sysid;
namespace fs = std::filesystem;

TEST_CASE("every file that a result is written to has a row, and the summary seals those that are read back") {
  TemporaryFolder const folder;
  write_result(example::duffing(20), folder.path(), {});
  auto const sealed = nlohmann::json::parse(read_file(folder.path() / "summary.json")).at("versions").at("files");
  int files = 0;
  for (fs::directory_entry const& entry : fs::directory_iterator(folder.path())) {
    if (entry.is_directory()) continue;
    std::string const name = entry.path().filename();
    CAPTURE(name);
    ResultFileRow const* const row = result_file_row(name);
    REQUIRE(row != nullptr);
    CHECK(row->sealed == sealed.contains(name));
    ++files;
  }
  CHECK(files >= 8);
}

TEST_CASE("a file of every row is removed with its result, others stay") {
  TemporaryFolder const root;
  fs::path const folder = root.path() / "post";
  make_folder(folder);
  auto const removed = [&](std::string const& name) {
    write_file(folder / name, "");
    remove_result(folder);
    bool const gone = !fs::exists(folder / name);
    if (!gone) remove_file(folder / name);
    return gone;
  };
  for (ResultFileRow const& row : result_file_rows()) {
    std::string name(row.name);
    if (auto const star = name.find('*'); star != name.npos) name.replace(star, 1, "bench.train");
    CAPTURE(name);
    CHECK(removed(name));
  }
  for (char const* name : {"post.nc", "post_osc(n=2).nc", "post.stan", "post.data.json"}) CHECK_MESSAGE(removed(name), name);
  for (char const* name : {"notes.txt", "draws.csv", "draws_1.txt", "other.nc", "post_a.stan", "predict"})
    CHECK_MESSAGE(!removed(name), name);
  // A folder is the user's, whatever its name.
  fs::create_directory(folder / "predict_x.csv");
  remove_result(folder);
  CHECK(fs::is_directory(folder / "predict_x.csv"));
  CHECK_FALSE(holds_result(folder));
}

TEST_CASE("a name that no row has is our own mistake") {
  CHECK(known_result_file("draws_3.csv") == "draws_3.csv");
  CHECK_THROWS_AS(known_result_file("draws.csv"), InternalError);
  CHECK(exported_file("post", ".nc") == "post.nc");
  CHECK(exported_file("post", ".nc", "law") == "post_law.nc");
  CHECK_THROWS_AS(exported_file("post", ".mat"), InternalError);
  CHECK_THROWS_AS(exported_file("post", ".stan", "law"), InternalError);
}
