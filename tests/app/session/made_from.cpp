// A fit that is run again leaves its former prediction behind, and the page and the table say so.
#include "app/session/made_from.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/answer.hpp"
#include "app/comparison/compare.hpp"
#include "app/run/report_results.hpp"
#include "app/running.hpp"
#include "report/page/comparison.hpp"

using namespace sysid;
using namespace sysid::test;

TEST_CASE("a prediction of draws that have been replaced is told, and one made again is not") {
  TemporaryFolder folder;
  auto const results = folder.path() / "results";
  write_file(folder.path() / "growth.csv", content(error_examples / "data/growth.csv"));
  std::string const text =
      "model decay {\n state y\n initial y = 1\n parameter k ~ log_uniform(0.1, 10)\n y' = -k*y\n observe size ~ normal(y, sd = "
      "0.1)\n}\n"
      "data dish { file \"growth.csv\"; time t [s]; measure size = y }\n"
      "posterior = fit decay to dish with mh(samples = 200, burn_in = 50, thin = 1, chains = 2)\n"
      "forecast = predict posterior on dish with draws(10), seed = 1\n";
  auto const run = [&](std::vector<std::string> const& verbs, std::uint64_t seed) {
    RunOptions options;
    options.output = results;
    options.force = true;
    options.seed = seed;
    run_text(folder.path() / "dish.sysid", text, options, verbs);
  };
  auto const told = [&] {
    bool const finding = made_from_earlier(results / "forecast").has_value();
    CHECK((content(report_results(results / "forecast", std::nullopt, false)).find("made_from_earlier") != std::string::npos) ==
          finding);
    std::string const compared = comparison_text(compare({results}));
    CHECK((compared.find("an earlier run of `posterior`") != std::string::npos) == finding);
    auto const written = nlohmann::json::parse(read_file(results / "forecast/summary.json")).at("findings");
    auto const warnings =
        std::count_if(written.begin(), written.end(), [](auto const& each) { return each["severity"] == "warning"; });
    CHECK(compare({results}).predictions.front().warnings == warnings + (finding ? 1 : 0));
    return finding;
  };
  run({"fit", "predict"}, 1);
  CHECK_FALSE(told());
  run({"fit"}, 1);  // the same again
  CHECK_FALSE(told());
  run({"fit"}, 2);
  CHECK(told());
  run({"predict"}, 2);
  CHECK_FALSE(told());
  std::filesystem::remove_all(results / "posterior");
  CHECK_FALSE(made_from_earlier(results / "forecast").has_value());
}
