// `select` from end to end on the Bouc-Wen case, shortened: the right law, the same bytes for any threads, lanes and interruptions,
// and predictions from what it leaves on disk.
#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "app/comparison/compare.hpp"
#include "app/running.hpp"
#include "relative.hpp"

using namespace sysid;
using json = nlohmann::json;

namespace {

std::filesystem::path const bouc_wen_file = std::filesystem::path(SYSID_SOURCE_DIR) / "models/bouc_wen/bouc_wen.sysid";

/// Three of the five candidates, few particles, a threshold that is soon reached.
std::string shortened_selection() {
  std::string text = with(read_file(bouc_wen_file), "bouc_wen(n = 1..4)", "bouc_wen(n = 1..2)");
  return with(text, "particles = 1000, quantile = 0.2, polish = yes", "particles = 200, target = 2");
}

std::map<std::string, std::string> selection_files(std::filesystem::path const& folder) {
  std::map<std::string, std::string> files;
  for (auto const& entry : std::filesystem::recursive_directory_iterator(folder)) {
    std::string const name = entry.path().filename().string();
    if (name.ends_with(".csv") || name == "summary.json")
      files[std::filesystem::relative(entry.path(), folder).string()] = read_file(entry.path());
  }
  return files;
}

std::map<std::string, std::string> files_of_selection(RunOptions options,
                                                      std::vector<std::string> const& verbs = {"select", "predict"}) {
  TemporaryFolder folder;
  options.output = folder.path() / "results";
  run_text(bouc_wen_file, shortened_selection(), options, verbs);
  return selection_files(options.output);
}

std::map<std::string, std::string> const& reference_selection() {
  static std::map<std::string, std::string> const files = files_of_selection({});
  return files;
}

}  // namespace

TEST_CASE("a selection leaves its populations, the particles of each model under its name, and a summary by model") {
  REQUIRE(reference_selection().contains("selection/populations.csv"));
  CHECK(reference_selection().contains("selection/particles_bouc_wen(n=2).csv"));
  CHECK(reference_selection().contains("selection/draws_bouc_wen(n=2).csv"));
  CHECK(reference_selection().contains("forecast/predict.csv"));
  json const summary = json::parse(reference_selection().at("selection/summary.json"));
  REQUIRE(summary.at("models").size() == 3);
  double total = 0;
  for (auto const& [name, entry] : summary.at("models").items()) {
    total += entry.at("probability").get<double>();
    CHECK(entry.contains("share"));
    CHECK(entry.contains("died_in_population"));
    CHECK(entry.at("prior") == doctest::Approx(1.0 / 3));
    CHECK(entry.contains("laplace"));
  }
  CHECK(total == doctest::Approx(1));
  // The noise is no parameter of a simulation without noise.
  json const& law = summary.at("models").at("bouc_wen(n = 2)");
  CHECK(law.at("parameters").size() == 5);
  CHECK_FALSE(law.at("parameters").contains("sigma"));
  CHECK(law.at("laplace").at("probability").get<double>() > 0.99);
  CHECK(summary.at("populations").at("threshold") == 2);
}

TEST_CASE("threads, lanes and a second run change no byte of a selection") {
  for (auto const& [lanes, threads] : {std::pair{0, 1}, {0, 3}, {4, 1}, {64, 2}}) {
    CAPTURE(lanes);
    CAPTURE(threads);
    RunOptions options;
    options.execution = {lanes, threads};
    CHECK(files_of_selection(options) == reference_selection());
  }
}

TEST_CASE("a selection interrupted again and again ends with the bytes of an unbroken one") {
  TemporaryFolder folder;
  RunOptions options;
  options.output = folder.path() / "results";
  int interruptions = 0;
  for (std::uint64_t const after : {1, 3, 5, 9}) {
    options.interrupt_after = after;
    options.resume = interruptions > 0;
    if (run_text(bouc_wen_file, shortened_selection(), options, {"select", "predict"}).exit != 75) break;
    clear_interrupt();
    ++interruptions;
  }
  CHECK(interruptions > 1);
  options.interrupt_after = 0;
  options.resume = true;
  CHECK(run_text(bouc_wen_file, shortened_selection(), options, {"select", "predict"}).exit != 75);
  CHECK(selection_files(options.output) == reference_selection());
}

