// Records that `simulate` writes.
#include <doctest/doctest.h>
#include <signal.h>
#include <sys/resource.h>

#include <cmath>
#include <set>
#include <vector>

#include "app/running.hpp"
#include "app/task/signals.hpp"

using namespace sysid;

TEST_CASE("an input and a channel of one name have columns of two names") {
  TemporaryFolder folder;
  RunOptions options;
  options.output = folder.path() / "results";
  run_text(folder.path() / "lag.sysid", R"(
model lag { input x; state s; initial s = 0; parameter tau [s] ~ log_uniform(0.1, 10); tau*s' = x - s; observe x ~ normal(s, sd = 0.1) }
truth = simulate lag with values(tau = 1), input x = gaussian(sd = 1), samples = 5, rate = 10 [Hz], seed = 1, file = "lag.csv"
)",
           options);
  std::string const text = read_file(options.output / "truth/lag.csv");
  CHECK(text.find("\nt,x_input,x,x_clean\n") != std::string::npos);
  CHECK(text.find("# column x_input") != std::string::npos);
  CHECK(text.find("# column x: measured; x_clean: without noise") != std::string::npos);
}

TEST_CASE("a multisine of one harmonic on both limits of its band is that sine") {
  InputGenerator const generator{
      InputGenerator::Kind::multisine, {{"sd", 1.0}, {"lowest", 0.3}, {"highest", 0.3}, {"mean", 0.0}}, InputRule::band_limited};
  std::vector<double> const values = generate(generator, 1000, 0.01, {1, Purpose::input, 0, 0});
  REQUIRE(values.size() == 1000);
  // Samples of cos(a), cos(a + b), cos(a + 2 b): the middle one times 2 cos b is the sum of the others.
  double const factor = 2 * std::cos(2 * 3.14159265358979324 * 0.3 * 0.01);
  for (std::size_t i = 1; i + 1 < values.size(); ++i) CHECK(std::fabs(values[i - 1] + values[i + 1] - factor * values[i]) < 1e-9);
  double squares = 0;
  for (double const value : values) squares += value * value;
  CHECK(squares / 1000 == doctest::Approx(1));
}

TEST_CASE("a forced simulation that finds the disk full leaves the results of before, one that is written replaces them") {
  TemporaryFolder folder;
  RunOptions options;
  options.output = folder.path() / "results";
  std::string const text = R"(
model lag { input x; state s; initial s = 0; parameter tau [s] ~ log_uniform(0.1, 10)
  tau*s' = x - s; observe y ~ normal(s, sd = 0.1) }
truth = simulate lag with values(tau = 1), input x = gaussian(sd = 1), samples = 5, rate = 10 [Hz], seed = 1,
  file = "predict.csv"
)";
  run_text(folder.path() / "lag.sysid", text, options);
  std::filesystem::path const record = options.output / "truth/predict.csv", other = options.output / "truth/draws_1.csv";
  std::string const whole = read_file(record);
  write_file(other, "of another task");
  options.force = true;
  // A limit on the size of files stands in for the full disk.
  auto const before_signal = ::signal(SIGXFSZ, SIG_IGN);
  rlimit before = {};
  REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
  rlimit little = before;
  little.rlim_cur = 10;
  REQUIRE(::setrlimit(RLIMIT_FSIZE, &little) == 0);
  bool refused = false;
  try {
    run_text(folder.path() / "lag.sysid", text, options);
  } catch (IoError const&) {
    refused = true;
  }
  REQUIRE(::setrlimit(RLIMIT_FSIZE, &before) == 0);
  ::signal(SIGXFSZ, before_signal);
  CHECK(refused);
  REQUIRE(std::filesystem::exists(record));
  CHECK(read_file(record) == whole);
  CHECK(std::filesystem::exists(other));
  run_text(folder.path() / "lag.sysid", text, options);
  CHECK(read_file(record) == whole);
  CHECK_FALSE(std::filesystem::exists(other));
}

namespace {

std::filesystem::path const models = std::filesystem::path(SYSID_SOURCE_DIR) / "models";

std::vector<std::filesystem::path> shipped(std::string const& extension) {
  std::vector<std::filesystem::path> files;
  for (auto const& entry : std::filesystem::recursive_directory_iterator(models))
    if (entry.path().extension() == extension) files.push_back(entry.path());
  return files;
}

// Records that the simulations of a text write, each against the shipped one of its name in `folder`; those that are the same.
std::set<std::filesystem::path> made_again(std::filesystem::path const& folder, std::string const& text) {
  TemporaryFolder results;
  RunOptions options;
  options.output = results.path() / "results";
  run_text(folder / "again.sysid", text, options, {"simulate"});
  std::set<std::filesystem::path> same;
  for (auto const& entry : std::filesystem::recursive_directory_iterator(options.output)) {
    if (entry.path().extension() != ".csv") continue;
    std::filesystem::path const record = folder / entry.path().filename();
    CAPTURE(record.string());
    if (!std::filesystem::exists(record)) continue;  // of which a part is shipped
    bool const equal = read_file(entry.path()) == read_file(record);
    CHECK(equal);
    if (equal) same.insert(record);
  }
  return same;
}

}  // namespace

TEST_CASE("every shipped record that says it was simulated comes out again, byte for byte") {
  std::set<std::filesystem::path> same;
  for (std::filesystem::path const& file : shipped(".sysid")) {
    std::string const text = read_file(file);
    if (text.find("= simulate ") != std::string::npos) same.merge(made_again(file.parent_path(), text));
  }
  // The one whose task stands in its page.
  std::filesystem::path const folder = models / "autoregression";
  std::string const page = read_file(folder / "README.md"), model = read_file(folder / "autoregression.sysid");
  std::size_t const begin = page.find("made = simulate"), end = page.find('\'', begin);
  REQUIRE(end != std::string::npos);
  same.merge(made_again(folder, model.substr(0, model.find("\ndata")) + "\n" + page.substr(begin, end - begin) + "\n"));
  int count = 0;
  for (std::filesystem::path const& file : shipped(".csv")) {
    if (!read_file(file).starts_with("# made by sysid")) continue;
    CAPTURE(file.string());
    CHECK(same.contains(file));
    ++count;
  }
  CHECK(count >= 13);
}
