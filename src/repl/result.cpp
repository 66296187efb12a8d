// summary.json, draws_N.csv and predict*.csv back into columns.
#include "repl/result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/system/files.hpp"
#include "report/file/number_table.hpp"
#include "report/file/replacement.hpp"
#include "report/file/stored_files.hpp"

namespace sysid::repl {
namespace {

using Json = nlohmann::ordered_json;

/// "y [m], y' [m/s]" by name.
std::map<std::string, std::string> units_of(std::string const& text) {
  std::map<std::string, std::string> units;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t const end = std::min(text.find("], ", at), text.size());
    std::string const one = text.substr(at, end - at);
    at = end + 3;
    auto const bracket = one.rfind(" [");
    if (bracket == std::string::npos) continue;
    // Those before it have no unit, and end in a comma.
    auto const name = one.rfind(", ", bracket);
    std::string unit = one.substr(bracket + 2);
    if (unit.ends_with(']')) unit.pop_back();
    std::size_t const begin = name == std::string::npos ? 0 : name + 2;
    units[one.substr(begin, bracket - begin)] = unit;
  }
  return units;
}

/// Of all channels and experiments; none where no channel has one.
std::optional<double> largest_nmse(Json const& fit) {
  std::optional<double> largest;
  if (!fit.contains("channels")) return largest;
  for (auto const& [experiment, channels] : fit["channels"].items())
    for (auto const& [channel, scores] : channels.items())
      if (scores.contains("nmse") && scores["nmse"].is_number())
        largest = std::max(largest.value_or(0), scores["nmse"].get<double>());
  return largest;
}

RecordSeries read_record(std::filesystem::path const& path) {
  NumberTable const table = read_number_table(path);
  RecordSeries record;
  auto const of_head = [&](std::string const& key) {
    auto const place = table.head.find(key);
    return place == table.head.end() ? std::string() : place->second;
  };
  record.experiment = of_head("experiment");
  record.axis = table.names.front();
  if (record.axis != "t") record.unit.clear();
  record.time = table.columns.front();
  for (double const each : table.columns.back()) record.scored.push_back(each != 0);
  auto const units = units_of(of_head("units"));
  for (std::string const& column : table.names) {
    // The quantity's own band; that with noise has the same name and `_noisy`.
    if (!column.ends_with("_q2.5")) continue;
    std::string const name = column.substr(0, column.size() - 5);
    bool const with_noise = name.ends_with("_noisy") && table.find(name.substr(0, name.size() - 6) + "_mean") != nullptr;
    if (with_noise) continue;
    auto const* mean = table.find(name + "_mean");
    if (mean == nullptr) throw unusable_result(fmt::format("`{}` is damaged", path.string()));
    SeriesColumn quantity{name, "", *mean, {}};
    if (auto const unit = units.find(name); unit != units.end()) quantity.unit = unit->second;
    if (auto const* measured = table.find(name + "_measured")) quantity.measured = *measured;
    record.quantities.push_back(std::move(quantity));
  }
  return record;
}

}  // namespace

DrawColumn const* Result::find_draws(std::string_view name) const {
  auto const place = std::find_if(draws.begin(), draws.end(), [&](DrawColumn const& each) { return each.name == name; });
  return place == draws.end() ? nullptr : &*place;
}

Result read_result(std::filesystem::path const& folder, std::string const& task, TaskKind kind) {
  Result result;
  result.task = task;
  result.kind = kind;
  result.folder = folder;
  Json summary;
  if (summary_stands(folder)) summary = Json::parse(read_whole_summary(folder));
  if (!summary.is_object()) return result;
  if (summary.contains("parameters") && kind == TaskKind::fit)
    for (auto const& [name, each] : summary["parameters"].items()) {
      DrawColumn column{name, interpreted(folder / "summary.json", [&, &of = each] { return of.value("unit", ""); }), {}, {}};
      if (each.contains("sd") && each["sd"].is_number()) column.sd = each["sd"].get<double>();
      result.draws.push_back(std::move(column));
    }
  if (summary.contains("fit") && summary["fit"].is_object()) {
    auto const score = [&](char const* name) -> std::optional<double> {
      auto const& fit = summary["fit"];
      return fit.contains(name) && fit[name].is_number() ? std::optional(fit[name].template get<double>()) : std::nullopt;
    };
    result.nmse = score("nmse");
    result.rmse = score("rmse");
    if (!result.nmse) result.nmse = largest_nmse(summary["fit"]);
  }
  constexpr std::size_t of_sampler = 4;  // columns before the user's
  for (int k = 1; kind == TaskKind::fit && std::filesystem::exists(folder / fmt::format("draws_{}.csv", k)); ++k) {
    NumberTable const table = read_number_table(folder / fmt::format("draws_{}.csv", k));
    if (table.columns.size() != result.draws.size() + of_sampler) continue;
    result.chains.push_back(table.columns.front().size());
    for (std::size_t c = 0; c < result.draws.size(); ++c) {
      std::vector<double> const& column = table.columns[c + of_sampler];
      result.draws[c].values.insert(result.draws[c].values.end(), column.begin(), column.end());
    }
  }
  if (!result.optimum())
    for (DrawColumn& column : result.draws) column.sd.reset();
  if (kind == TaskKind::simulate) return result;  // its record has no bands, whatever its name
  std::vector<std::filesystem::path> records;
  std::error_code ignored;
  for (auto const& entry : std::filesystem::directory_iterator(folder, ignored)) {
    std::string const name = entry.path().filename().string();
    if (name.starts_with("predict") && name.ends_with(".csv")) records.push_back(entry.path());
  }
  std::sort(records.begin(), records.end());
  for (auto const& path : records) result.records.push_back(read_record(path));
  return result;
}

}  // namespace sysid::repl
