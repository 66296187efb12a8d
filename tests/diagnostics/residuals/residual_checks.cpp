// What a fit says of records that it cannot explain: of structure that it leaves, of single samples far off, of noise whose prior
// is too narrow, and of priors that predict another size.
#include <doctest/doctest.h>

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/running.hpp"
#include "core/numeric/random.hpp"

using namespace sysid;
using nlohmann::json;

namespace {

// The findings of a fit, by `map` unless stated, to rows 101 to 400 of `value(row, stream)`, 0.1 s apart; rows count from 1.
template <class Value>
json findings_of_late_rows(std::string const& statements, Value const& value, std::string const& method = "map",
                           std::string const& unit = " [m]") {
  TemporaryFolder folder;
  Stream stream({1, Purpose::test, 0, 0});
  std::string table = "t,y\n";
  for (int row = 1; row <= 400; ++row) table += fmt::format("{},{}\n", 0.1 * row, value(row, stream));
  write_file(folder.path() / "record.csv", table);
  RunOptions options;
  options.output = folder.path() / "results";
  run_text(folder.path() / "m.sysid",
           "model m {\n " + statements + "\n}\ndata record { file \"record.csv\"; time t [s]; measure z = y" + unit +
               "; split late = rows 101..400 }\n"
               "posterior = fit m to record.late with " +
               method + ", seed = 1\n",
           options);
  return json::parse(read_file(options.output / "posterior/summary.json")).at("findings");
}

json const* find(json const& findings, std::string const& code) {
  for (json const& finding : findings)
    if (finding.at("code") == code) return &finding;
  return nullptr;
}

std::string const decay =
    "state y [m]\n parameter y0 [m] ~ normal(0, sd = 3)\n initial y = y0\n parameter k [1/s] ~ log_uniform(0.01, 10)\n"
    " parameter s [m] ~ log_uniform(0.001, 10)\n y' = -k*y\n observe z ~ normal(y, sd = s)";

}  // namespace

TEST_CASE("a fit that explains next to nothing and leaves more than noise fails, however wide its noise") {
  json const findings =
      findings_of_late_rows(decay, [](int row, Stream& stream) { return std::sin(0.2 * row) + 0.05 * stream.normal(); });
  json const* const found = find(findings, "explains_little");
  REQUIRE(found != nullptr);
  CHECK(found->at("severity") == "error");
}

TEST_CASE("a posterior where its prior has next to nothing is named, one in its middle or at a bound is not") {
  auto const record = [](int row, Stream& stream) {
    return 2 * std::exp(-0.005 * (row - 101)) + 0.01 * stream.normal();
  };  // k = 0.05
  std::string const broad = "k [1/s] ~ log_uniform(0.01, 10)";
  for (auto const& [prior, named] :
       {std::pair("k [1/s] ~ normal(0.06, sd = 0.002)", true), std::pair("k [1/s] ~ normal(0.05, sd = 0.002)", false),
        std::pair("k [1/s] ~ log_uniform(0.01, 0.04)", false)}) {
    CAPTURE(prior);
    std::string statements = decay;
    statements.replace(statements.find(broad), broad.size(), prior);
    json const findings = findings_of_late_rows(statements, record);
    json const* const found = find(findings, "prior_contradicted");
    CHECK((found != nullptr) == named);
    if (found != nullptr) CHECK(found->at("message").get<std::string>().starts_with("k is estimated as 0.0"));
  }
}

