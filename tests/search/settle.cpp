// Searches that end at bounds, on rough densities, and those that do not arrive.
#include "search/settle.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>

#include "inference/optimum.hpp"
#include "inference/targets.hpp"
#include "linear_algebra/decompositions.hpp"
#include "search/global/search.hpp"
#include "search/local_searches.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

constexpr int columns = 4, rows = 6;

/// A linear least-squares problem whose columns nearly repeat: valleys a hundred times as long as wide, across bounds.
Eigen::MatrixXd design() {
  Eigen::MatrixXd a(rows, columns);
  for (int r = 0; r < rows; ++r)
    for (int p = 0; p < columns; ++p) a(r, p) = 30 * std::exp(-0.3 * (p + 1) * (r + 1));
  return a;
}

Eigen::VectorXd measured() {
  Eigen::VectorXd y(rows);
  y << 61, 30, 19, 11, 8, 5;
  return y;
}

/// rough: the residuals of a solver that chooses its steps, as a part of their size.
class Box4 : public TestTarget {
 public:
  explicit Box4(double rough)
      : TestTarget({"a", "b", "c", "d"}, std::vector<Prior>(columns, {Prior::uniform, 0, 1.5}), rows, 0,
                   [rough, a = design(), y = measured()](std::vector<double> const& w, std::vector<double>& r) {
                     double chance = 0;
                     for (int i = 0; i < rows; ++i) {
                       double model = 0;
                       for (int p = 0; p < columns; ++p) {
                         model += a(i, p) * w[static_cast<std::size_t>(p)];
                         chance =
                             std::fmod(31.7 * chance + 1e9 * std::fabs(std::sin(1e7 * w[static_cast<std::size_t>(p)] + i)), 1.0);
                       }
                       r[static_cast<std::size_t>(i)] = y(i) - model * (1 + rough * (chance - 0.5));
                     }
                   }),
        rough_(rough) {}
  double roughness() const override { return rough_; }

 private:
  double rough_;
};

/// The best of all ways to hold some parameters at bounds.
double highest() {
  Eigen::MatrixXd const a = design();
  double best = -infinity;
  for (int way = 0; way < 81; ++way) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(columns), y = measured();
    std::vector<Eigen::Index> free;
    for (int p = 0, code = way; p < columns; ++p, code /= 3) {
      if (code % 3 == 2) free.push_back(p);
      if (code % 3 == 1) x(p) = 1.5;
    }
    y -= a * x;
    if (!free.empty()) {
      Eigen::MatrixXd const part = a(Eigen::all, free);
      x(free) = solve_symmetric(part.transpose() * part, part.transpose() * y);
      if (x.minCoeff() < -1e-12 || x.maxCoeff() > 1.5 + 1e-12) continue;
    }
    best = std::max(best, -0.5 * (measured() - a * x).squaredNorm());
  }
  return best;
}

/// The density rises towards each of many edges and falls back there: what slopes promise is nowhere.
TestTarget saw() {
  return TestTarget({"x"}, {{Prior::uniform, 0, 1}}, 1, 0, [](std::vector<double> const& x, std::vector<double>& r) {
    double const teeth = 1000 * x[0];
    r[0] = 1 - 0.5 * (teeth - std::floor(teeth));
  });
}

bool has(Findings const& findings, FindingCode code) {
  return std::any_of(findings.begin(), findings.end(), [&](Finding const& each) { return each.code == code; });
}

}  // namespace

TEST_CASE("an optimum at several bounds is reached to a thousandth of its log density, also on a rough one") {
  for (double const rough : {0.0, 1e-6}) {
    CAPTURE(rough);
    Box4 const target(rough);
    Bench bench(3);
    SearchResult const result = search(target, ObjectiveKind::likelihood, bench.context);
    REQUIRE_FALSE(result.modes.empty());
    CHECK(result.modes.front().log_density > highest() - (rough > 0 ? 0.01 : 0.001));
    CHECK(result.modes.front().gain < large_gain);
  }
}

TEST_CASE("a search that has not arrived fails its fit, one that has does not") {
  Bench ragged, smooth;
  FitResult const stuck = optimum::run_ml(saw(), Settings{}, ragged.context);
  CHECK(has(stuck.findings, FindingCode::optimum_not_reached));
  FitResult const arrived = optimum::run_ml(Box4(0), Settings{}, smooth.context);
  CHECK_FALSE(has(arrived.findings, FindingCode::optimum_not_reached));
  CHECK(has(arrived.findings, FindingCode::at_bound));
}

TEST_CASE("settling moves a climber that is held up at a bound, counts what it costs, and leaves one that has arrived") {
  Box4 const target(0);
  Objective const objective = make_objective(target, ObjectiveKind::likelihood, 1, 0);
  Ledger ledger;
  LaneArray declared(columns, 1), theta(columns, 1);
  for (int p = 0; p < columns; ++p) declared(p, 0) = 1e-5;
  target.unconstrain(declared, theta);
  std::vector<Climber> climbers = {climber_at(column(theta, 0), objective.log_density(theta, ledger)[0])};
  std::uint64_t const before = ledger.solves();
  settle(objective, climbers, settling_rounds, ledger, {});
  CHECK(climbers[0].log_density > highest() - 1e-3);
  CHECK(climbers[0].gain < small_gain);
  CHECK(ledger.solves() > before);
  Eigen::VectorXd const at = climbers[0].theta;
  std::uint64_t const after = ledger.solves();
  settle(objective, climbers, settling_rounds, ledger, {});
  CHECK(climbers[0].theta == at);
  CHECK(ledger.solves() == after);
}

TEST_CASE("ml reports another optimum of nearly the same likelihood, and none where there is one") {
  // A square is measured: both roots are as likely, but for a little.
  auto const rooted = [](bool both) {
    return TestTarget({"x"}, {{Prior::uniform, -3, 3}}, 2, 0, [=](std::vector<double> const& x, std::vector<double>& r) {
      r[0] = (x[0] * x[0] - 1) / 0.1;
      r[1] = both ? 0.5 * (x[0] - 1) : 20 * (x[0] - 1);
    });
  };
  Bench two, one;
  SearchResult const twice = search(rooted(true), ObjectiveKind::likelihood, two.context);
  REQUIRE(has(twice.findings, FindingCode::second_mode));
  CAPTURE(twice.findings.front().message);
  CHECK(twice.findings.front().message.find("(log likelihood lower by 0.5): x = -0.9") != std::string::npos);
  CHECK_FALSE(has(search(rooted(false), ObjectiveKind::likelihood, one.context).findings, FindingCode::second_mode));
}

TEST_CASE("modes are ranked by what is asked for, with their shares of it") {
  Mode high, heavy;
  high.log_density = 2, high.log_mass = 0;
  heavy.log_density = 1, heavy.log_mass = 3;
  std::vector<Mode> modes = {heavy, high};
  rank(ObjectiveKind::likelihood, modes);
  CHECK(modes[0].log_density == 2);
  CHECK(modes[0].share == doctest::Approx(1 / (1 + std::exp(-1.0))));
  rank(ObjectiveKind::posterior, modes);
  CHECK(modes[0].log_mass == 3);
  CHECK(modes[0].share == doctest::Approx(1 / (1 + std::exp(-3.0))));
}
