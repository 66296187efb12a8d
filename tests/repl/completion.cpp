// What Tab offers.
#include "repl/completion.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "dialogue.hpp"

using namespace sysid;

namespace {

/// word: with what is written before the completion begins, in the word or path that it continues.
bool offers(Dialogue& dialogue, std::string const& entry, std::string const& word) {
  auto const found = repl::completions(dialogue.workbench(), entry);
  std::string before = entry.substr(0, found.begin);
  before.erase(0, before.find_last_of(" \t\n\"([") + 1);
  for (std::string const& each : found.words) CHECK_MESSAGE(each.starts_with(entry.substr(found.begin)), each);
  CHECK(std::is_sorted(found.words.begin(), found.words.end()));
  return std::any_of(found.words.begin(), found.words.end(), [&](std::string const& each) { return before + each == word; });
}

}  // namespace

TEST_CASE("an entry begins with a command, a word of the language or a name of a result") {
  Dialogue d;
  CHECK(offers(d, "lo", "load"));
  CHECK(offers(d, "mod", "model"));
  CHECK(offers(d, "pred", "predict"));
  CHECK(offers(d, "par", "parameter"));
  CHECK(offers(d, "quan", "quantile"));
  CHECK_FALSE(offers(d, "lo", "model"));
}

TEST_CASE("names of models, records, parts and results are offered where they stand") {
  Dialogue d;
  d.begin();
  CHECK(offers(d, "first = fit osc", "oscillator"));
  CHECK(offers(d, "first = fit oscillator to ben", "bench"));
  CHECK(offers(d, "first = fit oscillator to bench.", "bench.train"));
  CHECK(offers(d, "change mak", "maker"));
  CHECK(offers(d, "parameter sig", "sigma"));
  REQUIRE(d.enter("first = fit oscillator to bench.train with map"));
  CHECK(offers(d, "mean(f", "fn"));
  CHECK(offers(d, "first.", "first.fn"));
  CHECK(offers(d, "rms(residual(disp", "displacement"));
  CHECK(offers(d, "refit fi", "first"));
}

TEST_CASE("words of the language are offered, in a block its statements") {
  Dialogue d;
  CHECK(offers(d, "model a {\n  par", "parameter"));
  CHECK(offers(d, "model a {\n  input x; sta", "state"));
  CHECK(offers(d, "data a {\n  mea", "measure"));
  CHECK_FALSE(offers(d, "data a {\n  par", "parameter"));
  CHECK(offers(d, "parameter k ~ log_u", "log_uniform"));
  CHECK(offers(d, "first = fit a to b with m", "mh"));
  CHECK(offers(d, "first = fit a to b with mh(burn", "burn_in"));
  CHECK(offers(d, "help log_", "log_uniform"));
}

TEST_CASE("columns of the data file and files of the folder are offered") {
  Dialogue d;
  d.begin();
  std::string const head = "data other {\n file \"" + d.path("results/made/made.csv") + "\"\n";
  CHECK(offers(d, head + " measure displacement = displ", "displacement"));
  CHECK(offers(d, head + " input x = x hold zero", "zero_order"));
  CHECK(offers(d, "measure displacement = displacement_", "displacement_clean"));
  CHECK(offers(d, "data c { file \"" + d.path("results/made/m"), d.path("results/made/made.csv")));
  write_file(d.folder() / "a.sysid", "");
  CHECK(offers(d, "load " + d.path("a"), d.path("a.sysid")));
  CHECK(offers(d, "load " + d.path("res"), d.path("results/")));
}

TEST_CASE("what the language server knows is offered at the prompt: settings, units, choices, names of arguments") {
  Dialogue d;
  d.begin();
  CHECK(offers(d, "parameter k [k", "kg"));
  CHECK(offers(d, "observe displacement ~ normal(y, prec", "precision"));
  CHECK(offers(d, "a = fit oscillator to bench with solver = r", "rk4"));
  CHECK(offers(d, "observe displacement ~ half_", "half_normal") == false);  // no density of noise
  CHECK(offers(d, "use hyst", "hysteresis"));
}

TEST_CASE("what all words begin with is put in, and no character is cut") {
  CHECK(repl::common_beginning({"log_normal", "log_uniform"}) == "log_");
  CHECK(repl::common_beginning({"k\u03b1", "k\u03b2"}) == "k");
  CHECK(repl::common_beginning({}) == "");
}
