// Numbers of a calibration for programs.
#include "report/file/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/text/number.hpp"
#include "report/file/csv.hpp"
#include "result/report.hpp"

namespace sysid {
namespace {

using Json = nlohmann::ordered_json;

std::string_view word(RankShape shape) {
  switch (shape) {
    case RankShape::too_narrow:
      return "too_narrow";
    case RankShape::too_wide:
      return "too_wide";
    case RankShape::too_low:
      return "too_low";
    case RankShape::too_high:
      return "too_high";
    case RankShape::other:
      return "other";
    case RankShape::uniform:
      break;
  }
  return "uniform";
}

std::string joined(std::vector<std::string> const& codes) { return fmt::format("{}", fmt::join(codes, " ")); }

}  // namespace

Json calibration_json(CalibrationReport const& calibration) {
  Json quantities = Json::object();
  for (CalibratedQuantity const& each : calibration.quantities)
    quantities[each.name] = {{"unit", each.unit},
                             {"coverage_50", each.covered_50},
                             {"coverage_90", each.covered_90},
                             {"coverage_95", each.covered_95},
                             {"mean_z", each.mean_z},
                             {"sd_z", each.sd_z},
                             {"contraction", each.contraction},
                             {"ecdf_p", each.ecdf_p},
                             {"chi_squared_p", each.chi_squared_p},
                             {"adjusted_p", each.adjusted_p},
                             {"ranks_are", word(each.shape)}};
  Json checks = Json::array();
  for (FiredCheck const& each : calibration.checks)
    checks.push_back({{"code", each.code}, {"failed", each.failed}, {"warned", each.warned}});
  int redrawn = 0;
  for (Replication const& each : calibration.records) redrawn += each.redrawn;
  return {{"replications", calibration.replications},
          {"with_draws", calibration.with_draws()},
          {"failed", calibration.failed()},
          {"redrawn", redrawn},
          {"ranked_among", calibration.draws},
          {"bins", calibration.bins},
          {"quantities", quantities},
          {"checks", checks}};
}

std::string ranks_csv(Report const& report) {
  CalibrationReport const& calibration = *report.calibration;
  std::string out = csv_head(report);
  out += "replication,seed,redrawn,independent_draws,failed_checks,warnings,failure";
  for (CalibratedQuantity const& each : calibration.quantities) {
    std::string name = stan_name(each.name);
    std::replace(name.begin(), name.end(), ' ', '_');
    for (char const* what : {"true", "rank", "below", "mean", "sd"}) out += "," + csv_field(name + "_" + what);
  }
  out += '\n';
  for (Replication const& each : calibration.records) {
    std::string failure = each.failure;
    std::replace(failure.begin(), failure.end(), '\n', ' ');
    out += fmt::format("{},{},{},{},{},{},{}", each.number + 1, each.seed, each.redrawn, shortest(each.independent),
                       joined(each.failed), joined(each.warned), csv_field(failure));
    for (std::size_t q = 0; q < calibration.quantities.size(); ++q) {
      if (!each.has_draws()) {
        out += ",,,,,";
        continue;
      }
      TruePlace const& place = each.places[q];
      out += fmt::format(",{},{},{},{},{}", shortest(place.truth), place.rank, shortest(place.below), shortest(place.mean),
                         shortest(place.sd));
    }
    out += '\n';
  }
  return out;
}

}  // namespace sysid
