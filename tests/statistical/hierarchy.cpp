// Members of hierarchies in coordinates that the data choose: simulation-based calibration of the whole way from the search to the
// draws, as tests/inference/calibration.cpp does it for samplers alone.
#include <doctest/doctest.h>

#include <algorithm>
#include <memory>

#include "inference/chain/mh.hpp"
#include "inference/chain/tempering.hpp"
#include "inference/nuts/nuts.hpp"
#include "inference/targets.hpp"
#include "load/load.hpp"
#include "replications.hpp"
#include "search/hierarchy/standardised.hpp"

namespace sysid::testing::hierarchy {
namespace {

constexpr int members = 8;
// Of one measurement of each: some know their member far better than a spread of 1 does, some far worse.
constexpr double noise[members] = {0.05, 0.2, 0.5, 0.7, 1, 2, 4, 10};

ParameterSpace space_of(std::string const& prior, std::vector<MemberCoordinate> standardised = {}) {
  Source source("case.sysid",
                "model m {\ninput x\nstate y\ninitial y = 0\n"
                "parameter mu ~ normal(0, sd = 1)\nparameter tau ~ half_normal(1)\n"
                "parameter k per experiment ~ " +
                    prior + "\ny' = x\nobserve level ~ normal(y, sd = 1)\n}\n");
  Diagnostics diagnostics;
  auto file = load(source, diagnostics);
  REQUIRE_MESSAGE(file, render(diagnostics, source));
  std::vector<ExperimentMember> experiments;
  for (int e = 0; e < members; ++e) experiments.push_back({std::string(1, static_cast<char>('a' + e)), {}});
  return {file->models.front(), experiments, std::move(standardised)};
}

/// mu, tau, then the members; of each member a normal measurement, of its logarithm where that is what moves.
class HierarchyTarget : public Target {
 public:
  HierarchyTarget(ParameterSpace space, std::vector<double> data, bool logarithmic)
      : space_(std::move(space)), data_(std::move(data)), logarithmic_(logarithmic) {}
  int dimension() const override { return space_.dimension(); }
  std::span<ParameterInfo const> parameters() const override { return space_.infos(); }
  void sample_prior(StreamKey key, Lanes theta) const override { space_.sample_prior(key, theta); }
  void log_prior(ConstLanes theta, std::span<double> out, bool jacobian) const override { space_.log_prior(theta, out, jacobian); }
  void log_prior_gradient(ConstLanes theta, std::span<double> out, Lanes gradient, bool) const override {
    REQUIRE(space_.log_prior_gradient(theta, out, gradient));
  }
  void log_likelihood(ConstLanes theta, std::span<double> out, Ledger& ledger) const override {
    LaneArray rows(members, theta.width());
    residuals(theta, rows, ledger);
    for (int w = 0; w < theta.width(); ++w) {
      double sum = 0;
      for (int r = 0; r < members; ++r) sum += rows(r, w) * rows(r, w);
      out[static_cast<std::size_t>(w)] = std::isfinite(sum) ? -0.5 * sum : -infinity;
    }
  }
  int residual_count() const override { return members; }
  void residuals(ConstLanes theta, Lanes out, Ledger& ledger) const override {
    ledger.add_solves(static_cast<std::uint64_t>(theta.width()));
    LaneArray declared(theta.rows(), theta.width());
    space_.constrain(theta, declared);
    for (int r = 0; r < members; ++r)
      for (int w = 0; w < theta.width(); ++w) {
        double const value = logarithmic_ ? elementary::log(declared(2 + r, w)) : declared(2 + r, w);
        out(r, w) = (data_[static_cast<std::size_t>(r)] - value) / noise[r];
        if (!std::isfinite(out(r, w))) out(r, w) = infinity;
      }
  }
  void constrain(ConstLanes theta, Lanes declared) const override { space_.constrain(theta, declared); }
  void unconstrain(ConstLanes declared, Lanes theta) const override { space_.unconstrain(declared, theta); }

