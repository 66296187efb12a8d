// `select ... with reversible_jump` from end to end: oscillators whose evidences fits know, terms as arguments of 0 or 1, the same
// bytes for any threads, lanes and interruptions, predictions from what it leaves on disk, and what is refused.
#include <doctest/doctest.h>

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "app/answer.hpp"
#include "app/running.hpp"
#include "core/numeric/random.hpp"
#include "core/text/diagnostic.hpp"

using namespace sysid;
using json = nlohmann::json;

namespace {

/// 150 samples of a hardening oscillator under a held random force, noise half as large as the motion: no candidate is certain.
void write_record(std::filesystem::path const& path) {
  constexpr double m = 1, c = 20, k = 1e4, k3 = 5e9, step = 1e-4, noise = 2.2e-4;
  Stream stream({.seed = 5, .purpose = Purpose::test, .index = 0, .step = 0});
  std::ofstream file(path);
  file.precision(12);
  file << "force,y\n";
  double y = 0, v = 0;
  for (int i = 0; i < 150; ++i) {
    double const force = 10 * stream.normal();
    file << force << "," << 1e3 * (y + noise * stream.normal()) << "\n";
    auto const rate = [&](double at, double speed) { return (force - c * speed - k * at - k3 * at * at * at) / m; };
    for (int s = 0; s < 10; ++s) {  // midpoint rule
      double const y1 = y + step / 2 * v, v1 = v + step / 2 * rate(y, v);
      y += step * v1;
      v += step * rate(y1, v1);
    }
  }
}

std::string const bench_data =
    "data bench { file \"bench.csv\"; rate 1000 [Hz]; input x = force [N] hold zero_order; measure displacement = y [mm] }\n";

std::string oscillator_text(std::string const& name, std::string const& parameter, std::string const& term) {
  return "model " + name +
         " {\n  input x [N]\n  state y [m]\n  initial y = 0, y' = 0\n  parameter m [kg] ~ log_uniform(0.1, 10)\n" +
         "  parameter c [N s/m] ~ log_uniform(1, 200)\n  parameter k [N/m] ~ log_uniform(1e3, 1e5)\n" + parameter +
         "  parameter noise [mm] ~ log_uniform(1e-3, 10)\n  m*y'' + c*y' + k*y" + term +
         " = x\n  observe displacement ~ normal(y, sd = noise)\n}\n";
}

std::string const laws_text = oscillator_text("linear", "", "") +
                              oscillator_text("quadratic", "  parameter k2 [N/m^2] ~ normal(0, sd = 1e7)\n", " + k2*y^2") +
                              oscillator_text("cubic", "  parameter k3 [N/m^3] ~ normal(0, sd = 1e10)\n", " + k3*y^3") + bench_data;
std::string const law_set = "candidates laws { linear; quadratic; cubic; shared m, c, k, noise }\n";
std::string const short_selection =
    "selection = select laws to bench with reversible_jump(samples = 800, burn_in = 200, pilot = 400, chains = 4), seed = 1\n";

class Folder {
 public:
  Folder() { file(); }
  int run(std::string const& text, RunOptions options = {}, std::vector<std::string> const& verbs = {}) {
    options.output = results();
    options.force = !options.resume;
    RunResult const result = run_text(file(), text, options, verbs);
    out = result.out;
    return result.exit;
  }
  std::filesystem::path results() const { return folder_.path() / "results"; }
  /// One for all, beside the record: results name it.
  static std::filesystem::path file() {
    static TemporaryFolder const shared;
    static bool const written = (write_record(shared.path() / "bench.csv"), true);
    return written ? shared.path() / "m.sysid" : std::filesystem::path();
  }
  /// The code with which a run is refused; empty where it is not.
  std::string refused(std::string const& text) {
    try {
      run(text);
      return "";
    } catch (UserError const& error) {
      return error.diagnostic().code;
    }
  }
  json summary(std::string const& task) const { return json::parse(read_file(results() / task / "summary.json")); }
  /// Tables and summaries, by their names.
  std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> all;
    for (auto const& entry : std::filesystem::recursive_directory_iterator(results())) {
      std::string const name = entry.path().filename().string();
      if (name.ends_with(".csv") || name == "summary.json")
        all[std::filesystem::relative(entry.path(), results()).string()] = read_file(entry.path());
    }
    return all;
  }

  std::string out;

