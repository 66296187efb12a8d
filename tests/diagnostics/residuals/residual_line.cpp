// An offset or a drift of a sensor: what it is told from, and cures that are followed as they are written.
#include "diagnostics/residuals/residual_line.hpp"

#include <doctest/doctest.h>

#include <fmt/format.h>

#include <cmath>
#include <ctime>
#include <nlohmann/json.hpp>

#include "app/running.hpp"
#include "core/numeric/random.hpp"
#include "relative.hpp"

using namespace sysid;
using nlohmann::json;

namespace {

constexpr int samples = 1500;

template <class Value>
std::vector<double> series(Value const& value) {
  Stream stream({7, Purpose::test, 0, 0});
  std::vector<double> made;
  for (int i = 0; i < samples; ++i) made.push_back(value(static_cast<double>(i), stream));
  return made;
}

// An oscillator that is let go, with what its sensor adds; `noise` as the model has it, `more` statements.
json findings_of_fit(std::string const& noise, std::string const& more, double offset, double drift = 0) {
  TemporaryFolder folder;
  Stream stream({3, Purpose::test, 0, 0});
  std::string table = "t,y\n";
  for (int row = 0; row < 1000; ++row) {
    double const t = 0.02 * row;
    table += fmt::format("{},{}\n", t, 5 * std::exp(-0.1 * t) * std::cos(3 * t) + offset + drift * t + 0.05 * stream.normal());
  }
  write_file(folder.path() / "record.csv", table);
  RunOptions options;
  options.output = folder.path() / "results";
  run_text(folder.path() / "m.sysid",
           "model m {\n  state y [mm]\n  parameter y0 [mm] ~ normal(0, sd = 20)\n  parameter v0 [mm/s] ~ normal(0, sd = 50)\n"
           "  initial y = y0, y' = v0\n  parameter d [1/s] ~ log_uniform(0.01, 1)\n  parameter w [1/s] ~ log_uniform(1, 10)\n"
           "  parameter sigma [mm] ~ log_uniform(0.001, 100)\n  y'' + 2*d*y' + w^2*y = 0\n" +
               more + "\n  " + noise +
               "\n}\ndata record { file \"record.csv\"; time t [s]; measure z = y [mm] }\n"
               "posterior = fit m to record with map, seed = 1\n",
           options);
  return json::parse(read_file(options.output / "posterior/summary.json")).at("findings");
}

json const* of_code(json const& findings, std::string const& code) {
  for (json const& finding : findings)
    if (finding.at("code") == code) return &finding;
  return nullptr;
}

/// Of a model and data blocks as they are written, with a record `wave.csv` (s, a, b, warm): a sine s, and 5 s with noise of 0.05
/// about 0, 1.3 and 21.
json findings_of(std::string const& model, std::string const& data, std::string const& experiments) {
  TemporaryFolder folder;
  Stream stream({5, Purpose::test, 0, 0});
  std::string table = "s,a,b,warm\n";
  for (int row = 0; row < 600; ++row) {
    double const sine = std::sin(0.06 * row), wave = 5 * sine;
    auto const noise = [&] { return 0.05 * stream.normal(); };
    table += fmt::format("{},{},{},{}\n", sine, wave + noise(), wave + 1.3 + noise(), wave + 21 + noise());
  }
  write_file(folder.path() / "wave.csv", table);
  RunOptions options;
  options.output = folder.path() / "results";
  run_text(folder.path() / "m.sysid", model + data + "posterior = fit m to " + experiments + " with map, seed = 1\n", options);
  return json::parse(read_file(options.output / "posterior/summary.json")).at("findings");
}

/// The text between the n-th pair of backquotes.
std::string quoted_part(std::string const& text, int n) {
  std::size_t at = 0;
  for (int i = 0; i < 2 * n - 1; ++i) at = text.find('`', at) + 1;
  return text.substr(at, text.find('`', at) - at);
}

}  // namespace

TEST_CASE("a mean is an offset where it is most of a misfit, whatever its size") {
  OffsetTest const large = offset_test(series([](double, Stream& s) { return 20 + s.normal(); }), true);
  CHECK(large.fires);
  CHECK(large.white_without);
  CHECK(large.share == doctest::Approx(400.0 / 401).epsilon(1e-3));
  CHECK(large.standard_errors == doctest::Approx(20 * std::sqrt(samples)).epsilon(0.1));
  CHECK(offset_test(series([](double, Stream& s) { return 0.4 + s.normal(); }), true).fires);
  CHECK(offset_test(series([](double i, Stream& s) { return i > 700 && i < 750 ? std::nan("") : 0.4 + s.normal(); }), true).fires);
}

