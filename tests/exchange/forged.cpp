// Folders of results that somebody has changed: exported or refused with a word about it, never an error of the program, and never
// anything but what was written.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <set>

#include "app/comparison/compare.hpp"
#include "app/run/report_results.hpp"
#include "core/system/digest.hpp"
#include "exchange/exported.hpp"
#include "report/file/stored_files.hpp"

using namespace sysid;
using namespace sysid::testing;
using Json = nlohmann::ordered_json;

namespace {

namespace fs = std::filesystem;

/// What an act has said: empty where it went through. Anything but a refusal of the user's files ends the test.
std::string said_of(std::function<void()> const& act) {
  try {
    act();
  } catch (UserError const& error) {
    return error.diagnostic().message;
  } catch (IoError const& error) {
    return error.what();
  }
  return {};
}

std::string exported(fs::path const& folder) {
  return said_of([&] {
    ResultsFolder const found = find_results(folder);
    require_exportable(found, true);
    std::ostringstream out;
    export_netcdf(found, nullptr, 0, out);
  });
}
std::string compared(fs::path const& folder) {
  return said_of([&] { (void)comparison_text(compare({folder})); });
}

ExportedRun short_fit() {
  auto const model = models / "regression/regression.sysid";
  return ExportedRun(model, with(read_file(model), "samples = 6000, burn_in = 2000", "samples = 150, burn_in = 100"));
}

void seal(fs::path const& folder, Json summary) {
  summary["versions"]["summary_sha256"] = unsealed();
  write_file(folder / "summary.json", sealed_summary(summary.dump(2) + "\n"));
}

std::set<std::string> names_in(fs::path const& folder) {
  std::set<std::string> names;
  for (auto const& entry : fs::recursive_directory_iterator(folder)) names.insert(entry.path().string());
  return names;
}

/// What a member can be replaced by.
std::vector<Json> replacements() {
  return {nullptr,
          true,
          3,
          -1e300,
          "",
          "word",
          "../../up",
          std::string("a\0b", 3),
          Json::array(),
          Json::array({1}),
          Json::object(),
          {{"a", 1}},
          std::string(1000, 'x')};
}

}  // namespace

TEST_CASE("numbers that were changed, files that are not there and other versions are named by export and compare") {
  ExportedRun const run = short_fit();
  fs::path const fit = run.results() / "posterior", chain = fit / "draws_1.csv", summary = fit / "summary.json";
  REQUIRE(exported(fit).empty());
  REQUIRE(compared(fit).empty());
  std::string const draws = read_file(chain), text = read_file(summary), bytes = read_file(fit / "posterior.nc");
  auto const both = [&](std::string const& expected) {
    for (std::string const& said : {exported(fit), compared(fit)})
      CHECK_MESSAGE(said.find(expected) != std::string::npos, expected << " in: " << said);
    CHECK(read_file(fit / "posterior.nc") == bytes);
    write_file(chain, draws);
    write_file(summary, text);
  };
  std::string changed = draws;
  changed[changed.find_last_of("012345678")]++;
  write_file(chain, changed);
  both("draws_1.csv` has been changed since it was written");
  fs::remove(chain);
  both("draws_1.csv`, a file of this result, is missing");
  write_file(fit / "draws_9.csv", draws);
  both("draws_9.csv` does not belong to the result in its folder");
  fs::remove(fit / "draws_9.csv");
  changed = text;
  changed[changed.find("\"mean\": ") + 8]++;
  write_file(summary, changed);
  both("summary.json` has been changed since it was written");
  write_file(summary, text.substr(0, text.size() / 2));
  both("posterior");
  write_file(summary, "");
  both("posterior");
  Json other = Json::parse(text);
  other["versions"]["form"] = 99;
  seal(fit, other);
  both("was written by another version of sysid");
  // A file that was changed with its digest is a table, or is none.
  write_file(chain, draws.substr(0, draws.size() / 2));
  other = Json::parse(text);
  other["versions"]["files"]["draws_1.csv"] = sha256(read_file(chain));
  seal(fit, other);
  CHECK(exported(fit).find("draws_1.csv` is damaged") != std::string::npos);
}

