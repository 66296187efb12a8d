// What cannot be exported is refused before anything is written, with what to do.
#include <doctest/doctest.h>

#include "exchange/exported.hpp"
#include "exchange/netcdf.hpp"
#include "report/file/stored_files.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

template <class Error, class Act>
std::string refusal(Act const& act) {
  try {
    act();
  } catch (Error const& error) {
    return error.what();
  }
  return "nothing was refused";
}

}  // namespace

TEST_CASE("an export refuses folders without draws, files that are there and results of another text") {
  auto const model = models / "regression/regression.sysid";
  ExportedRun const run(model, with(read_file(model), "samples = 6000, burn_in = 2000", "samples = 400, burn_in = 100"));
  auto const results = run.results();
  run.export_all();
  auto const require = [&](std::filesystem::path const& folder) {
    return refusal<UserError>([&] { require_exportable(find_results(folder), false); });
  };
  CHECK(require(results).ends_with("posterior/posterior.nc` exists already"));
  CHECK(require(results / "forecast").ends_with("forecast` is a prediction and is exported with its fit"));
  CHECK(require(results / "posterior/figures").ends_with("figures` contains no results"));
  CHECK(refusal<IoError>([&] { find_results(results / "nowhere"); }).starts_with("there is no folder"));

  Source const source(model.string(), with(read_file(model), "sd = 100", "sd = 101"));
  Source text = source;
  Diagnostics diagnostics;
  auto const file = load(text, diagnostics);
  REQUIRE(file);
  RunOptions options;
  options.output = results;
  SilentProgress silent;
  std::ostringstream out;
  Session session(text, *file, options, silent, out, out);
  std::string const bytes = read_file(results / "posterior/posterior.nc");
  CHECK(refusal<UserError>([&] {
          export_netcdf(find_results(results), &session, 200, out);
        }).ends_with("were computed with another text of model `deck`"));
  CHECK(read_file(results / "posterior/posterior.nc") == bytes);

  std::filesystem::rename(results / "posterior", results / "renamed");
  CHECK(refusal<UserError>([&] {
          export_netcdf(find_results(results / "renamed"), &session, 200, out);
        }).ends_with("were computed with another text of model `deck`"));
  auto older = nlohmann::ordered_json::parse(read_file(results / "renamed/summary.json"));
  older["versions"].erase("form");
  write_file(results / "renamed/summary.json", sealed_summary(older.dump(2)));
  CHECK(
      refusal<UserError>([&] { find_results(results / "renamed"); }).ends_with("renamed` was written by another version of sysid"));
  write_file(results / "renamed/summary.json", "{\"task\": 1}");
  CHECK(refusal<UserError>([&] { find_results(results / "renamed"); }).ends_with("summary.json` is not the result of a task"));
}

TEST_CASE("the same groups are the same bytes, and two variables of one name get two") {
  NetcdfGroup group("posterior");
  group.add_dimension({"draw", {}, std::vector<std::int64_t>{0, 1}, {}});
  CHECK(group.add({"draw", {"draw"}, std::vector<double>{1, 2}, {}}) == "draw_");
  CHECK(group.add({"a/b", {}, std::vector<std::string>{"word"}, {{"units", "m"}}}) == "a/b");
  CHECK_THROWS_AS(group.add({"c", {"draw"}, std::vector<double>{1}, {}}), InternalError);
  CHECK_THROWS_AS(group.add({"c", {"row"}, std::vector<double>{1}, {}}), InternalError);
  std::string const bytes = netcdf_bytes({{"model", "a"}}, {group});
  CHECK(bytes.substr(1, 3) == "HDF");
  CHECK(netcdf_bytes({{"model", "a"}}, {group}) == bytes);
}