 private:
  ParameterSpace space_;
  std::vector<double> data_;
  bool logarithmic_;
};

using Run = FitResult (*)(Target const&, Settings const&, RunContext&);

/// The whole way: modes in declared coordinates, then in those that are chosen, then draws there.
FitResult fit(std::string const& prior, std::vector<double> const& data, bool logarithmic, Settings const& settings, Run run,
              std::uint64_t seed) {
  ParameterSpace const space = space_of(prior);
  Bench bench(seed);
  auto const make = [&](std::vector<MemberCoordinate> const& standardised) -> std::unique_ptr<Target> {
    return std::make_unique<HierarchyTarget>(space_of(prior, standardised), data, logarithmic);
  };
  StandardisedSearch const found =
      follow_members(space, search(*make(non_centred(space)), ObjectiveKind::posterior, bench.context), make, bench.context);
  CHECK(found.coordinates.size() == members);
  bench.context.modes = found.found.modes;
  std::unique_ptr<Target> const target = make(found.coordinates);
  return run(*target, settings, bench.context);
}

/// The largest chi-square over the parameters of ranks in five bins: of 4 degrees of freedom.
double worst_chi_square(std::string const& prior, bool logarithmic, Settings const& settings, Run run) {
  constexpr std::size_t bins = 5;
  int const count = replications(10, 100);
  ParameterSpace const space = space_of(prior);
  std::vector<std::vector<int>> ranks(static_cast<std::size_t>(space.dimension()), std::vector<int>(bins));
  for (int r = 0; r < count; ++r) {
    LaneArray theta(space.dimension(), 1), truth(space.dimension(), 1);
    space.sample_prior({98, Purpose::test, static_cast<std::uint64_t>(r), 0}, theta);
    space.constrain(theta, truth);
    Stream stream({97, Purpose::test, static_cast<std::uint64_t>(r), 0});
    std::vector<double> data;
    for (int e = 0; e < members; ++e)
      data.push_back((logarithmic ? elementary::log(truth(2 + e, 0)) : truth(2 + e, 0)) + noise[e] * stream.normal());
    FitResult const result = fit(prior, data, logarithmic, settings, run, static_cast<std::uint64_t>(r) + 1);
    REQUIRE_FALSE(result.failure);
    for (int p = 0; p < space.dimension(); ++p) {
      std::size_t below = 0, all = 0;
      for (Chain const& chain : result.draws.chains)
        for (auto const& draw : chain.values) {
          below += draw[static_cast<std::size_t>(p)] < truth(p, 0);
          ++all;
        }
      ++ranks[static_cast<std::size_t>(p)][std::min(bins - 1, below * bins / all)];
    }
  }
  double worst = 0;
  for (auto const& each : ranks) {
    double sum = 0, expected = static_cast<double>(count) / bins;
    for (int const n : each) sum += (n - expected) * (n - expected) / expected;
    worst = std::max(worst, sum);
  }
  MESSAGE("worst chi-square " << worst);
  return worst;
}

// Exceeded once in 10,000 times.
constexpr double chi_square_limit = 23.5;

}  // namespace

TEST_CASE("ranks of a hierarchy of eight, some known well and some hardly, are uniform in the coordinates that the data choose") {
  struct Case {
    char const* name;
    char const* prior;
    bool logarithmic;
  };
  for (Case const each : {Case{"normal members", "normal(mu, sd = tau)", false},
                          Case{"log-normal members", "log_normal(log_mean = mu, log_sd = tau)", true}})
    DOCTEST_SUBCASE(each.name) {
      bool const many = full_size();
      Settings trajectories(nuts::settings());
      trajectories.set("samples", std::int64_t{many ? 600 : 300});
      trajectories.set("burn_in", std::int64_t{many ? 300 : 200});
      CHECK(worst_chi_square(each.prior, each.logarithmic, trajectories, &nuts::run) < chi_square_limit);
      // An ordinary run has walks and replicas on one kind of members each: coordinates are chosen alike for all samplers.
      if (many || !each.logarithmic) {
        Settings chains(mh::settings());
        chains.set("samples", std::int64_t{many ? 6000 : 3000});
        chains.set("burn_in", std::int64_t{many ? 1000 : 700});
        CHECK(worst_chi_square(each.prior, each.logarithmic, chains, &mh::run) < chi_square_limit);
      }
      if (many || each.logarithmic) {
        Settings replicas(tempering::settings());
        replicas.set("samples", std::int64_t{many ? 2500 : 1300});
        replicas.set("burn_in", std::int64_t{many ? 500 : 400});
        replicas.set("temperatures", std::int64_t{6});
        CHECK(worst_chi_square(each.prior, each.logarithmic, replicas, &tempering::run) < chi_square_limit);
      }
    }
}

}  // namespace sysid::testing::hierarchy