TEST_CASE("noise, drifts, transients and oscillations are no offset") {
  CHECK_FALSE(offset_test(series([](double, Stream& s) { return s.normal(); }), true).fires);
  CHECK_FALSE(offset_test(series([](double i, Stream& s) { return 10 * i / samples + s.normal(); }), true).fires);
  CHECK_FALSE(offset_test(series([](double i, Stream& s) { return (i < 700 ? 0 : 5) + s.normal(); }), true).fires);
  CHECK_FALSE(offset_test(series([](double i, Stream& s) { return 20 * std::exp(-i / 200) + s.normal(); }), true).fires);
  CHECK_FALSE(offset_test(series([](double i, Stream& s) { return 4 * std::sin(i / 20) + s.normal(); }), true).fires);
  double wander = 0;
  CHECK_FALSE(offset_test(series([&](double, Stream& s) { return wander += s.normal(); }), true).fires);
  // A response of which a part is missing: its mean is as large as what is left beside it.
  CHECK_FALSE(offset_test(series([](double i, Stream& s) { return 1 + 2 * std::sin(i / 7) + 0.1 * s.normal(); }), true).fires);
}

TEST_CASE("a line in time is a trend where it is most of a misfit, whatever its size") {
  std::vector<double> time;
  for (int i = 0; i < samples; ++i) time.push_back(3 + 0.02 * i);
  TrendTest const large = trend_test(series([](double i, Stream& s) { return 0.02 * i - 10 + s.normal(); }), time);
  CHECK(large.fires);
  CHECK(large.white_without);
  CHECK(large.share == doctest::Approx(75.0 / 76).epsilon(0.01));  // 30^2/12 beside 1
  CHECK(large.standard_errors == doctest::Approx(0.02 * samples * std::sqrt(samples / 12.0)).epsilon(0.1));
  CHECK(trend_test(series([](double i, Stream& s) { return i / samples + s.normal(); }), time).fires);
  CHECK(trend_test(series([](double i, Stream& s) { return i > 700 && i < 750 ? std::nan("") : i / samples + s.normal(); }), time)
            .fires);
  // Not in equal steps.
  for (std::size_t i = 0; i < time.size(); ++i) time[i] = 1e-5 * static_cast<double>(i * i);
  std::vector<double> bent = series([](double, Stream& s) { return s.normal(); });
  for (std::size_t i = 0; i < time.size(); ++i) bent[i] += 2 * time[i];
  CHECK(trend_test(bent, time).white_without);
  CHECK(trend_test(bent, time).fires);
}

TEST_CASE("noise, steps, transients, oscillations and wander are no trend") {
  std::vector<double> time;
  for (int i = 0; i < samples; ++i) time.push_back(0.02 * i);
  auto const fires = [&](auto const& value) { return trend_test(series(value), time).fires; };
  CHECK_FALSE(fires([](double, Stream& s) { return s.normal(); }));
  CHECK_FALSE(fires([](double i, Stream& s) { return (i < 700 ? 0 : 5) + s.normal(); }));
  CHECK_FALSE(fires([](double i, Stream& s) { return 20 * std::exp(-i / 200) + s.normal(); }));
  CHECK_FALSE(fires([](double i, Stream& s) { return 4 * std::sin(i / 20) + s.normal(); }));
  CHECK_FALSE(fires([](double i, Stream& s) { return 10 * std::pow(i / samples - 0.5, 2) + 0.1 * s.normal(); }));
  double wander = 0;
  CHECK_FALSE(fires([&](double, Stream& s) { return wander += s.normal(); }));
}

TEST_CASE("white series have an offset in fewer than one of a thousand, and no trend") {
  int found = 0;
  for (std::uint64_t key = 0; key < 1000; ++key) {
    Stream stream({key, Purpose::test, 0, 0});
    std::vector<double> values;
    for (int i = 0; i < 200; ++i) values.push_back(stream.normal());
    found += offset_test(values, true).fires ? 1 : 0;
    found += offset_test(values, false).fires ? 1 : 0;
    std::vector<double> time;
    for (int i = 0; i < 200; ++i) time.push_back(i);
    found += trend_test(values, time).fires ? 1 : 0;
  }
  CHECK(found == 0);
}

