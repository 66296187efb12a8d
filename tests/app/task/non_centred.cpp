// A hierarchy that is written as `mean + spread*z`: its priors are to separate what the data do not.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include "app/running.hpp"
#include "core/numeric/elementary.hpp"
#include "core/numeric/random.hpp"

using namespace sysid;

namespace {

// Four decays with rates of their own.
std::vector<std::pair<std::string, std::string>> decays() {
  std::vector<std::pair<std::string, std::string>> files;
  Stream stream({11, Purpose::test, 0, 0});
  int k = 0;
  for (double const rate : {0.30, 0.36, 0.41, 0.47}) {
    std::string table = "t,c\n";
    for (int row = 0; row < 30; ++row)
      table += fmt::format("{:.6g},{:.6g}\n", 0.4 * row, 5 * elementary::exp(-rate * 0.4 * row) + 0.05 * stream.normal());
    files.emplace_back(fmt::format("g{}.csv", k++), std::move(table));
  }
  return files;
}

std::string hierarchy_text(std::string const& rate) {
  std::string text = "model decay {\n state c [mg]\n initial c = c0\n parameter c0 [mg] ~ log_uniform(0.5, 50)\n" + rate +
                     " c' = -k*c\n observe conc ~ normal(c, sd = 0.05)\n}\n";
  for (int k = 0; k < 4; ++k) text += fmt::format("data g{0} {{ file \"g{0}.csv\"; time t [s]; measure conc = c [mg] }}\n", k);
  return text + "post = fit decay to g0, g1, g2, g3 with map, seed = 2\n";
}

std::vector<std::string> severities(nlohmann::json const& summary, std::string const& code) {
  std::vector<std::string> all;
  for (auto const& each : summary.at("findings"))
    if (each.at("code") == code) all.push_back(each.at("severity"));
  return all;
}

}  // namespace

TEST_CASE("a non-centred hierarchy with proper priors is not told to fix one of its parameters") {
  CaseRun const run(hierarchy_text(" parameter mu ~ normal(-1, sd = 1)\n parameter tau ~ half_normal(sd = 0.5)\n"
                                   " parameter z per experiment ~ normal(0, sd = 1)\n let k [1/s] = exp(mu + tau*z)*1 [1/s]\n"),
                    decays());
  for (std::string const& each : severities(run.summary("post"), "flat_direction")) CHECK(each == "note");
}

TEST_CASE("two factors of which the data know the product are, in every experiment") {
  CaseRun const run(hierarchy_text(" parameter a ~ log_uniform(0.001, 1000)\n parameter b ~ log_uniform(0.001, 1000)\n"
                                   " let k [1/s] = a*b*1 [1/s]\n"),
                    decays());
  CHECK(severities(run.summary("post"), "flat_direction") == std::vector<std::string>{"warning"});
}
