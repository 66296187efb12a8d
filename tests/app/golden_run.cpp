// Every shipped model runs to its recorded summary: numbers to 1e-6 of their size (the seed fixes the bytes, but special functions
// may differ in the last digits between processors), words exactly. Its pages can be made anew, and the documentation quotes what
// it prints. SYSID_BLESS=1 rewrites the record.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "app/running.hpp"
#include "app/stored_pages.hpp"
#include "house/quoted_output.hpp"

using namespace sysid;
using json = nlohmann::json;

namespace {

std::filesystem::path const shipped_models = std::filesystem::path(SYSID_SOURCE_DIR) / "models";
std::filesystem::path const golden_runs = std::filesystem::path(SYSID_SOURCE_DIR) / "tests/golden/run";

// Where two summaries differ, as "posterior.parameters.m.mean"; empty when nowhere.
std::string difference(json const& expected, json const& found, std::string const& path) {
  if (expected.is_number() && found.is_number()) {
    double const a = expected.get<double>(), b = found.get<double>();
    return std::abs(a - b) <= 1e-6 * std::max(std::abs(a), std::abs(b)) + 1e-12
               ? ""
               : path + ": " + expected.dump() + " and " + found.dump();
  }
  if (expected.type() != found.type()) return path;
  if (expected.is_object() || expected.is_array()) {
    if (expected.size() != found.size()) return path;
    if (expected.is_array()) {
      for (std::size_t i = 0; i < expected.size(); ++i)
        if (std::string const d = difference(expected[i], found[i], path + "[" + std::to_string(i) + "]"); !d.empty()) return d;
      return "";
    }
    for (auto const& [key, value] : expected.items()) {
      if (!found.contains(key)) return path + "." + key;
      if (std::string const d = difference(value, found.at(key), path + "." + key); !d.empty()) return d;
    }
    return "";
  }
  return expected == found ? "" : path + ": " + expected.dump() + " and " + found.dump();
}

}  // namespace

TEST_CASE("every shipped model runs to its recorded summary and exit code") {
  bool const bless = std::getenv("SYSID_BLESS") != nullptr;
  int count = 0;
  for (auto const& entry : std::filesystem::recursive_directory_iterator(shipped_models)) {
    if (entry.path().extension() != ".sysid") continue;
    ++count;
    // The build runs each model as a test of its own, by the name of this subcase.
    std::string const model_name = entry.path().parent_path().filename().string() + "/" + entry.path().stem().string();
    SUBCASE(model_name.c_str()) {
      CAPTURE(entry.path().string());
      TemporaryFolder folder;
      RunOptions options;
      options.output = folder.path() / "results";
      options.execution.threads = 0;
      RunResult const result = run_text(entry.path(), read_file(entry.path()), options);
      testing::check_quotes("./sysid run models/" + model_name + ".sysid", result.out);
      json found = {{"exit", result.exit}};
      CHECK(test::broken_promises(options.output) == "");
      for (auto const& task : std::filesystem::directory_iterator(options.output)) {
        if (!std::filesystem::exists(task.path() / "summary.json")) continue;
        found[task.path().filename().string()] = json::parse(read_file(task.path() / "summary.json"));
      }
      // The version is a banner; paths in messages are those of this checkout.
      std::string text = without(found.dump(1), shipped_models.string() + "/");
      found = json::parse(text);
      for (auto& [name, summary] : found.items())
        if (summary.is_object())
          for (char const* key : {"versions", "kept_draws"}) summary.erase(key);  // these are summaries once more, of fewer draws
      auto const record =
          golden_runs / (entry.path().parent_path().filename().string() + "_" + entry.path().stem().string() + ".json");
      if (bless) write_file(record, found.dump(1) + "\n");
      REQUIRE(std::filesystem::exists(record));
      std::string const where = difference(json::parse(read_file(record)), found, "");
      CHECK(where == "");
    }
  }
  CHECK(count >= 4);
}