TEST_CASE("equal residuals have the size of the noise, and no trend") {
  for (bool const ordered : {false, true}) {
    CHECK_FALSE(offset_test(std::vector<double>(60, 1e-7), ordered).fires);
    OffsetTest const large = offset_test(std::vector<double>(60, 5.1), ordered);
    CHECK(large.fires);
    CHECK(large.standard_errors == doctest::Approx(5.1 * std::sqrt(60)).epsilon(1e-9));
  }
  std::vector<double> time;
  for (int i = 0; i < 60; ++i) time.push_back(0.1 * i);
  CHECK_FALSE(trend_test(std::vector<double>(60, 0.1), time).fires);
}

TEST_CASE("the trend of a long record takes a time in proportion to it") {
  std::vector<double> residuals, time;
  Stream stream({11, Purpose::test, 0, 0});
  for (int i = 0; i < 100000; ++i) residuals.push_back(1e-5 * i + stream.normal()), time.push_back(i);
  std::clock_t const before = std::clock();
  CHECK(trend_test(residuals, time).fires);
  CHECK(std::clock() - before < 5 * CLOCKS_PER_SEC);  // a twentieth of a second, and half a minute where each row costs a sum
}

TEST_CASE("an offset of a sensor is named with lines that remove it") {
  json const findings = findings_of_fit("observe z ~ normal(y, sd = sigma)", "", 1.3);
  json const* const found = of_code(findings, "residual_offset");
  REQUIRE(found != nullptr);
  CHECK(found->at("severity") == "warning");
  std::string const message = found->at("message"), begin = "the residuals of z have a mean of ";
  CAPTURE(message);
  REQUIRE(message.starts_with(begin));
  // The motion takes a little of it.
  CHECK(std::stod(message.substr(begin.size())) == doctest::Approx(1.3).epsilon(0.05));
  CHECK(message.find(" mm, ") != std::string::npos);
  std::string const help = found->at("help");
  std::string const declaration = quoted_part(help, 1), statement = quoted_part(help, 2);
  CHECK(declaration == "parameter z_offset [mm] ~ normal(0, sd = 5)");
  CHECK(statement == "observe z ~ normal(y + z_offset, sd = sigma)");
  for (json const& each : findings) CHECK(each.at("help").get<std::string>().find("disturbance") == std::string::npos);
  // Followed as it is written.
  json const cured = findings_of_fit(statement, "  " + declaration, 1.3);
  CHECK_MESSAGE(cured.empty(), cured.dump());
}

TEST_CASE("a stated noise, a weighted mean and a sum keep their form in the cure") {
  for (auto const& [noise, statement] :
       {std::pair("observe z ~ normal(y, sd = 0.05 [mm])", "observe z ~ normal(y + z_offset, sd = 0.05 [mm])"),
        std::pair("observe z ~ student_t(y, 4, scale = sigma)", "observe z ~ student_t(y + z_offset, 4, scale = sigma)"),
        std::pair("observe z ~ normal(if y > 100 [mm] then 2*y else y, sd = sigma)",
                  "observe z ~ normal((if y > 100 [mm] then 2*y else y) + z_offset, sd = sigma)")}) {
    CAPTURE(noise);
    json const findings = findings_of_fit(noise, "", -1.3);
    json const* const found = of_code(findings, "residual_offset");
    REQUIRE(found != nullptr);
    CHECK(quoted_part(found->at("help"), 2) == statement);
  }
}

