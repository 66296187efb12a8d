// Names with indices to arrays.
#include "exchange/draws_group.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

namespace sysid {
namespace {

/// "k[2,bench]": base `k`, indices `2` and `bench`.
struct IndexedName {
  std::string base;
  std::vector<std::string> indices;
};

IndexedName taken_apart(std::string const& name) {
  auto const open = name.find('[');
  if (open == std::string::npos || name.back() != ']') return {name, {}};
  IndexedName result{name.substr(0, open), {""}};
  for (char const c : name.substr(open + 1, name.size() - open - 2)) {
    if (c == ',')
      result.indices.emplace_back();
    else if (c != ' ')
      result.indices.back() += c;
  }
  return result;
}

std::optional<std::int64_t> integer(std::string const& text) {
  std::int64_t value = 0;
  auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// Columns of the draws that make one array, by rows over its own dimensions.
struct ArrayOfColumns {
  std::string name, unit;
  std::vector<std::vector<std::string>> labels;  // per dimension
  std::vector<std::size_t> columns;
};

/// The columns `members`, all of one base, as one array; nothing where they are no full grid.
std::optional<ArrayOfColumns> grid(Draws const& draws, std::vector<IndexedName> const& names,
                                   std::vector<std::size_t> const& members) {
  IndexedName const& first = names[members.front()];
  ArrayOfColumns array{first.base, draws.units[members.front()], {}, {}};
  array.labels.resize(first.indices.size());
  for (std::size_t const m : members) {
    if (names[m].indices.size() != first.indices.size() || draws.units[m] != array.unit) return std::nullopt;
    for (std::size_t d = 0; d < array.labels.size(); ++d)
      if (std::find(array.labels[d].begin(), array.labels[d].end(), names[m].indices[d]) == array.labels[d].end())
        array.labels[d].push_back(names[m].indices[d]);
  }
  std::size_t size = 1;
  for (auto const& labels : array.labels) size *= labels.size();
  if (size != members.size()) return std::nullopt;
  array.columns.assign(size, draws.names.size());
  for (std::size_t const m : members) {
    std::size_t place = 0;
    for (std::size_t d = 0; d < array.labels.size(); ++d) {
      auto const& labels = array.labels[d];
      place = place * labels.size() +
              static_cast<std::size_t>(std::find(labels.begin(), labels.end(), names[m].indices[d]) - labels.begin());
    }
    array.columns[place] = m;
  }
  if (std::find(array.columns.begin(), array.columns.end(), draws.names.size()) != array.columns.end()) return std::nullopt;
  return array;
}

std::vector<ArrayOfColumns> arrays(Draws const& draws) {
  std::vector<IndexedName> names;
  for (std::string const& name : draws.names) names.push_back(taken_apart(name));
  std::vector<bool> done(names.size(), false);
  std::vector<ArrayOfColumns> all;
  for (std::size_t c = 0; c < names.size(); ++c) {
    if (done[c]) continue;
    std::vector<std::size_t> members;
    for (std::size_t m = c; m < names.size(); ++m)
      if (names[m].base == names[c].base) members.push_back(m);
    if (auto array = grid(draws, names, members)) {
      all.push_back(std::move(*array));
    } else {
      for (std::size_t const m : members) all.push_back({draws.names[m], draws.units[m], {}, {m}});
    }
    for (std::size_t const m : members) done[m] = true;
  }
  return all;
}

/// The coordinates of an array's dimension: numbers where all labels are, else words. Experiments share a dimension.
std::string add_label_dimension(NetcdfGroup& group, std::string const& array, std::size_t place,
                                std::vector<std::string> const& labels, std::vector<std::string>& experiments) {
  std::vector<std::int64_t> numbers;
  for (std::string const& label : labels)
    if (auto const number = integer(label)) numbers.push_back(*number);
  std::string name = array + "_dim_" + std::to_string(place);
  if (numbers.size() == labels.size()) {
    group.add_dimension({name, {}, numbers, {}});
    return name;
  }
  if (experiments.empty()) experiments = labels;
  if (experiments == labels) name = "experiment";
  group.add_dimension({name, {}, labels, {}});
  return name;
}

}  // namespace

std::string netcdf_unit(std::string const& unit) {
  constexpr std::array spans = {"days", "hours", "minutes", "seconds", "milliseconds", "microseconds", "nanoseconds"};
  bool const span = std::find(spans.begin(), spans.end(), unit) != spans.end();
  return span ? unit.substr(0, unit.size() - 1) : unit;
}

Attributes unit_attribute(std::string const& unit) {
  return unit.empty() ? Attributes{} : Attributes{{"units", netcdf_unit(unit)}};
}

void add_chain_dimensions(NetcdfGroup& group, std::size_t chains, std::size_t draws) {
  for (auto const& [name, count] : {std::pair("chain", chains), std::pair("draw", draws)}) {
    std::vector<std::int64_t> numbers;
    for (std::size_t i = 0; i < count; ++i) numbers.push_back(static_cast<std::int64_t>(i));
    group.add_dimension({name, {}, std::move(numbers), {}});
  }
}

void add_draws(NetcdfGroup& group, Draws const& draws) {
  std::size_t const length = draws.chains.empty() ? 0 : draws.chains.front().values.size();
  add_chain_dimensions(group, draws.chains.size(), length);
  std::vector<ArrayOfColumns> const all = arrays(draws);
  // Dimensions first: a parameter that has the name of one of them makes way.
  std::vector<std::string> experiments;
  std::vector<std::vector<std::string>> dimensions;
  for (ArrayOfColumns const& array : all) {
    dimensions.push_back({"chain", "draw"});
    for (std::size_t d = 0; d < array.labels.size(); ++d)
      dimensions.back().push_back(add_label_dimension(group, array.name, d, array.labels[d], experiments));
  }
  for (std::size_t a = 0; a < all.size(); ++a) {
    std::vector<double> values;
    values.reserve(draws.total() * all[a].columns.size());
    for (Chain const& chain : draws.chains)
      for (auto const& draw : chain.values)
        for (std::size_t const column : all[a].columns) values.push_back(draw[column]);
    group.add({all[a].name, dimensions[a], std::move(values), unit_attribute(all[a].unit)});
  }
}

}  // namespace sysid