TEST_CASE("a log-normal prior that fits the data in its other reading is told so, one that fits in neither is not") {
  auto const record = [](int row, Stream& stream) { return 2 * std::exp(-0.005 * (row - 1)) + 0.01 * stream.normal(); };
  std::string const broad = "y0 [m] ~ normal(0, sd = 3)";
  for (auto const& [prior, cure] :
       {std::pair("y0 [m] ~ log_normal(0.7, sd = 0.1)",
                  "if 0.7 is meant as the mean of the logarithm, write `log_normal(log_mean = 0.7, log_sd = 0.1)`"),
        std::pair("y0 [m] ~ log_normal(log_mean = 2, log_sd = 0.1)",
                  "if 2 is meant as the median, write `log_normal(median = 2, log_sd = 0.1)`"),
        std::pair("y0 [m] ~ log_normal(5, sd = 0.1)", ""), std::pair("y0 [m] ~ normal(5, sd = 0.1)", "")}) {
    CAPTURE(prior);
    std::string statements = decay;
    statements.replace(statements.find(broad), broad.size(), prior);
    json const findings = findings_of_late_rows(statements, record);
    json const* const found = find(findings, "prior_contradicted");
    REQUIRE(found != nullptr);
    std::string const help = found->at("help");
    if (*cure == '\0')
      CHECK(help.find("is meant as") == std::string::npos);
    else
      CHECK(help.ends_with(cure));
  }
  std::string right = decay;
  right.replace(right.find(broad), broad.size(), "y0 [m] ~ log_normal(log_mean = 0.7, log_sd = 0.1)");
  CHECK(find(findings_of_late_rows(right, record), "prior_contradicted") == nullptr);
}

TEST_CASE("one spike neither hides what a fit misses nor is taken for it") {
  // The decay alone is fitted; the record swings as well, and one sample is far off.
  auto const record = [](int row, Stream& stream) {
    return row == 250 ? 99 : 2 * std::exp(-0.05 * (row - 101)) + 0.05 * std::sin(0.4 * row) + 0.001 * stream.normal();
  };
  json const findings = findings_of_late_rows(decay, record);
  CHECK(find(findings, "samples_far_off") != nullptr);
  json const* const coloured = find(findings, "residuals_not_white");
  REQUIRE(coloured != nullptr);
  // Not the widths alone: the estimates themselves are off.
  CHECK(coloured->at("help").get<std::string>().find("the errors of the estimates can be several times their sds") !=
        std::string::npos);
  CHECK(coloured->at("help").get<std::string>().ends_with(
      "adds `disturbance w ~ white(intensity = q)` to the model and compares both fits"));
  CHECK(find(findings, "explains_little") == nullptr);
}

TEST_CASE("noise that grows with the signal is named as such, not by its largest samples, under heavy tails, too") {
  auto const record = [](int row, Stream& stream) {
    double const signal = 2 * std::exp(-0.004 * (row - 101));
    return signal * (1 + (row == 110 ? 0.45 : 0.1 * stream.normal())) + 0.001 * stream.normal();
  };
  std::string heavy = decay;
  std::string const normal = "normal(y, sd = s)";
  heavy.replace(heavy.find(normal), normal.size(), "student_t(y, 4, scale = s)");
  for (std::string const& statements : {decay, heavy}) {
    CAPTURE(statements);
    json const findings = findings_of_late_rows(statements, record);
    json const* const found = find(findings, "noise_law");
    REQUIRE_MESSAGE(found != nullptr, findings.dump());
    CHECK(found->at("message").get<std::string>().find("grow with the prediction") != std::string::npos);
    CHECK(find(findings, "samples_far_off") == nullptr);
  }
  // A bad row is named besides.
  json const bad =
      findings_of_late_rows(decay, [&](int row, Stream& stream) { return record(row, stream) + (row == 250 ? 1.6 : 0); });
  CHECK(find(bad, "noise_law") != nullptr);
  json const* const far = find(bad, "samples_far_off");
  REQUIRE_MESSAGE(far != nullptr, bad.dump());
  std::string const message = far->at("message");
  CHECK(message.starts_with(
      "1 sample of z lies much farther from the fit than noise that grows with the prediction explains (row 250"));
  // A sample far off in noise of one size stays one.
  json const plain = findings_of_late_rows(decay, [](int row, Stream& stream) {
    return 2 * std::exp(-0.004 * (row - 101)) + (row == 110 ? 1.5 : 0.05 * stream.normal());
  });
  CHECK(find(plain, "samples_far_off") != nullptr);
  CHECK(find(plain, "noise_law") == nullptr);
}

