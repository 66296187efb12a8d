// By names alone: the numbers of a load and of a temperature look alike.
#include "experiment/crossed_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "data/cell/column_name.hpp"
#include "data/table/reading_rules.hpp"

namespace sysid {
namespace {

struct Binding {
  bool input = false;
  std::string name, column, unit, rule;
  std::string column_name;  // without its unit

  std::string line(std::string const& from) const {
    return fmt::format("`{} {} = {}{}`", input ? "input" : "measure", name, column_text(from, unit),
                       rule.empty() ? "" : " hold " + rule);
  }
};

std::string bare(std::string const& column) {
  if (auto const split = split_name(column)) return split->name;
  if (auto const ended = unit_behind_underscore(column)) return ended->name;
  return column;
}

std::vector<Binding> bindings(DataBlock const& block, Model const& model) {
  auto const has = [](auto const& all, std::string const& name) {
    return std::any_of(all.begin(), all.end(), [&](auto const& each) { return each.name == name; });
  };
  auto const unit = [](ColumnUse const& use) { return use.unit ? use.unit->text : std::string(); };
  std::vector<Binding> all;
  for (DataInputUse const& use : block.inputs)
    if (has(model.inputs, use.input))
      all.push_back({true, use.input, use.column, unit(use), use.rule ? std::string(rule_name(*use.rule)) : "", bare(use.column)});
  for (DataMeasureUse const& use : block.measured)
    if (has(model.channels, use.channel)) all.push_back({false, use.channel, use.column, unit(use), "", bare(use.column)});
  return all;
}

Finding crossed(Binding const& one, Binding const& other, bool exchange, std::string const& data) {
  return {FindingCode::column_used_twice,
          Severity::warning,
          {one.name, data},
          fmt::format("{} is read from column `{}` of {}, and column `{}` is read for {}: the two may be exchanged", one.name,
                      one.column, data, other.column, other.name),
          fmt::format("if so, write {}{}", one.line(other.column), exchange ? " and " + other.line(one.column) : "")};
}

}  // namespace

Findings find_crossed_columns(CheckedFile const& file, ExperimentData const& data, Model const& model) {
  std::vector<Binding> const all = bindings(file.data[static_cast<std::size_t>(data.use.data)], model);
  auto const reads = [&](std::string const& name) {
    return std::find_if(all.begin(), all.end(), [&](Binding const& each) { return each.column_name == name; });
  };
  Findings findings;
  for (auto one = all.begin(); one != all.end(); ++one) {
    if (one->name == one->column_name) continue;
    auto const other = reads(one->name);
    if (other == all.end()) continue;
    bool const mutual = other->name == one->column_name;
    if (mutual ? other < one : one->name.size() < 2) continue;  // two that are exchanged are named once
    findings.push_back(crossed(*one, *other, mutual || reads(other->name) == all.end(), data.use.name));
  }
  return findings;
}

std::vector<ExchangedColumns> exchanged_columns(DataBlock const& block, Model const& model) {
  std::vector<Binding> const all = bindings(block, model);
  std::vector<ExchangedColumns> exchanges;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      Binding const &one = all[i], &other = all[j];
      if (one.column == other.column) return {};
      if (!one.input) continue;  // inputs come first
      ExchangedColumns exchange{block, one.column, other.column, !other.input,
                                one.line(other.column) + " and " + other.line(one.column)};
      auto const exchanged = [&](std::string const& column) {
        return column == one.column ? other.column : column == other.column ? one.column : column;
      };
      for (DataInputUse& use : exchange.block.inputs) use.column = exchanged(use.column);
      for (DataMeasureUse& use : exchange.block.measured) use.column = exchanged(use.column);
      exchanges.push_back(std::move(exchange));
    }
  return exchanges;
}

}  // namespace sysid
