// From the look of a file to rules, which are then tried: what is proposed has been seen to work.
#include "data/table/proposal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/text/diagnostic.hpp"
#include "core/text/words.hpp"
#include "data/cell/cells.hpp"
#include "data/cell/doubtful_number.hpp"
#include "data/cell/number_notation.hpp"
#include "data/cell/time_stamp.hpp"
#include "data/cell/unit_text.hpp"
#include "data/cell/usual_stamps.hpp"
#include "data/table/encoding.hpp"
#include "data/table/table.hpp"

namespace sysid {
namespace {

/// Rules of which one may be right, and what to ask.
struct Alternatives {
  std::vector<ReadingRules> rules;
  std::string question;
};

template <class OnNumber>
void each_number(Layout const& layout, OnNumber on_number) {
  for (std::vector<std::string> const& row : layout.rows)
    for (std::size_t c = 0; c < row.size() && c < layout.looks.size(); ++c)
      if (layout.looks[c] == CellLook::number) on_number(row[c]);
}

/// Decimal sign and groups, from all numbers of the file.
void add_notation(Layout const& layout, Alternatives& all) {
  std::set<char> decimals, thousands, either;
  std::string doubtful;
  each_number(layout, [&](std::string const& cell) {
    NotationEvidence const evidence = notation_of(cell);
    if (evidence.decimal != 0) decimals.insert(evidence.decimal);
    if (evidence.thousands != 0) thousands.insert(evidence.thousands);
    if (evidence.either != 0) either.insert(evidence.either), doubtful = cell;
  });
  if (decimals.size() > 1 || thousands.size() > 1) return;  // no file is written so
  ReadingRules& rules = all.rules.front();
  if (rules.decimal_given || rules.thousands != 0) {
    // The block says one of the two; the other follows.
    if (!thousands.empty() && rules.thousands == 0) rules.thousands = *thousands.begin();
    for (char const sign : either)
      if (sign != rules.decimal && rules.thousands == 0) rules.thousands = sign;
    if (rules.thousands == rules.decimal) rules.decimal = rules.decimal == '.' ? ',' : '.', rules.decimal_given = true;
    return;
  }
  if (!thousands.empty()) rules.thousands = *thousands.begin();
  char decimal = decimals.empty() ? 0 : *decimals.begin();
  if (decimal == 0 && (rules.thousands == '.' || rules.thousands == ',')) decimal = rules.thousands == '.' ? ',' : '.';
  if (decimal != 0) {
    rules.decimal = decimal;
    rules.decimal_given = decimal == ',';
    for (char const sign : either)
      if (sign != decimal) rules.thousands = sign;
    return;
  }
  if (either.size() == 1 && *either.begin() == ',') {
    ReadingRules grouped = rules;
    rules.decimal = ',';
    rules.decimal_given = true;
    grouped.thousands = ',';
    all.rules.push_back(grouped);
    std::string plain = doubtful;
    std::replace(plain.begin(), plain.end(), ',', '.');
    std::string without = doubtful;
    std::erase(without, ',');
    all.question = fmt::format("`{}` may be {} or {}", doubtful, plain, without);
  }
}

/// Words without digits, `OVLD`, in at most a quarter of the cells.
std::vector<std::string> few_words(std::vector<std::string> const& cells) {
  constexpr std::size_t longest = 16, share = 4;
  std::vector<std::string> words;
  for (std::string const& cell : cells)
    if (!cell.empty() && cell != "NA" && cell.size() <= longest && cell.find_first_of("0123456789") == std::string::npos)
      words.push_back(cell);
  if (words.size() * share > cells.size()) return {};
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());
  return words;
}

/// The same of lines beyond those that were looked at.
void add_words_below(std::string const& bytes, Layout const& layout, ReadingRules& rules) {
  if (layout.last != 0 || !refuse(rules).empty()) return;
  std::size_t constexpr most_words = 6;
  try {
    Table const table = Table::parse_as_told("record", bytes, rules);
    for (std::size_t c = 0; c < layout.columns.size() && c < table.columns().size(); ++c) {
      if (layout.looks[c] != CellLook::number) continue;
      for (std::string const& word : few_words(table.texts(static_cast<int>(c), table.rows())))
        if (std::find(rules.missing.begin(), rules.missing.end(), word) == rules.missing.end() && rules.missing.size() < most_words)
          rules.missing.push_back(word), rules.asked_for_missing = true;
    }
  } catch (UserError const&) {
    return;  // what cannot be read so is not proposed
  }
}

/// Words in place of numbers, as they are written.
void add_missing(Layout const& layout, ReadingRules& rules) {
  constexpr std::size_t most_words = 6;
  std::vector<std::string> words = rules.missing;
  auto const add = [&](std::string const& word) {
    if (std::find(words.begin(), words.end(), word) == words.end() && words.size() < most_words) words.push_back(word);
  };
  each_number(layout, [&](std::string const& cell) {
    if (look_of(cell) == CellLook::gap && cell != "NA") add(cell);
  });
  for (std::size_t c = 0; c < layout.columns.size(); ++c) {
    if (layout.looks[c] != CellLook::number) continue;
    std::vector<std::string> cells;
    for (std::vector<std::string> const& row : layout.rows) cells.push_back(row[c]);
    for (std::string const& word : few_words(cells)) add(word);
  }
  if (!rules.asked_for_missing) {
    NumberNotation const notation{rules.decimal, rules.thousands, words};
    for (std::size_t c = 0; c < layout.columns.size(); ++c) {
      if (layout.looks[c] != CellLook::number) continue;
      std::vector<double> values;
      for (std::vector<std::string> const& row : layout.rows) {
        double value = 0;
        values.push_back(parse_cell(row[c], notation, value) == CellKind::number ? value : std::nan(""));
      }
      for (DoubtfulNumber const& each : doubtful_numbers(values)) add(fmt::format("{}", each.value));
    }
  }
  if (words.empty()) return;
  rules.missing = words;
  rules.asked_for_missing = true;
}

std::vector<std::string> filled_cells(Layout const& layout, std::size_t column) {
  std::vector<std::string> cells;
  for (std::vector<std::string> const& row : layout.rows)
    if (!row[column].empty()) cells.push_back(row[column]);
  return cells;
}

/// Whether the same stamp stands in rows that follow each other: a date beside a time of day.
bool is_date(std::vector<std::string> const& cells) {
  auto const patterns = patterns_of(cells);
  return !patterns.empty() && cells.front().find(':') == std::string::npos;
}
bool is_time_of_day(std::vector<std::string> const& cells) {
  auto const patterns = patterns_of(cells);
  if (patterns.empty()) return false;
  auto const pattern = StampPattern::parse(patterns.front());
  return pattern && !pattern->has_date();
}

std::optional<std::size_t> index_of(Layout const& layout, std::string const& column) {
  auto const found = std::find(layout.columns.begin(), layout.columns.end(), column);
  if (found == layout.columns.end()) return std::nullopt;
  return static_cast<std::size_t>(found - layout.columns.begin());
}

void add_stamps(Layout const& layout, Proposal& proposal, Alternatives& all) {
  std::string const wanted = all.rules.front().time_column;
  if (wanted.empty() || !all.rules.front().stamp.empty()) return;
  auto column = index_of(layout, wanted);
  if (!column || layout.looks[*column] != CellLook::stamp) return;
  std::vector<std::string> cells = filled_cells(layout, *column);
  std::optional<std::size_t> date;
  for (std::size_t c = 0; c < layout.columns.size(); ++c) {
    if (c == *column || layout.looks[c] != CellLook::stamp || layout.columns[c].empty()) continue;
    std::vector<std::string> const others = filled_cells(layout, c);
    if (others.size() != cells.size()) continue;
    if (is_date(cells) && is_time_of_day(others)) {  // the other way about: the time of day is the time
      proposal.time = layout.columns[c];
      date = column;
      column = c;
      cells = others;
      break;
    }
    if (is_time_of_day(cells) && is_date(others)) {
      date = c;
      break;
    }
  }
  if (date) {
    std::vector<std::string> const dates = filled_cells(layout, *date);
    for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = dates[i] + " " + cells[i];
  }
  std::vector<std::string> const patterns = patterns_of(cells);
  if (patterns.empty()) return;
  std::vector<ReadingRules> made;
  for (ReadingRules const& rules : all.rules)
    for (std::string const& pattern : patterns) {
      made.push_back(rules);
      made.back().stamp = pattern;
      if (date) made.back().date = layout.columns[*date];
    }
  if (patterns.size() > 1) all.question += (all.question.empty() ? "" : "; ") + question_of(patterns, cells);
  all.rules = std::move(made);
}

/// The line of the names that is taken when nothing is said, and the separator found there.
struct Unsaid {
  int names = 0;
  char separator = ',';
};
Unsaid unsaid(std::string const& bytes) {
  Lines line(bytes);
  char stated = 0;
  while (line.next()) {
    std::string_view const bare = trimmed(line.text(), cell_blanks);
    if (auto const separator = stated_separator(line.text()); separator && line.number == 1) {
      stated = separator->front();
      continue;
    }
    if (!bare.empty() && !bare.starts_with('#')) return {line.number, stated != 0 ? stated : find_separator(line.text())};
  }
  return {};
}

/// Else the first line is taken for names where `values` does not say otherwise.
bool all_are_numbers(std::vector<std::string> const& row) {
  return std::all_of(row.begin(), row.end(), [](std::string const& cell) { return look_of(cell) == CellLook::number; });
}

void add_lines(std::string const& bytes, Layout const& layout, ReadingRules& rules) {
  Unsaid const plain = unsaid(bytes);
  std::set<std::string> const distinct(layout.columns.begin(), layout.columns.end());
  bool const short_names = layout.names == 0;
  if (rules.names == 0 && layout.names != plain.names) rules.names = layout.names;
  if (rules.units == UnitsPlace::none && layout.units != 0) {
    rules.units = UnitsPlace::line;
    rules.units_line = layout.units;
  }
  int const above = std::max(layout.names, layout.units);
  if (rules.first_value == 0 && (layout.first != above + 1 || short_names || (layout.more_below && layout.last != 0)))
    if (!(short_names && layout.first == 1 && all_are_numbers(layout.rows.front()))) rules.first_value = layout.first;
  if (layout.more_below && layout.last != 0 && rules.last_value == 0) {
    rules.first_value = layout.first;
    rules.last_value = layout.last;
  }
  char const found = layout.names != 0 && layout.names != plain.names ? 0 : plain.separator;
  if (rules.separator == 0 && (found != layout.separator && layout.columns.size() > 1)) {
    Lines line(bytes);
    int const names = layout.names != 0 ? layout.names : layout.first;
    while (line.number < names && line.next()) {
    }
    if (find_separator(line.text()) != layout.separator || (found != 0 && found != layout.separator))
      rules.separator = layout.separator;
  }
  if (layout.ragged) rules.ragged = true;
  if (layout.comments != 0) rules.comments = layout.comments;
  if (rules.columns.empty() && short_names) rules.columns = layout.columns;
}

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

std::optional<Proposal> propose(std::string const& utf8, ReadingRules const& current) {
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
  add_stamps(*layout, proposal, all);
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
  return fmt::format("{}: {}", replaces ? "write in place of `read` in the data block" : "add this line to the data block",
                     quoted(lines, "or"));
}

}  // namespace