TEST_CASE("noise larger than the response is no fault of the fit") {
  json const findings =
      findings_of_late_rows(decay, [](int row, Stream& stream) { return 2 * std::exp(-0.05 * (row - 101)) + 3 * stream.normal(); });
  CHECK(find(findings, "explains_little") == nullptr);
  CHECK(find(findings, "samples_far_off") == nullptr);
}

TEST_CASE("eleven samples of a decay that the priors exclude are a trend, those of noise are none") {
  auto const found = [](auto const& value) {
    TemporaryFolder folder;
    Stream stream({1, Purpose::test, 0, 0});
    std::string table = "t,y\n";
    for (int row = 0; row < 11; ++row) table += fmt::format("{},{}\n", row, value(row, stream));
    write_file(folder.path() / "record.csv", table);
    RunOptions options;
    options.output = folder.path() / "results";
    run_text(folder.path() / "m.sysid",
             "model m {\n state c [mg/l]\n parameter c0 [mg/l] ~ log_uniform(0.1, 100)\n initial c = c0\n"
             " parameter k [1/h] ~ log_uniform(0.001, 10)\n parameter s ~ log_uniform(0.001, 1)\n c' = k*c\n"
             " observe z ~ log_normal(median = c, sd = s)\n}\n"
             "data record { file \"record.csv\"; time t [h]; measure z = y [mg/l] }\n"
             "posterior = fit m to record with map, seed = 1\n",
             options);
    return json::parse(read_file(options.output / "posterior/summary.json")).at("findings");
  };
  json const missed = found([](int row, Stream& stream) { return 10 * std::exp(-0.4 * row + 0.1 * stream.normal()); });
  json const* const finding = find(missed, "explains_little");
  REQUIRE(finding != nullptr);
  CHECK(finding->at("severity") == "error");
  CHECK(finding->at("message").get<std::string>().find("have a trend in time") != std::string::npos);
  json const still = found([](int, Stream& stream) { return 10 * std::exp(0.5 * stream.normal()); });
  CHECK(find(still, "explains_little") == nullptr);
}

TEST_CASE("samples far off are named by their rows in the file") {
  auto const value = [](int row, Stream& stream) {
    return row == 250 ? 999 : 2 * std::exp(-0.05 * (row - 101)) + 0.01 * stream.normal();
  };
  SUBCASE("where the noise is estimated") {
    json const findings = findings_of_late_rows(decay, value);
    json const* const found = find(findings, "samples_far_off");
    REQUIRE(found != nullptr);
    CHECK(found->at("message").get<std::string>().find("(row 250, ") != std::string::npos);
    CHECK(found->at("help").get<std::string>().ends_with("use noise with heavy tails, `observe z ~ student_t(y, 4, scale = s)`"));
  }
  SUBCASE("where noise of another size is the error, which then asks for them first") {
    std::string stated = decay;
    stated.replace(stated.find("log_uniform(0.001, 10)"), 22, "log_uniform(0.001, 1)");
    json const findings = findings_of_late_rows(stated, value);
    REQUIRE(find(findings, "samples_far_off") != nullptr);
    REQUIRE(find(findings, "noise_size") != nullptr);
    CHECK(find(findings, "noise_size")->at("help").get<std::string>().find("check these first") != std::string::npos);
  }
}

TEST_CASE("an estimated noise that does not reach the residuals is not advised to be estimated") {
  std::string narrow = decay;
  narrow.replace(narrow.find("log_uniform(0.001, 10)"), 22, "log_uniform(0.001, 0.1)");
  json const findings = findings_of_late_rows(
      narrow, [](int row, Stream& stream) { return 2 * std::exp(-0.05 * (row - 101)) + 0.3 * stream.normal(); });
  REQUIRE(find(findings, "noise_size") != nullptr);
  CHECK(find(findings, "noise_size")
            ->at("help")
            .get<std::string>()
            .starts_with("the model is incomplete, a prior excludes the values that fit"));
}

