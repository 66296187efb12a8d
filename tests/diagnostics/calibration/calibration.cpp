// What a calibration says of ranks that are right, and of each way in which they are wrong.
#include "diagnostics/calibration/calibration.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/numeric/random.hpp"

using namespace sysid;

namespace {

/// Posteriors that are normal(y/2, sd = sqrt(1/2)) of truths from normal(0, 1) with one measurement of sd 1, but for what `wrong`
/// does to mean and sd.
CalibrationReport made(int n, std::function<void(double& mean, double& sd)> const& wrong) {
  std::vector<Replication> records;
  for (int r = 0; r < n; ++r) {
    Stream stream({23, Purpose::test, static_cast<std::uint64_t>(r), 0});
    double const truth = stream.normal(), y = truth + stream.normal();
    double mean = y / 2, sd = std::sqrt(0.5);
    wrong(mean, sd);
    double const below = 0.5 * std::erfc((mean - truth) / sd / std::sqrt(2.0));
    Replication each;
    each.number = r;
    each.places.push_back({truth, mean, sd, below, std::min(99, static_cast<int>(100 * below))});
    records.push_back(each);
  }
  std::reverse(records.begin(), records.end());
  return calibration_of({{"k", "N/m"}}, std::move(records), n, 99);
}

bool has(Findings const& findings, FindingCode code, Severity severity) {
  return std::any_of(findings.begin(), findings.end(),
                     [&](Finding const& each) { return each.code == code && each.severity == severity; });
}

}  // namespace

TEST_CASE("right posteriors are covered as stated, have z of 0 ± 1, and their ranks are uniform") {
  CalibrationReport const right = made(1000, [](double&, double&) {});
  CalibratedQuantity const& k = right.quantities.front();
  CHECK(right.records.front().number == 0);
  for (auto const& [found, stated] : {std::pair{k.covered_50, 0.5}, {k.covered_90, 0.9}, {k.covered_95, 0.95}})
    CHECK(std::fabs(found - stated) < 4 * share_error(stated, 1000));
  CHECK(std::fabs(k.mean_z) < 0.13);
  CHECK(k.sd_z == doctest::Approx(1).epsilon(0.1));
  CHECK(k.contraction == doctest::Approx(0.5).epsilon(0.1));
  CHECK(k.adjusted_p > 0.01);
  CHECK(k.shape == RankShape::uniform);
  CHECK(calibration_findings(right).empty());
  CHECK(right.band_low.size() == 99);
  CHECK(right.band_high.front() > 0);
}

TEST_CASE("records whose solver did not settle are counted") {
  CalibrationReport report;
  report.records.resize(30);
  report.records.front().settled = false;
  CHECK(has(calibration_findings(report), FindingCode::step_not_settled, Severity::note));
  report.records[1].settled = false;
  CHECK(has(calibration_findings(report), FindingCode::step_not_settled, Severity::warning));
}

TEST_CASE("each way of being wrong is found and has its name") {
  struct Way {
    std::function<void(double&, double&)> wrong;
    RankShape shape;
  };
  for (Way const &way : {Way{[](double&, double&sd) { sd *= 0.7; }, RankShape::too_narrow},
                         Way{[](double&, double&sd) { sd *= 1.5; }, RankShape::too_wide},
                         Way{[](double&mean, double&) { mean += 0.3; }, RankShape::too_high},
                         Way{[](double&mean, double&) { mean -= 0.3; }, RankShape::too_low}}) {
    CalibrationReport const found = made(400, way.wrong);
    CHECK(found.quantities.front().shape == way.shape);
    Findings const findings = calibration_findings(found);
    CHECK(has(findings, FindingCode::ranks_not_uniform, Severity::error));
    CHECK(findings.front().names == std::vector<std::string>{"k"});
  }
}

TEST_CASE("fits that fail, fits that fail their checks, dependent draws and prior draws that cannot be simulated are counted") {
  std::vector<Replication> records;
  for (int r = 0; r < 40; ++r) {
    Replication each;
    each.number = r;
    each.redrawn = r % 10 == 0 ? 1 : 0;
    if (r == 7) {
      each.failure = "no finite start";
    } else {
      each.independent = r < 5 ? 50 : 400;
      if (r < 3) each.failed = {"ess_bulk_low"};
      if (r < 6) each.warned = {"piles_up_at_bound"};
      each.places.push_back({0, 0, 1, (r + 0.5) / 40, r * 100 / 40});
    }
    records.push_back(each);
  }
  CalibrationReport const found = calibration_of({{"k", ""}}, records, 40, 99);
  CHECK(found.with_draws() == 39);
  CHECK(found.failed() == 1);
  CHECK(found.quantities.front().ranks.size() == 39);
  REQUIRE(found.checks.size() == 2);
  CHECK(found.checks[0].code == "piles_up_at_bound");
  CHECK(found.checks[0].warned == 6);
  CHECK(found.checks[1].failed == 3);
  Findings const findings = calibration_findings(found);
  CHECK(has(findings, FindingCode::replications_failed, Severity::warning));
  CHECK(has(findings, FindingCode::replications_fail_checks, Severity::warning));
  CHECK(has(findings, FindingCode::ranks_of_dependent_draws, Severity::warning));
  CHECK(has(findings, FindingCode::prior_redrawn, Severity::note));
}

TEST_CASE("nothing is known where no record has a fit") {
  Replication failed;
  failed.failure = "no finite start";
  CalibrationReport const none = calibration_of({{"k", ""}}, {failed}, 1, 99);
  CHECK(none.quantities.front().ranks.empty());
  CHECK(none.quantities.front().adjusted_p == 1);
  CHECK(has(calibration_findings(none), FindingCode::replications_failed, Severity::error));
}