TEST_CASE("a drift of a sensor is named with lines that remove it") {
  std::string const plain = "observe z ~ normal(y, sd = sigma)";
  json const findings = findings_of_fit(plain, "", -1.2, 0.1);
  json const* const found = of_code(findings, "residual_trend");
  REQUIRE_MESSAGE(found != nullptr, findings.dump());
  std::string const message = found->at("message"), begin = "the residuals of z follow a line in time: a slope of ";
  CAPTURE(message);
  REQUIRE(message.starts_with(begin));
  CHECK(std::stod(message.substr(begin.size())) == relative(0.1, 0.05));
  CHECK(message.find(" mm/s, ") != std::string::npos);
  CHECK(of_code(findings, "residual_offset") == nullptr);
  for (json const& each : findings) CHECK(each.at("help").get<std::string>().find("disturbance") == std::string::npos);
  std::string const help = found->at("help"), time = quoted_part(help, 1), offset = quoted_part(help, 2),
                    drift = quoted_part(help, 3);
  CHECK(time == "time t [s]");
  CHECK(offset == "parameter z_offset [mm] ~ normal(0, sd = 5)");
  CHECK(drift == "parameter z_drift [mm/s] ~ normal(0, sd = 0.5)");
  std::string const statement = quoted_part(help, 4);
  CHECK(statement == "observe z ~ normal(y + z_offset + z_drift*t, sd = sigma)");
  json const cured = findings_of_fit(statement, "  " + time + "\n  " + offset + "\n  " + drift, -1.2, 0.1);
  CHECK_MESSAGE(cured.empty(), cured.dump());
}

TEST_CASE("a model that names the time or holds an offset keeps both in the cure of a drift") {
  std::string const more = "  time tau [s]\n  parameter b [mm] ~ normal(0, sd = 5)\n  parameter z_drift [1/s] = 1 [1/s]\n";
  std::string const noise = "observe z ~ normal(y + b, sd = sigma)";
  json const findings = findings_of_fit(noise, more, -1.2, 0.1);
  json const* const found = of_code(findings, "residual_trend");
  REQUIRE_MESSAGE(found != nullptr, findings.dump());
  std::string const help = found->at("help"), drift = quoted_part(help, 1), statement = quoted_part(help, 2);
  CHECK(drift == "parameter z_drift_2 [mm/s] ~ normal(0, sd = 0.5)");
  CHECK(statement == "observe z ~ normal(y + b + z_drift_2*tau, sd = sigma)");
  json const cured = findings_of_fit(statement, more + "  " + drift, -1.2, 0.1);
  CHECK_MESSAGE(of_code(cured, "residual_trend") == nullptr, cured.dump());
  CHECK_MESSAGE(of_code(cured, "residuals_not_white") == nullptr, cured.dump());
}

TEST_CASE("a good fit, a drift of the sensor and an offset that the model has are no offset") {
  std::string const plain = "observe z ~ normal(y, sd = sigma)";
  CHECK(of_code(findings_of_fit(plain, "", 0), "residual_offset") == nullptr);
  json const drifts = findings_of_fit(plain, "", 0, 0.1);
  CHECK(of_code(drifts, "residual_offset") == nullptr);
  CHECK(of_code(drifts, "residual_trend") != nullptr);
  CHECK(of_code(findings_of_fit(plain, "", 0), "residual_trend") == nullptr);
  std::string const with_offset = "observe z ~ normal(y + b, sd = sigma)";
  CHECK(of_code(findings_of_fit(with_offset, "  parameter b [mm] ~ normal(0, sd = 5)", 1.3), "residual_offset") == nullptr);
  // An offset that is held is not declared twice.
  for (auto const& [declared, cure] : {std::pair("  parameter b [mm] = 0", "give `b` a prior"),
                                       std::pair("  parameter b [mm] ~ normal(0, sd = 0.001)", "widen the prior of `b`")}) {
    json const held = findings_of_fit(with_offset, declared, 1.3);
    json const* const found = of_code(held, "residual_offset");
    REQUIRE(found != nullptr);
    CHECK(found->at("help").get<std::string>().ends_with(cure));
  }
}

TEST_CASE("the offset of an element of a vector is that of the vector") {
  std::string const begin =
      "model m {\n  input s\n  parameter A(2) [mm] ~ log_uniform(0.1, 100)\n  parameter sigma [mm] ~ log_uniform(0.001, 100)\n";
  std::string const data = "data wave { file \"wave.csv\"; input s = s; measure pos[1] = a [mm]; measure pos[2] = b [mm] }\n";
  json const findings = findings_of(begin + "  observe pos(2) [mm] ~ normal(A*s, sd = sigma)\n}\n", data, "wave");
  json const* const found = of_code(findings, "residual_offset");
  REQUIRE_MESSAGE(found != nullptr, findings.dump());
  std::string const help = found->at("help"), declaration = quoted_part(help, 1), statement = quoted_part(help, 2);
  CHECK(declaration == "parameter pos_offset(2) [mm] ~ normal(0, sd = 5)");
  json const cured = findings_of(begin + "  " + declaration + "\n  " + statement + "\n}\n", data, "wave");
  CHECK_MESSAGE(of_code(cured, "residual_offset") == nullptr, cured.dump());
}