 private:
  TemporaryFolder folder_;
};

}  // namespace

TEST_CASE("jumps, evidences of fits and tempered populations agree on three oscillators") {
  Folder folder;
  std::string text = laws_text + law_set + "selection = select laws to bench with reversible_jump, seed = 1\n";
  for (char const* name : {"linear", "quadratic", "cubic"}) {
    text += std::string("of_") + name + " = fit " + name + " to bench with mh(samples = 12000, burn_in = 2000), seed = 2\n";
    text += std::string("smc_") + name + " = fit " + name +
            " to bench with mh(samples = 12000, burn_in = 2000), evidence = smc, seed = 3\n";
  }
  folder.run(text);
  json const selection = folder.summary("selection");
  double best = 0;
  std::string leader;
  for (auto const& [name, entry] : selection.at("models").items())
    if (entry.at("probability").get<double>() > best) best = entry.at("probability").get<double>(), leader = name;
  CHECK(best < 0.999);  // else there is nothing to agree about
  CHECK(selection.at("findings").empty());
  for (std::string const by : {"of_", "smc_"}) {
    double total = 0;
    json const of_leader = folder.summary(by + leader).at("evidence");
    double const first = of_leader.at("log_evidence"), first_error = of_leader.at("standard_error");
    std::map<std::string, double> weight;
    for (auto const& [name, entry] : selection.at("models").items()) {
      json const evidence = folder.summary(by + name).at("evidence");
      double const factor = evidence.at("log_evidence").get<double>() - first;
      total += weight[name] = std::exp(factor);
      if (name == leader) continue;
      CAPTURE(by);
      CAPTURE(name);
      double const error =
          std::hypot(evidence.at("standard_error").get<double>(), first_error, entry.at("log_bayes_factor_error").get<double>());
      CHECK(std::fabs(entry.at("log_bayes_factor").get<double>() - factor) < 3 * error);
    }
  }
}

TEST_CASE("terms that may be absent are arguments of 0 or 1") {
  Folder folder;
  std::string const terms =
      oscillator_text("oscillator(quadratic, cubic)",
                      "  parameter k2 [N/m^2] ~ normal(0, sd = 1e7)\n  parameter k3 [N/m^3] ~ normal(0, sd = 1e10)\n",
                      " + quadratic*k2*y^2 + cubic*k3*y^3");
  folder.run(laws_text + terms + law_set +
             "candidates terms { oscillator(quadratic = 0..1, cubic = 0..1); shared m, c, k, noise }\n"
             "selection = select laws to bench with reversible_jump, seed = 1\n"
             "subsets = select terms to bench with reversible_jump, seed = 2\n");
  json const three = folder.summary("selection").at("models"), four = folder.summary("subsets").at("models");
  REQUIRE(four.size() == 4);
  // Both know the linear model against the cubic one; a coefficient without its term keeps its prior and changes no evidence.
  auto const factor = [](json const& model) { return model.at("log_bayes_factor").get<double>(); };
  auto const error = [](json const& model) { return model.at("log_bayes_factor_error").get<double>(); };
  for (auto const& [name, other] :
       {std::pair{"linear", "oscillator(quadratic = 0, cubic = 0)"}, {"quadratic", "oscillator(quadratic = 1, cubic = 0)"}}) {
    json const &a = three.at(name), &b = three.at("cubic"), &c = four.at(other),
               &d = four.at("oscillator(quadratic = 0, cubic = 1)");
    double const off = factor(a) - factor(b) - (factor(c) - factor(d));
    CHECK(std::fabs(off) < 3 * std::sqrt(error(a) * error(a) + error(b) * error(b) + error(c) * error(c) + error(d) * error(d)));
  }
}

