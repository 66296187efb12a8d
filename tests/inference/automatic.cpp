// The choice of a sampler: a test for each reason.
#include "inference/automatic.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "inference/targets.hpp"
#include "relative.hpp"
#include "search/global/search.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

/// Standard normal priors; claims to have exact derivatives where asked.
class ChoiceTarget : public TestTarget {
 public:
  ChoiceTarget(int dimension, Residuals residuals, bool exact = true)
      : TestTarget(names(dimension), std::vector<Prior>(static_cast<std::size_t>(dimension), {Prior::normal, 0, 1}), dimension, 0,
                   std::move(residuals)),
        exact_(exact) {}
  DerivativeSource derivatives() const override { return exact_ ? DerivativeSource::exact : DerivativeSource::differences; }

 private:
  static std::vector<std::string> names(int dimension) {
    std::vector<std::string> all;
    for (int p = 0; p < dimension; ++p) all.push_back("p" + std::to_string(p));
    return all;
  }
  bool exact_;
};

void normal_rows(std::vector<double> const& x, std::vector<double>& rows) {
  for (std::size_t p = 0; p < x.size(); ++p) rows[p] = (x[p] - 0.3) / 0.2;
}

/// Each pair of parameters lies along a bend that is much longer than wide.
void bent_rows(std::vector<double> const& x, std::vector<double>& rows) {
  for (std::size_t p = 0; p < x.size(); ++p) rows[p] = p % 2 == 0 ? 0 : (x[p] + 2 * x[p - 1] * x[p - 1] - 0.5) / 0.02;
}

Mode mode(int dimension, double share, double at = 0) {
  auto const count = static_cast<std::size_t>(dimension);
  Mode mode;
  mode.theta = mode.declared = std::vector<double>(count, at);
  mode.sd = std::vector<double>(count, 0.2);
  mode.covariance = std::vector<double>(count * count, 0.0);
  for (std::size_t p = 0; p < count; ++p) mode.covariance[p * count + p] = 0.04;
  mode.share = share;
  return mode;
}

automatic::Choice choose(Target const& target, std::vector<Mode> const& modes) {
  Ledger ledger;
  automatic::Choice choice = automatic::choose(target, modes, 1, ledger);
  CHECK(choice.reason.find('\n') == std::string::npos);
  return choice;
}

bool contains(std::string const& text, std::string const& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("several modes are sampled by tempering where parameters are few, else by mh") {
  auto const few = choose(ChoiceTarget(3, normal_rows), {mode(3, 0.6), mode(3, 0.39, 2), mode(3, 0.005, 4)});
  CHECK(few.backend == "tempering");
  CHECK(contains(few.reason, "2 modes"));
  auto const many = choose(ChoiceTarget(21, normal_rows), {mode(21, 0.6), mode(21, 0.4, 2)});
  CHECK(many.backend == "mh");
  CHECK(contains(many.reason, "2 modes"));
  // Where the normal distributions at the modes are the posterior, moves that are drawn from them jump.
  auto const two_hills = [](std::vector<double> const& x, std::vector<double>& rows) { rows[0] = (x[0] * x[0] - 1) / 0.4; };
  auto const known = choose(ChoiceTarget(1, two_hills), {mode(1, 0.5, 1), mode(1, 0.5, -1)});
  CHECK(known.backend == "mh");
  CHECK(contains(known.reason, "jump between them"));
  // One of a share that is not worth a word is none.
  CHECK(choose(ChoiceTarget(3, normal_rows), {mode(3, 0.995), mode(3, 0.005, 2)}).backend == "mh");
}

TEST_CASE("a flat direction is left to mh, which moves along ridges") {
  Mode flat = mode(3, 1);
  flat.flat = {0.1, -0.1, 0};
  auto const choice = choose(ChoiceTarget(3, normal_rows), {flat});
  CHECK(choice.backend == "mh");
  CHECK(contains(choice.reason, "flat"));
}

TEST_CASE("without derivatives, mh needs none, however many parameters there are") {
  auto const choice = choose(ChoiceTarget(30, bent_rows, false), {mode(30, 1)});
  CHECK(choice.backend == "mh");
  CHECK(contains(choice.reason, "61 simulations for each gradient"));
}

TEST_CASE("a well-defined mode of few parameters is sampled by mh") {
  auto const choice = choose(ChoiceTarget(25, bent_rows), {mode(25, 1)});
  CHECK(choice.backend == "mh");
  CHECK(contains(choice.reason, "25 parameters"));
}

TEST_CASE("many parameters are sampled by mh where their posterior is normal, else by nuts") {
  ChoiceTarget const normal(30, normal_rows), bent(30, bent_rows);
  Bench bench;
  auto const at_mode = [&](Target const& target) { return search(target, ObjectiveKind::posterior, bench.context).modes; };
  auto const by_mh = choose(normal, at_mode(normal));
  CHECK(by_mh.backend == "mh");
  CHECK(contains(by_mh.reason, "independent draws from the posterior"));
  auto const by_nuts = choose(bent, {mode(30, 1)});
  CHECK(by_nuts.backend == "nuts");
  CHECK(contains(by_nuts.reason, "not normal"));
}

TEST_CASE("auto runs what it has chosen, with its defaults") {
  ChoiceTarget const target(2, normal_rows);
  Bench bench;
  Settings const none((std::span<SettingRow const>()));
  FitResult const result = automatic::run(target, none, bench.context);
  REQUIRE_FALSE(result.failure);
  CHECK(result.draws.chains.size() == 4);
  CHECK(result.settings.word("proposal") == "adaptive");
  CHECK(result.summaries.at(0).mean == relative(0.3 / 1.04, 0.02));
}