TEST_CASE("an estimated noise whose lower bound is above the residuals is named") {
  std::string wide = decay;
  wide.replace(wide.find("log_uniform(0.001, 10)"), 22, "log_uniform(0.1, 10)");
  auto const help_of = [](double noise, std::string const& text) {
    json const findings = findings_of_late_rows(
        text, [&](int row, Stream& stream) { return 2 * std::exp(-0.005 * (row - 101)) + noise * stream.normal(); });
    json const* const size = find(findings, "noise_size");
    return size == nullptr ? std::string() : size->at("help").get<std::string>();
  };
  CHECK(help_of(0.01, wide) == "the residuals are smaller than the lower bound of `s` allows: lower it");
  CHECK(help_of(0, decay) ==
        "the residuals are smaller than the lower bound of `s` allows: lower it; the record seems to have no noise at all, as a "
        "simulated one");
  CHECK(help_of(0.3, wide).empty());
}

TEST_CASE("a prior too narrow for the data to change its parameter is named where residuals are correlated") {
  auto const help_of = [&](std::string const& sd) {
    std::string fixed = decay;
    fixed.replace(fixed.find("log_uniform(0.01, 10)"), 21, "normal(0.06, sd = " + sd + ")");
    json const findings = findings_of_late_rows(
        fixed, [](int row, Stream& stream) { return 2 * std::exp(-0.005 * (row - 101)) + 0.01 * stream.normal(); });
    json const* const memory = find(findings, "residuals_not_white");
    return memory == nullptr ? std::string() : memory->at("help").get<std::string>();
  };
  CHECK(help_of("1e-6").find("; or check the prior of k, which is so narrow (0.05999836 to 0.06000164 1/s)") != std::string::npos);
  CHECK(help_of("0.01").find("check the prior") == std::string::npos);
}

TEST_CASE("a fit says when its prior predicts another size than was measured") {
  // Millimetres in a column that is declared in metres.
  std::string near = decay;
  near.replace(near.find("normal(0, sd = 3)"), 17, "normal(0.003, sd = 0.001)");
  json const findings = findings_of_late_rows(
      near, [](int row, Stream& stream) { return 2 * std::exp(-0.05 * (row - 101)) + 0.01 * stream.normal(); });
  CHECK(find(findings, "prior_far_from_data") != nullptr);
  CHECK(find(findings_of_late_rows(
                 decay, [](int row, Stream& stream) { return 2 * std::exp(-0.05 * (row - 101)) + stream.normal() / 100; }),
             "prior_far_from_data") == nullptr);
}

TEST_CASE("a response that is missed where it is largest has no outliers") {
  // A burst of three rows, one in a hundred of those fitted, that a decay cannot follow.
  json const findings = findings_of_late_rows(
      decay, [](int row, Stream& stream) { return (row >= 250 && row <= 252 ? 5.0 : 0.0) + 0.05 * stream.normal(); });
  CHECK(find(findings, "samples_far_off") == nullptr);
  CHECK(find(findings, "residuals_not_white") != nullptr);
}

TEST_CASE("an offset is advised only where it leaves a response that is explained") {
  // The decay has the wrong sign: a response that rises from 3 to 4, of which a fit can only be too low.
  std::string rising = decay;
  rising.replace(rising.find("normal(0, sd = 3)"), 17, "normal(0.01, sd = 0.001)");
  auto const help_of = [&](double size, double level) {
    json const findings = findings_of_late_rows(
        rising, [=](int row, Stream& stream) { return level + size * std::sin(0.2 * row) + 0.05 * stream.normal(); });
    json const* const found = find(findings, "worse_than_the_mean");
    REQUIRE(found != nullptr);
    return found->at("help").get<std::string>();
  };
  CHECK(help_of(1, 5).find("an offset alone does not explain the misfit: check signs") != std::string::npos);
  CHECK(help_of(1, 5).find("add the offset first") == std::string::npos);
}