TEST_CASE("whatever a sealed summary holds, export, compare and report read it or say that it is damaged") {
  ExportedRun const run = short_fit();
  TemporaryFolder page;
  for (char const* task : {"posterior", "forecast"}) {
    fs::path const folder = run.results() / task;
    std::string const text = read_file(folder / "summary.json");
    Json const original = Json::parse(text);
    exported(folder);
    auto const names = names_in(run.results());
    std::vector<Json> const values = replacements();
    std::size_t next = 0, refused = 0;
    std::vector<std::string> pointers;
    Json const flat = original.flatten();
    for (auto const& [pointer, value] : flat.items())
      for (std::string part = pointer; !part.empty(); part.resize(part.rfind('/')))
        if (std::find(pointers.begin(), pointers.end(), part) == pointers.end()) pointers.push_back(part);
    REQUIRE(pointers.size() > 40);
    for (std::string const& pointer : pointers) {
      for (int k = 0; k < 1; ++k) {
        Json forged = original;
        forged[Json::json_pointer(pointer)] = values[next++ % values.size()];
        if (!forged.is_object() || !forged.contains("versions") || !forged["versions"].is_object()) continue;
        CAPTURE(pointer);
        CAPTURE(forged[Json::json_pointer(pointer)].dump());
        seal(folder, forged);
        refused += exported(folder).empty() ? 0 : 1;
        refused += compared(folder).empty() ? 0 : 1;
        said_of([&] { report_results(folder, page.path() / "page.html", false); });
        for (std::string const& name : names_in(run.results()))
          if (!names.contains(name)) {
            CHECK(fs::path(name).parent_path() == folder);  // named after the task
            fs::remove(name);
          }
      }
    }
    CHECK(refused > 20);
    write_file(folder / "summary.json", text);
  }
}

TEST_CASE("names that no file or variable can have are refused") {
  ExportedRun const run = short_fit();
  fs::path const fit = run.results() / "posterior";
  Json const original = Json::parse(read_file(fit / "summary.json"));
  for (std::string const& task : {std::string("../escaped"), std::string("a/b"), std::string(".hidden"), std::string("a\0b", 3)}) {
    Json forged = original;
    forged["task"] = task;
    seal(fit, forged);
    CHECK(exported(fit).find("summary.json` is damaged") != std::string::npos);
  }
  CHECK_FALSE(fs::exists(run.results() / "escaped.nc"));
  std::string const draws = read_file(fit / "draws_1.csv");
  std::string const first = original.at("parameters").begin().key();
  for (std::string const& name : {std::string(300, 'n'), std::string(" "), std::string("tab\there")}) {
    CAPTURE(name);
    Json forged = original;
    Json parameters = Json::object();
    for (auto const& [key, value] : original.at("parameters").items()) parameters[key == first ? name : key] = value;
    forged["parameters"] = parameters;
    for (auto const& [file, digest] : original.at("versions").at("files").items()) {
      if (!file.starts_with("draws_")) continue;
      std::string table = read_file(fit / file);
      if (std::size_t const place = table.find("," + first + ","); place != table.npos)
        table.replace(place, first.size() + 2, ",\"" + name + "\",");
      write_file(fit / file, table);
      forged["versions"]["files"][file] = sha256(table);
    }
    seal(fit, forged);
    CHECK_FALSE(exported(fit).empty());
    for (auto const& [file, digest] : original.at("versions").at("files").items()) {
      std::string table = read_file(fit / file);
      if (std::size_t const place = table.find(",\"" + name + "\","); place != table.npos)
        table.replace(place, name.size() + 4, "," + first + ",");
      write_file(fit / file, table);
    }
  }
}

TEST_CASE("the model of results is read where they name a model, and no other file") {
  ExportedRun const run = short_fit();
  fs::path const fit = run.results() / "posterior";
  CHECK(find_results(fit).file.string().ends_with("regression.sysid"));
  for (char const* other : {"/etc/passwd", "/dev/zero", "notes.txt"}) {
    Json timing = Json::parse(read_file(fit / "timing.json"));
    timing["file"] = other;
    write_file(fit / "timing.json", timing.dump());
    CHECK(find_results(fit).file.empty());
  }
}
