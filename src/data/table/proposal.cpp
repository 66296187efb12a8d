// From the look of a file to rules, which are then tried: what is proposed has been seen to work.
#include "data/table/proposal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text/diagnostic.hpp"
#include "core/text/words.hpp"
#include "data/cell/cells.hpp"
#include "data/cell/unit_text.hpp"
#include "data/table/encoding.hpp"
#include "data/table/proposal_steps.hpp"
#include "data/table/table.hpp"

namespace sysid {
namespace {

/// Whether all columns of numbers, and the stamps, can be read so.
bool works(std::string const& bytes, Layout const& layout, ReadingRules const& rules) {
  if (!refuse(rules).empty()) return false;
  try {
    Table const table = Table::parse_as_told("record", bytes, rules);
    if (table.rows() < 2) return false;
    for (std::size_t c = 0; c < layout.columns.size() && c < table.columns().size(); ++c) {
      std::string const& name = table.columns()[c];
      if (layout.looks[c] != CellLook::number || name.empty()) continue;
      if (std::count(table.columns().begin(), table.columns().end(), name) == 1) (void)table.numbers(name);
    }
    return true;
  } catch (UserError const&) {
    return false;
  }
}

}  // namespace

std::vector<std::string> distinct_names(std::vector<std::string> const& names) {
  std::vector<std::string> made;
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string name = names[i].empty() ? fmt::format("column_{}", i + 1) : names[i];
    for (int number = 2; std::find(made.begin(), made.end(), name) != made.end(); ++number)
      name = fmt::format("{}_{}", names[i].empty() ? "column" : names[i], number);
    made.push_back(std::move(name));
  }
  return made;
}

std::optional<Proposal> propose(std::string const& utf8, ReadingRules const& current, ColumnNeeds const& needs) {
  std::optional<Layout> layout = find_layout(utf8);
  if (!layout || layout->rows.size() < 2) return std::nullopt;
  // Half of a record is not proposed: whoever means it says which lines.
  if (layout->broken != 0 && current.first_value == 0 && current.last_value == 0) return std::nullopt;
  if (current.units == UnitsPlace::names)
    for (std::string& column : layout->columns)
      if (auto const split = split_name(column)) column = split->name;
  if (!current.columns.empty() && current.columns.size() == layout->columns.size()) layout->columns = current.columns;
  Proposal proposal;
  Alternatives all;
  all.rules.push_back(current);
  add_lines(utf8, *layout, all.rules.front());
  add_notation(*layout, all);
  for (ReadingRules& rules : all.rules) add_missing(*layout, rules);
  for (ReadingRules& rules : all.rules) add_words_below(utf8, *layout, rules);
  add_stamps(*layout, needs.time, proposal, all);
  std::erase_if(all.rules, [&](ReadingRules const& rules) { return !works(utf8, *layout, rules); });
  if (all.rules.empty()) return std::nullopt;
  proposal.rules = std::move(all.rules);
  proposal.question = proposal.rules.size() > 1 ? std::move(all.question) : std::string();
  proposal.layout = std::move(*layout);
  return proposal;
}

namespace {

/// The statements to add or, where settings that the block has are others, to write in place of its own.
std::string advice(std::vector<ReadingRules> const& rules, ReadingRules const& current) {
  std::vector<std::string> lines;
  bool replaces = false;
  for (ReadingRules const& each : rules) {
    auto const added = added_settings(each, current);
    replaces = replaces || !added;
    lines.push_back(added ? *added : reading_statement(each));
  }
  return fmt::format("{}: {}", replaces ? "replace `read` in the data block by this line" : "add this line to the data block",
                     quoted(lines, "or"));
}

bool leaves_gaps(ProposalRequest const& request, ReadingRules const& rules) {
  if (rules.missing == request.rules.missing) return false;
  try {
    std::vector<double> const values = Table::parse_as_told("record", request.bytes, rules).numbers(request.column);
    return std::any_of(values.begin(), values.end(), [](double value) { return std::isnan(value); });
  } catch (UserError const&) {
    return false;
  }
}

/// Lines below the values, which `values = 7..1006` leaves out.
std::string left_out(Proposal const& proposal, ProposalRequest const& request) {
  int const last = proposal.rules.front().last_value;
  if (last == 0 || last == request.rules.last_value) return {};
  int const below = lines_below(request.bytes, last);
  return fmt::format("; {} below line {} {} then left out", counted(below, "line"), last, below == 1 ? "is" : "are");
}

/// More cells in its rows than in the line of the names, and of digits alone: halves of numbers with a decimal comma.
bool may_have_decimal_commas(Layout const& layout) {
  auto const whole = [](std::string const& cell) { return cell.find('.') == std::string::npos; };
  return layout.separator == ',' && layout.names == 0 &&
         std::all_of(layout.rows.begin(), layout.rows.end(),
                     [&](std::vector<std::string> const& row) { return std::all_of(row.begin(), row.end(), whole); });
}

}  // namespace