TEST_CASE("the offset of a temperature is an interval, and its name is one that the text does not use") {
  std::string const begin =
      "model m {\n  input s\n  parameter A [delta_degC] ~ log_uniform(0.1, 100)\n  constant temp_offset = 3\n"
      "  parameter sigma [delta_degC] ~ log_uniform(0.001, 100)\n";
  std::string const data = "data wave { file \"wave.csv\"; input s = s; measure temp = warm [degC] }\n";
  json const findings = findings_of(begin + "  observe temp [degC] ~ normal(20 [degC] + A*s, sd = sigma)\n}\n", data, "wave");
  json const* const found = of_code(findings, "residual_offset");
  REQUIRE_MESSAGE(found != nullptr, findings.dump());
  std::string const help = found->at("help"), declaration = quoted_part(help, 1), statement = quoted_part(help, 2);
  CHECK(declaration == "parameter temp_offset_2 [delta_degC] ~ normal(0, sd = 5)");
  CHECK(found->at("message").get<std::string>().find(" delta_degC, ") != std::string::npos);
  json const cured = findings_of(begin + "  " + declaration + "\n  " + statement + "\n}\n", data, "wave");
  CHECK_MESSAGE(of_code(cured, "residual_offset") == nullptr, cured.dump());
}

TEST_CASE("the offset of a pure number has no unit, and its name keeps Greek letters") {
  json const findings = findings_of(
      "model m {\n  input s\n  parameter A [-] ~ log_uniform(0.1, 100)\n  parameter sigma [-] ~ log_uniform(0.001, 100)\n"
      "  observe θ [-] ~ normal(A*s, sd = sigma)\n}\n",
      "data wave { file \"wave.csv\"; input s = s; measure θ = b }\n", "wave");
  json const* const found = of_code(findings, "residual_offset");
  REQUIRE_MESSAGE(found != nullptr, findings.dump());
  CHECK(found->at("message").get<std::string>().find(" -, ") == std::string::npos);
  CHECK(quoted_part(found->at("help"), 1).starts_with("parameter θ_offset [-] ~ "));
}

TEST_CASE("records of different offsets get one declaration, and an offset that they share becomes one of each") {
  std::string const begin =
      "model m {\n  input s\n  parameter A [mm] ~ log_uniform(0.1, 100)\n  parameter sigma [mm] ~ log_uniform(0.001, 100)\n";
  std::string const data =
      "data one { file \"wave.csv\"; input s = s; measure z = b [mm] }\n"
      "data two { file \"wave.csv\"; input s = s; measure z = warm [mm] }\n";
  json const findings = findings_of(begin + "  observe z [mm] ~ normal(A*s, sd = sigma)\n}\n", data, "one, two");
  json const* const found = of_code(findings, "residual_offset");
  REQUIRE_MESSAGE(found != nullptr, findings.dump());
  std::string const declaration = quoted_part(found->at("help"), 1), statement = quoted_part(found->at("help"), 2);
  for (json const& each : findings)
    if (each.at("code") == "residual_offset") CHECK(quoted_part(each.at("help"), 1) == declaration);
  CHECK(of_code(findings_of(begin + "  " + declaration + "\n  " + statement + "\n}\n", data, "one, two"), "residual_offset") ==
        nullptr);
  std::string const shared = "  observe z [mm] ~ normal(2*(A*s/2 - b), sd = sigma)\n}\n";
  json const held = findings_of(begin + "  parameter b [mm] ~ normal(0, sd = 100)\n" + shared, data, "one, two");
  json const* const both = of_code(held, "residual_offset");
  REQUIRE_MESSAGE(both != nullptr, held.dump());
  CHECK(both->at("help").get<std::string>().find("write `per experiment` after `b`") != std::string::npos);
  json const apart = findings_of(begin + "  parameter b per experiment [mm] ~ normal(0, sd = 100)\n" + shared, data, "one, two");
  CHECK_MESSAGE(of_code(apart, "residual_offset") == nullptr, apart.dump());
}