TEST_CASE("threads, lanes and interruptions change no byte of jumps, and predictions read what they leave") {
  std::string const text =
      laws_text + law_set + short_selection + "forecast = predict selection on bench with draws(50), seed = 3\n";
  Folder reference;
  reference.run(text);
  auto const expected = reference.files();
  REQUIRE(expected.contains("selection/draws_cubic.csv"));
  REQUIRE(expected.contains("forecast/predict.csv"));
  CHECK_FALSE(expected.contains("selection/populations.csv"));
  CHECK_FALSE(expected.contains("selection/particles_cubic.csv"));
  for (auto const& [lanes, threads] : {std::pair{4, 1}, {64, 3}}) {
    Folder folder;
    RunOptions options;
    options.execution = {lanes, threads};
    folder.run(text, options);
    CHECK(folder.files() == expected);
  }
  Folder folder;
  int interruptions = 0;
  RunOptions options;
  for (std::uint64_t const after : {1, 20, 200, 900, 2000, 4000}) {
    options.interrupt_after = after;
    options.resume = interruptions > 0;
    if (folder.run(text, options) != 75) break;
    clear_interrupt();
    ++interruptions;
  }
  CHECK(interruptions > 2);
  options.interrupt_after = 0;
  options.resume = true;
  CHECK(folder.run(text, options) != 75);
  CHECK(folder.files() == expected);
  // By another run, from the folder; and the page once more.
  std::string const before = read_file(folder.results() / "forecast/predict.csv");
  std::filesystem::remove_all(folder.results() / "forecast");
  options.resume = false;
  RunOptions again;
  again.output = folder.results();
  CHECK(run_text(Folder::file(), text, again, {"predict"}).exit == 0);
  CHECK(read_file(folder.results() / "forecast/predict.csv") == before);
}

TEST_CASE("a selection by likelihood refuses a distance and improper priors, and names a candidate that cannot be simulated") {
  Folder folder;
  CHECK(folder.refused(laws_text + law_set + with(short_selection, "seed = 1", "distance = rmse, seed = 1")) == "E6203");
  CHECK(folder.refused(with(laws_text, "c [N s/m] ~ log_uniform(1, 200)", "c [N s/m] ~ flat()") +
                       "candidates laws { linear; quadratic; cubic }\n" + short_selection) == "E6204");
  std::string const wild = oscillator_text("wild", "", " - 1e30 [N/m^3]*y^3 + 1e12 [N]*exp(1e9*y/1 [m])");
  folder.run(laws_text + wild + "candidates laws { linear; wild }\n" + short_selection);
  json const summary = folder.summary("selection");
  CHECK(summary.at("models").at("wild").at("probability") == 0);
  bool named = false;
  for (json const& finding : summary.at("findings"))
    named = named || (finding.at("code") == "model_not_visited" && finding.at("names") == json::array({"wild"}));
  CHECK(named);
}

TEST_CASE("models in two units are equally probable, also where lagged samples are missing") {
  TemporaryFolder folder;
  Stream stream({.seed = 9, .purpose = Purpose::test, .index = 0, .step = 0});
  std::string csv = "n,y\n";
  double y = 1;
  for (int i = 0; i < 60; ++i) {
    y = 0.6 * y + 0.2 * stream.normal();
    csv += i % 6 == 5 ? fmt::format("{},\n", i) : fmt::format("{},{}\n", i, y);
  }
  write_file(folder.path() / "record.csv", csv);
  std::string const text = R"(
model metres { time discrete 1 [s]; parameter a ~ normal(0, sd = 1); observe y [m] ~ normal(a*lag(measured(y), 1), sd = 0.2 [m]) }
model millimetres { time discrete 1 [s]; parameter a ~ normal(0, sd = 1); observe y [mm] ~ normal(a*lag(measured(y), 1), sd = 200 [mm]) }
model longer { time discrete 1 [s]; parameter a ~ normal(0, sd = 1); parameter b ~ normal(0, sd = 0.1); observe y [m] ~ normal(a*lag(measured(y), 1) + b*lag(measured(y), 3), sd = 0.2 [m]) }
data record { file "record.csv"; step 1 [s]; measure y = y [m]; split part = rows 10..60 }
candidates units { metres; millimetres }
candidates lags { metres; longer }
)";
  RunOptions options;
  options.output = folder.path() / "results";
  options.force = true;
  auto const run = [&](char const* set) {
    run_text(folder.path() / "case.sysid",
             text + "s = select " + set + " to record.part with reversible_jump(samples = 2000), seed = 1\n", options);
  };
  run("units");
  json const summary = json::parse(read_file(options.output / "s/summary.json"));
  CAPTURE(summary.at("models").dump(1));
  for (auto const& [name, model] : summary.at("models").items())
    CHECK(model.at("probability").get<double>() == doctest::Approx(0.5).epsilon(0.02));
  try {
    run("lags");
    CHECK_MESSAGE(false, "not refused");
  } catch (UserError const& error) {
    CHECK(error.diagnostic().code == "E6520");
  }
}