int lines_below(std::string const& utf8, int last) {
  int below = 0;
  for (Lines line(utf8); last != 0 && line.next();) below += line.number > last && !trimmed(line.text()).empty();
  return below;
}

int broken_line(std::string const& utf8) {
  auto const layout = find_layout(utf8);
  return layout && layout->rows.size() >= 2 ? layout->broken : 0;
}

std::string proposed_help(ProposalRequest const& request) {
  auto proposal = propose(request.bytes, request.rules, request.needs);
  if (!proposal) return {};
  std::vector<std::string> const& names = proposal->layout.columns;
  // Names for the halves of its numbers would make a record that reads, with wrong values.
  if (request.code == "E4005" && may_have_decimal_commas(proposal->layout)) return {};
  if (request.code == "E4009" || (request.code == "E4008" && request.column.empty())) {
    for (ReadingRules& rules : proposal->rules) rules.columns = distinct_names(names);
  } else if (request.code == "E4008") {
    // The name is there with its unit behind it.
    bool const bare = std::any_of(names.begin(), names.end(), [&](std::string const& name) {
      auto const split = split_name(name);
      return split && split->name == request.column;
    });
    ReadingRules const& rules = proposal->rules.front();
    bool const misread = rules.names != request.rules.names || rules.first_value != request.rules.first_value ||
                         rules.separator != request.rules.separator || rules.columns != request.rules.columns;
    if (!bare && !misread && std::find(names.begin(), names.end(), request.column) == names.end()) return {};
    if (bare)
      for (ReadingRules& rules : proposal->rules) rules.units = UnitsPlace::names, rules.units_line = 0;
  }
  // A column that is there twice is refused next.
  auto const repeated = [&](std::string const& column) { return std::count(names.begin(), names.end(), column) > 1; };
  if (std::any_of(request.needs.columns.begin(), request.needs.columns.end(), repeated))
    for (ReadingRules& rules : proposal->rules) rules.columns = distinct_names(names);
  if (proposal->rules.front() == request.rules && proposal->time.empty()) return {};
  // A line that takes words of an input as missing would be refused next.
  if (request.needs.whole(request.column) && leaves_gaps(request, proposal->rules.front())) return {};
  std::string help = advice(proposal->rules, request.rules);
  if (!proposal->question.empty()) help = fmt::format("{}: choose, and {}", proposal->question, help);
  if (!proposal->time.empty()) help += fmt::format("; the time is `time {}`", quoted_text(proposal->time));
  help += left_out(*proposal, request);
  if (proposal->layout.names == 0 && !proposal->rules.front().columns.empty())
    help += "; put your own names there, in the order of the columns";
  return help;
}

std::optional<std::string> proposed_encoding(std::string const& bytes, ReadingRules const& rules, ColumnNeeds const& needs) {
  auto const encoding = likely_encoding(bytes);
  if (!encoding) return std::nullopt;
  auto const text = to_utf8(bytes, *encoding);
  if (!text) return std::nullopt;
  ReadingRules wanted = rules;
  wanted.encoding = *encoding;
  auto const proposal = propose(*text, wanted, needs);
  if (!proposal) return std::nullopt;
  return advice(proposal->rules, rules);
}

}  // namespace sysid