TEST_CASE("a selection interrupted while it polishes is not a finished one") {
  std::string const text = with(shortened_selection(), "target = 2", "target = 2, polish = yes, polish_samples = 2000");
  auto const run = [&](std::filesystem::path const& folder, std::uint64_t after, bool resume) {
    RunOptions options;
    options.output = folder;
    options.interrupt_after = after;
    options.resume = resume;
    int const exit = run_text(bouc_wen_file, text, options, {"select"}).exit;
    clear_interrupt();
    return exit;
  };
  TemporaryFolder whole, folder;
  std::uint64_t const populations = [] {
    json const summary = json::parse(reference_selection().at("selection/summary.json"));
    return summary.at("populations").at("count").get<std::uint64_t>();
  }();
  CHECK(run(whole.path() / "results", 0, false) != 75);
  // The chains poll at every batch of their iterations: many times more often than populations are made.
  REQUIRE(run(folder.path() / "results", 60 * populations, false) == 75);
  json const summary = json::parse(read_file(folder.path() / "results/selection/summary.json"));
  CHECK(summary.at("populations").at("threshold") == 2);
  CHECK(run(folder.path() / "results", 0, true) != 75);
  CHECK(selection_files(folder.path() / "results") == selection_files(whole.path() / "results"));
}

TEST_CASE("what a selection searches and samples by the likelihood is not done again after each of many interruptions") {
  std::string const text = with(shortened_selection(), "target = 2", "target = 2, polish = yes, polish_samples = 2000");
  TemporaryFolder folder;
  RunOptions options;
  auto const run = [&] {
    int const exit = run_text(bouc_wen_file, text, options, {"select"}).exit;
    clear_interrupt();
    return exit;
  };
  options.output = folder.path() / "whole";
  CHECK(run() != 75);
  options.output = folder.path() / "results";
  options.checkpoint_interval = 0;
  options.interrupt_after = 150;  // far less than its chains ask
  int interruptions = 0;
  while (interruptions < 300 && run() == 75) {
    options.resume = true;
    ++interruptions;
  }
  CHECK(interruptions > 3);
  CHECK(interruptions < 300);
  CHECK(selection_files(options.output) == selection_files(folder.path() / "whole"));
  CHECK_FALSE(std::filesystem::exists(options.output / "selection/checkpoint.cbor"));
}

TEST_CASE("a prediction from stored particles is the one that follows the selection at once") {
  TemporaryFolder folder;
  RunOptions options;
  options.output = folder.path() / "results";
  run_text(bouc_wen_file, shortened_selection(), options, {"select"});
  try {
    compare({options.output});
    FAIL("a selection was compared");
  } catch (UserError const& error) {
    CHECK(error.diagnostic().message ==
          "`" + options.output.string() + "` contains the selection `selection`, but no result of a fit or a prediction");
  }
  run_text(bouc_wen_file, shortened_selection(), options, {"predict"});
  CHECK(selection_files(options.output) == reference_selection());
  // Of another text of one candidate they are refused, whichever leads.
  std::string const other = with(shortened_selection(), "~ uniform(2, 200)", "~ uniform(3, 200)");
  options.force = true;
  CHECK_THROWS_AS(run_text(bouc_wen_file, other, options, {"predict"}), UserError);
}

TEST_CASE("a distance of one's own, and one by root mean squares, select the same law") {
  for (std::string const distance : {"distance = rmse", "distance = abs(residual(displacement))"}) {
    CAPTURE(distance);
    std::string const text = with(with(shortened_selection(), "target = 2)", "target = 2e-5)"), ", seed = 1\nforecast",
                                  ", " + distance + ", seed = 1\nforecast");
    TemporaryFolder folder;
    RunOptions options;
    options.output = folder.path() / "results";
    run_text(bouc_wen_file, text, options, {"select"});
    json const summary = json::parse(read_file(options.output / "selection/summary.json"));
    CHECK(summary.at("populations").at("threshold").get<double>() == relative(2e-5, 1e-12));
    CHECK(summary.at("models").at("bouc_wen(n = 2)").at("probability").get<double>() > 0);
  }
}