namespace {

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
  int below = 0;
  for (Lines line(request.bytes); line.next();) below += line.number > last && !trimmed(line.text()).empty();
  return fmt::format("; {} below line {} {} then left out", counted(below, "line"), last, below == 1 ? "is" : "are");
}

}  // namespace

int broken_line(std::string const& utf8) {
  auto const layout = find_layout(utf8);
  return layout && layout->rows.size() >= 2 ? layout->broken : 0;
}

std::string proposed_help(ProposalRequest const& request) {
  auto proposal = propose(request.bytes, request.rules);
  if (!proposal) return {};
  std::vector<std::string> const& names = proposal->layout.columns;
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
  if (proposal->rules.front() == request.rules && proposal->time.empty()) return {};
  // A line that takes words of an input as missing would be refused next.
  if (request.complete && leaves_gaps(request, proposal->rules.front())) return {};
  std::string help = advice(proposal->rules, request.rules);
  if (!proposal->question.empty()) help = fmt::format("{}: choose, and {}", proposal->question, help);
  if (!proposal->time.empty()) help += fmt::format("; the time is `time {}`", quoted_text(proposal->time));
  help += left_out(*proposal, request);
  if (proposal->layout.names == 0 && !proposal->rules.front().columns.empty())
    help += "; put your own names there, in the order of the columns";
  return help;
}

std::optional<std::string> proposed_encoding(std::string const& bytes, ReadingRules const& rules) {
  auto const encoding = likely_encoding(bytes);
  if (!encoding) return std::nullopt;
  auto const text = to_utf8(bytes, *encoding);
  if (!text) return std::nullopt;
  ReadingRules wanted = rules;
  wanted.encoding = *encoding;
  auto const proposal = propose(*text, wanted);
  if (!proposal) return std::nullopt;
  return advice(proposal->rules, rules);
}

}  // namespace sysid
