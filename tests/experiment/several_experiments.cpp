// A fit to several experiments as a user sees it: names in every file, the same bytes however it is run, predictions of fitted and
// of new experiments.
#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "app/running.hpp"
#include "core/numeric/random.hpp"
#include "core/text/number.hpp"

using namespace sysid;
using json = nlohmann::json;

namespace {

// Levels that drift with a shared rate, a start of their own, and a second channel that only the first experiment measures.
std::string const fleet_text = R"(
model drift {
  input x
  state y
  initial y = start
  parameter rate ~ normal(0, sd = 2)
  parameter mean ~ normal(0, sd = 2)
  parameter start per experiment ~ normal(mean, sd = 1)
  parameter gain per experiment = 1
  y' = gain*rate*x
  observe level ~ normal(y, sd = 0.2)
  observe double ~ normal(2*y, sd = 0.5)
  derive speed = gain*rate
}
data one { file "one.csv"; time t [s]; input x = x hold zero_order; measure level = y; measure double = z
           split early = rows 1..40, late = rows 41..60 }
data two { file "two.csv"; time t [s]; input x = x hold zero_order; measure level = y; constant gain = 0.5 }
data new { file "two.csv"; time t [s]; input x = x hold zero_order; measure level = y; constant gain = 3 }
posterior = fit drift to one.early, two with mh(samples = 3000, burn_in = 1000, thin = 5, chains = 4), seed = 4
forecast  = predict posterior on one.late, two, new with draws(50), seed = 5
shuffled  = predict posterior on new, two with draws(40), redraw = step, seed = 6
)";

std::string made_record(double gain, double start, int rows, std::uint64_t seed) {
  std::string csv = "t,x,y,z\n";
  Stream stream({seed, Purpose::test, 0, 0});
  double level = start;
  for (int i = 0; i < rows; ++i) {
    double const x = stream.normal();
    csv += shortest(0.1 * i) + "," + shortest(x) + "," + shortest(level + 0.2 * stream.normal()) + "," +
           shortest(2 * level + 0.5 * stream.normal()) + "\n";
    level += 0.1 * gain * 1.5 * x;
  }
  return csv;
}

struct Folder {
  TemporaryFolder folder;
  RunOptions options;

  Folder() {
    write_file(folder.path() / "one.csv", made_record(1, 0.7, 60, 31));
    write_file(folder.path() / "two.csv", made_record(0.5, -0.4, 50, 32));
    options.output = folder.path() / "results";
  }
  RunResult run(std::vector<std::string> const& verbs = {}) {
    return run_text(folder.path() / "case.sysid", fleet_text, options, verbs);
  }
  std::string file(std::string const& name) const { return read_file(options.output / name); }
  json summary(std::string const& task) const { return json::parse(file(task + "/summary.json")); }
  std::map<std::string, std::string> promised() const {
    std::map<std::string, std::string> files;
    for (auto const& entry : std::filesystem::recursive_directory_iterator(options.output)) {
      std::string const name = entry.path().filename().string();
      if (name.starts_with("draws_") || name == "summary.json" || name.starts_with("predict"))
        files[std::filesystem::relative(entry.path(), options.output).string()] = read_file(entry.path());
    }
    return files;
  }
};

std::map<std::string, std::string> const& reference() {
  static std::map<std::string, std::string> const files = [] {
    Folder folder;
    folder.run();
    return folder.promised();
  }();
  return files;
}

}  // namespace

