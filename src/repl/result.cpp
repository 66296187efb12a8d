// summary.json, draws_N.csv and predict*.csv back into columns.
#include "repl/result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/files.hpp"

namespace sysid::repl {
namespace {

using Json = nlohmann::ordered_json;

double number(std::string_view text) {
  double value = std::nan("");
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

std::vector<std::string> cells_of(std::string_view line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (char const c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return cells;
}

/// A table of the program's own: comments in the head alone, one header, numbers.
struct Table {
  std::map<std::string, std::string> head;  // "experiment" of `# experiment = bench`
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;

  std::vector<double> const* find(std::string const& name) const {
    auto const place = std::find(names.begin(), names.end(), name);
    return place == names.end() ? nullptr : &columns[static_cast<std::size_t>(place - names.begin())];
  }
};

Table read_table(std::filesystem::path const& path) {
  std::string const text = read_file(path);
  Table table;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t const end = std::min(text.find('\n', at), text.size());
    std::string_view const line = std::string_view(text).substr(at, end - at);
    at = end + 1;
    if (line.starts_with("# ")) {
      auto const equals = line.find(" = ");
      if (equals != std::string_view::npos) table.head[std::string(line.substr(2, equals - 2))] = line.substr(equals + 3);
    } else if (table.names.empty()) {
      table.names = cells_of(line);
      table.columns.resize(table.names.size());
    } else if (!line.empty()) {
      std::size_t from = 0;
      for (std::vector<double>& column : table.columns) {
        std::size_t const comma = std::min(line.find(',', from), line.size());
        column.push_back(from <= line.size() ? number(line.substr(from, comma - from)) : std::nan(""));
        from = comma + 1;
      }
    }
  }
  return table;
}

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

RecordSeries read_record(std::filesystem::path const& path) {
  Table const table = read_table(path);
  RecordSeries record;
  auto const of_head = [&](std::string const& key) {
    auto const place = table.head.find(key);
    return place == table.head.end() ? std::string() : place->second;
  };
  record.experiment = of_head("experiment");
  if (table.names.empty()) return record;
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
    SeriesColumn quantity{name, "", *table.find(name + "_mean"), {}};
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

Result read_result(std::filesystem::path const& folder, std::string const& task, std::string const& verb) {
  Result result;
  result.task = task;
  result.verb = verb;
  result.folder = folder;
  Json summary;
  if (std::filesystem::exists(folder / "summary.json")) summary = Json::parse(read_file(folder / "summary.json"), nullptr, false);
  if (!summary.is_object()) return result;
  if (summary.contains("parameters") && verb == "fit")
    for (auto const& [name, each] : summary["parameters"].items()) {
      DrawColumn column{name, each.value("unit", ""), {}, {}};
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
  }
  constexpr std::size_t of_sampler = 4;  // columns before the user's
  for (int k = 1; verb == "fit" && std::filesystem::exists(folder / fmt::format("draws_{}.csv", k)); ++k) {
    Table const table = read_table(folder / fmt::format("draws_{}.csv", k));
    if (table.columns.size() != result.draws.size() + of_sampler) continue;
    result.chains.push_back(table.columns.front().size());
    for (std::size_t c = 0; c < result.draws.size(); ++c) {
      std::vector<double> const& column = table.columns[c + of_sampler];
      result.draws[c].values.insert(result.draws[c].values.end(), column.begin(), column.end());
    }
  }
  if (!result.optimum())
    for (DrawColumn& column : result.draws) column.sd.reset();
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
