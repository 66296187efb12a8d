// Distributions of the modules of other programs, `pm.Normal("k", 0, 1)`, `stats.norm(0, 1)`, as they are written here.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/text/words.hpp"
#include "grammar/message/hints.hpp"
#include "syntax/words.hpp"

namespace sysid::grammar {
namespace {

/// An argument in the words of others; ours: the name that it needs here, empty where it has none.
struct ModuleArgument {
  std::array<std::string_view, 4> theirs;
  std::string_view ours;
};
/// theirs: in small letters; by_position: in all modules the order of the arguments is that of the row.
struct ModuleRow {
  std::string_view theirs, ours;
  std::array<ModuleArgument, 2> arguments;  // none where the first has no names
  bool by_position = false;
};
constexpr ModuleArgument of_mean{{"mu", "loc", "mean"}, ""}, of_sd{{"sigma", "scale", "sd", "std"}, "sd"};
constexpr ModuleRow rows[] = {
    {"normal", "normal", {of_mean, of_sd}, true},
    {"norm", "normal", {of_mean, of_sd}, true},
    {"truncatednormal", "normal", {of_mean, of_sd}},
    {"halfnormal", "half_normal", {of_sd}},
    {"halfnorm", "half_normal", {}},
    {"uniform", "uniform", {{{{"lower", "low"}, ""}, {{"upper", "high"}, ""}}}},
    {"exponential", "exponential", {{{{"lam", "rate"}, "rate"}}}},
    {"expon", "exponential", {}},
    {"gamma", "gamma", {{{{"alpha", "concentration"}, "shape"}, {{"beta", "rate"}, "rate"}}}},
    {"lognormal", "log_normal", {{{{"mu", "loc"}, "log_mean"}, {{"sigma", "scale"}, "log_sd"}}}},
    {"lognorm", "log_normal", {}},
    {"halfcauchy", "half_cauchy", {}},
    {"studentt", "student_t", {}},
    {"inversegamma", "inverse_gamma", {}},
    {"beta", "beta", {}},
};

ModuleRow const* row_of(std::string_view name) {
  std::string small = in_small_letters(std::string(name));
  std::erase(small, '_');
  auto const* const row =
      std::find_if(std::begin(rows), std::end(rows), [&](ModuleRow const& each) { return each.theirs == small; });
  return row == std::end(rows) ? nullptr : row;
}

/// The arguments between two tokens as they are written here; empty where that is not known.
std::string translated(Gap const& gap, ModuleRow const& row, std::size_t from, std::size_t close, bool by_position) {
  std::array<std::string, 2> found;
  std::string bounds;
  bool named = false;
  for (std::size_t position = 0; from < close; ++position) {
    std::size_t const end = comma_from(gap, from, close);
    bool const name = from + 2 < end && gap.statement[from + 1].is("=");
    std::size_t const value = name ? from + 2 : from;
    for (std::size_t i = value; i < end; ++i)
      if (gap.statement[i].is(".") || gap.statement[i].is("=") || gap.statement[i].is("None") ||
          gap.statement[i].kind == TokenKind::text)
        return {};
    std::string_view const word = gap.statement[from].text;
    std::size_t place = name ? row.arguments.size() : position;
    for (std::size_t i = 0; name && i < row.arguments.size(); ++i)
      if (words::contains(row.arguments[i].theirs, word)) place = i;
    if (value == end || (!name && (named || !by_position))) return {};
    if (name && row.ours == "normal" && (word == "lower" || word == "upper")) {
      bounds += fmt::format(", {} = {}", word, gap.text(value, end));
    } else {
      if (place >= row.arguments.size() || row.arguments[place].theirs.front().empty() || !found[place].empty()) return {};
      std::string_view const ours = row.arguments[place].ours;
      found[place] = fmt::format("{}{}{}", ours, ours.empty() ? "" : " = ", gap.text(value, end));
    }
    named = named || name;
    from = end + 1;
  }
  std::string out;
  for (std::size_t i = 0; i < found.size() && !row.arguments[i].theirs.front().empty(); ++i) {
    if (found[i].empty()) return {};
    out += (i == 0 ? "" : ", ") + found[i];
  }
  return out.empty() ? out : out + bounds;
}

/// Index of the name behind the last dot of `scipy.stats.norm`, at the module.
std::size_t name_behind_module(Gap const& gap) {
  std::size_t at = gap.at;
  while (at + 2 < gap.statement.size() && gap.statement[at + 1].is(".") && gap.statement[at + 2].kind == TokenKind::word) at += 2;
  return at;
}

}  // namespace

std::size_t comma_from(Gap const& gap, std::size_t at, std::size_t close) {
  while (at < close && !gap.statement[at].is(","))
    at = (gap.statement[at].is("(") || gap.statement[at].is("[") ? gap.closing(at) : at) + 1;
  return std::min(at, close);
}

std::string call_of_module(Gap const& gap, std::size_t opener) {
  std::string_view const name = gap.statement[opener - 1].text;
  ModuleRow const* const row = row_of(name);
  if (row == nullptr) return "...";
  std::size_t const close = gap.closing(opener);
  std::size_t first = opener + 1;
  if (first + 1 < gap.statement.size() && gap.statement[first].kind == TokenKind::text && gap.statement[first + 1].is(","))
    first += 2;
  // In small letters other modules order and mean their arguments otherwise: `uniform(loc, scale)`, `gamma(shape, scale)`.
  bool const capital = name.front() >= 'A' && name.front() <= 'Z';
  std::string const arguments =
      close < gap.statement.size() ? translated(gap, *row, first, close, capital || row->by_position) : std::string();
  return fmt::format("{}({})", row->ours, arguments.empty() ? "..." : arguments);
}

std::string distribution_of_module(Gap const& gap) {
  std::size_t const name = name_behind_module(gap);
  std::string const without = fmt::format("write the distribution without `{}`", gap.text(gap.at, std::max(name, gap.at + 2)));
  bool const called = name > gap.at && name + 1 < gap.statement.size() && gap.statement[name + 1].is("(");
  std::string const meant = called ? call_of_module(gap, name + 1) : "...";
  return meant == "..." ? without : fmt::format("{}: `{}`", without, meant);
}

}  // namespace sysid::grammar