TEST_CASE("experiments are named in parameters, scores, data, draws and predictions") {
  Folder folder;
  RunResult const result = folder.run();
  json const posterior = folder.summary("posterior");
  std::set<std::string> names;
  for (auto const& [name, value] : posterior["parameters"].items()) names.insert(name);
  CHECK(names == std::set<std::string>{"rate", "mean", "start[one]", "start[two]", "speed[one]", "speed[two]"});
  CHECK(posterior["what"] == "fit drift to one.early, two with mh");
  CHECK(posterior["data"][0]["name"] == "one.early");
  CHECK(posterior["data"][1]["notes"].back() == "gain = 0.5");
  auto const& scores = posterior["fit"]["channels"];
  CHECK(scores["one.early"]["double"].contains("chi_squared_per_sample"));
  CHECK(scores["two"]["level"].contains("coverage_95"));
  CHECK_FALSE(scores["two"].contains("double"));
  CHECK_FALSE(posterior["fit"].contains("nmse"));
  CHECK(folder.file("posterior/draws_1.csv").find("__,rate,mean,start.one,start.two,speed.one,speed.two\n") != std::string::npos);
  for (char const* file : {"posterior/predict_one_early.csv", "posterior/predict_two.csv", "forecast/predict_one_late.csv",
                           "forecast/predict_new.csv", "shuffled/predict_two.csv"})
    CHECK_MESSAGE(reference().contains(file), file);
  CHECK(result.out.find("\nlevel on two: nmse") != std::string::npos);
  std::string const resolved = folder.file("posterior/resolved.sysid");
  CHECK(resolved.find("fit drift to one.early, two with mh") != std::string::npos);
  CHECK(resolved.find("constant gain = 0.5") != std::string::npos);
}

TEST_CASE("a fitted experiment is predicted with its own parameters, a new one from its constants and the population") {
  Folder folder;
  folder.run();
  json const forecast = folder.summary("forecast");
  std::string codes;
  std::vector<std::string> messages;
  for (json const& each : forecast["findings"]) {
    codes += std::string(each["code"]) + " ";
    messages.push_back(each["message"]);
  }
  // It is given a gain of 3 where the record was made with 0.5.
  REQUIRE(codes == "fitted_rows_predicted new_experiment fitted_rows_predicted worse_than_the_mean ");
  CHECK(messages[1] == "`new` was not fitted: `start` is drawn from the prior given the shared parameters");
  // The second record's level is known where it was fitted; the new one's start has the population's sd of 1 at least.
  auto const first_band = [&](std::string const& file) {
    std::string const csv = folder.file("forecast/" + file);
    std::vector<std::string> lines;
    std::istringstream stream(csv);
    for (std::string line; std::getline(stream, line);)
      if (!line.starts_with('#')) lines.push_back(line);
    std::vector<std::string> header, row;
    auto const cells = [](std::string const& line) {
      std::vector<std::string> out;
      std::istringstream parts(line);
      for (std::string cell; std::getline(parts, cell, ',');) out.push_back(cell);
      return out;
    };
    header = cells(lines[0]);
    row = cells(lines[1]);
    return std::stod(row[static_cast<std::size_t>(std::find(header.begin(), header.end(), "level_sd") - header.begin())]);
  };
  CHECK(first_band("predict_two.csv") < 0.1);
  CHECK(first_band("predict_new.csv") > 0.7);
}

TEST_CASE("predictions from stored draws are those of the run that fitted") {
  Folder folder;
  folder.run({"fit"});
  folder.run({"predict"});
  CHECK(folder.promised() == reference());
}

TEST_CASE("threads and lanes change no byte of a fit to several experiments") {
  for (ExecutionOptions const& execution : {ExecutionOptions{0, 2}, {4, 8}, {1, 1}}) {
    Folder folder;
    folder.options.execution = execution;
    folder.run();
    CHECK(folder.promised() == reference());
  }
}

TEST_CASE("an interrupted fit to several experiments resumes to the bytes of an unbroken one") {
  Folder folder;
  int interruptions = 0;
  for (std::uint64_t const polls : {200u, 30u}) {
    folder.options.interrupt_after = polls;
    interruptions += folder.run().exit == 75;
    clear_interrupt();
    folder.options.resume = true;
  }
  CHECK(interruptions == 2);
  folder.options.interrupt_after = 0;
  folder.run();
  CHECK(folder.promised() == reference());
}