TEST_CASE("counts that scatter more than Poisson's are given a negative binomial, by its line") {
  std::string const counts =
      "state y [-]\n initial y = 20\n parameter k [1/s] ~ log_uniform(1e-3, 1)\n y' = -k*y\n observe z ~ poisson(y)";
  auto const record = [](double scatter) {
    return [scatter](int row, Stream& stream) {
      double const mean = 20 * std::exp(-0.005 * row);
      return std::fmax(0, std::round(mean + scatter * std::sqrt(mean) * stream.normal()));
    };
  };
  json const wide = findings_of_late_rows(counts, record(2.5), "map", "");
  json const* const found = find(wide, "noise_size");
  REQUIRE(found != nullptr);
  CHECK(found->at("help").get<std::string>().find("add `parameter z_shape [-] ~ log_uniform(0.1, 1000)` and write `observe z ~ "
                                                  "negative_binomial(y, shape = z_shape)`") != std::string::npos);
  json const even = findings_of_late_rows(counts, record(0.1), "map", "");
  REQUIRE(find(even, "noise_size") != nullptr);
  CHECK(find(even, "noise_size")->at("help").get<std::string>().starts_with("the counts scatter less than"));
  CHECK(find(findings_of_late_rows(counts, record(1), "map", ""), "noise_size") == nullptr);
}

TEST_CASE("counts of a line whose mean is next to nothing beside it have the size of their noise") {
  // exp(-200^2 / 56.5) is 1e-307.5: its inverse is no number at the last rows.
  TemporaryFolder folder;
  Stream stream({1, Purpose::test, 0, 0});
  std::string table = "x,n\n";
  for (int x = 0; x <= 401; ++x) {
    double const mean = 9 * std::exp(-(x - 200.0) * (x - 200.0) / 56.5);
    table += fmt::format("{},{:.0f}\n", x, mean < 0.1 ? 0 : std::fmax(0, std::round(mean + std::sqrt(mean) * stream.normal())));
  }
  write_file(folder.path() / "record.csv", table);
  for (std::string const noise : {"poisson(mean)", "negative_binomial(mean, shape = 1e4)"}) {
    CAPTURE(noise);
    RunOptions options;
    options.output = folder.path() / noise;
    run_text(folder.path() / "m.sysid",
             "model m {\n input x\n parameter A ~ log_uniform(1, 100)\n let mean = A*exp(-(x - 200)^2/56.5)\n observe z ~ " +
                 noise +
                 "\n}\ndata record { file \"record.csv\"; input x = x; measure z = n }\n"
                 "posterior = fit m to record with map, seed = 1\n",
             options);
    json const summary = json::parse(read_file(options.output / "posterior/summary.json"));
    CHECK(find(summary.at("findings"), "noise_size") == nullptr);
  }
}

TEST_CASE("a maximum of the likelihood contradicts a prior by its own words, and none that another maximum fits") {
  auto const record = [](int row, Stream& stream) { return 2 * std::exp(-0.005 * (row - 101)) + 0.01 * stream.normal(); };
  std::string contradicted = decay;
  contradicted.replace(contradicted.find("k [1/s] ~ log_uniform(0.01, 10)"), 31, "k [1/s] ~ normal(0.06, sd = 0.002)");
  json const findings = findings_of_late_rows(contradicted, record, "ml");
  json const* const found = find(findings, "prior_contradicted");
  REQUIRE(found != nullptr);
  CHECK(found->at("help").get<std::string>().starts_with("`ml` does not use the density of the prior"));
  CHECK(found->at("help").get<std::string>().find("posterior") == std::string::npos);
  // The rates of two steps can be exchanged; one of both ways agrees with the prior of k.
  std::string const two_steps =
      "state a [m], y [m]\n initial a = 2, y = 0\n parameter r [1/s] ~ log_uniform(0.01, 10)\n parameter V [-] ~ log_uniform(0.01, "
      "10)\n"
      " parameter k [1/s] ~ log_normal(0.12, sd = 0.3)\n parameter s [m] ~ log_uniform(0.001, 10)\n a' = -r*a\n y' = r*a - k*y\n"
      " observe z ~ normal(y/V, sd = s)";
  auto const rises = [](int row, Stream& stream) {
    return 2 / 0.9 * (std::exp(-0.01 * row) - std::exp(-0.1 * row)) + 0.01 * stream.normal();
  };
  json const exchanged = findings_of_late_rows(two_steps, rises, "ml");
  CHECK(find(exchanged, "second_mode") != nullptr);
  CHECK(find(exchanged, "prior_contradicted") == nullptr);
}
