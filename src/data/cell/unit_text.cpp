// Spellings of units that the language does not know, and what it calls them.
#include "data/cell/unit_text.hpp"

#include <algorithm>
#include <charconv>
#include <span>

#include "core/text/words.hpp"

namespace sysid {
namespace {

constexpr std::size_t longest_unit = 24;

struct Spelling {
  std::string_view written, meant;
};
/// Of whole texts, in small letters.
constexpr Spelling whole_texts[] = {
    {"deg c", "degC"}, {"°c", "degC"},     {"celsius", "degC"}, {"deg f", "degF"}, {"degrees", "deg"},   {"°", "deg"},
    {"grad", "deg"},   {"u/min", "rpm"},   {"1/min", "1/min"},  {"sec", "s"},      {"secs", "s"},        {"second", "s"},
    {"seconds", "s"},  {"sekunden", "s"},  {"msec", "ms"},      {"usec", "us"},    {"volt", "V"},        {"volts", "V"},
    {"ampere", "A"},   {"amps", "A"},      {"newton", "N"},     {"newtons", "N"},  {"meter", "m"},       {"meters", "m"},
    {"metres", "m"},   {"watts", "W"},     {"hertz", "Hz"},     {"pascal", "Pa"},  {"millivolts", "mV"}, {"mvolts", "mV"},
    {"hours", "h"},    {"minutes", "min"}, {"%", "percent"},    {"1", "-"},        {"unitless", "-"},    {"dimensionless", "-"},
    {"none", "-"},     {"rn", "-"},        {"ts", "-"},         {"---", "-"}};
/// No masses.
constexpr Spelling of_accelerations[] = {{"g", "g_n"},        {"G", "g_n"},       {"gn", "g_n"},      {"g0", "g_n"},
                                         {"gs", "g_n"},       {"mg", "mg_n"},     {"mG", "mg_n"},     {"mgn", "mg_n"},
                                         {"ug", "ug_n"},      {"µg", "ug_n"},     {"μg", "ug_n"},     {"milli-g", "mg_n"},
                                         {"milli g", "mg_n"}, {"millig", "mg_n"}, {"micro-g", "ug_n"}};
/// No coulomb and no farad.
constexpr Spelling of_temperatures[] = {{"C", "degC"}, {"F", "degF"}};
constexpr Spelling unit_signs[] = {{"µ", "u"},   {"μ", "u"},   {"²", "^2"},    {"³", "^3"},  {"·", " "},  {"⋅", " "},
                                   {"Ω", "ohm"}, {"Ω", "ohm"}, {"°C", "degC"}, {"°", "deg"}, {"**", "^"}, {"%", "percent"}};

/// A product of powers, `N m/s^2`, `kg/(m s)`, `m s-1`, left to right; a second `/` divides again.
class UnitReader {
 public:
  explicit UnitReader(std::string_view text) : text_(text) {}

  std::optional<Unit> read() {
    auto unit = product();
    blanks();
    return at_ == text_.size() ? unit : std::nullopt;
  }

 private:
  void blanks() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
  }
  bool take(char c) {
    blanks();
    return at_ < text_.size() && text_[at_] == c ? (++at_, true) : false;
  }
  std::optional<Unit> product() {
    std::optional<Unit> all = factor();
    while (all) {
      blanks();
      if (at_ == text_.size() || text_[at_] == ')') return all;
      bool const divides = take('/');
      if (!divides && !take('*')) take('.');
      auto const next = factor();
      if (!next) return std::nullopt;
      all = divides ? divide(*all, *next) : multiply(*all, *next);
    }
    return all;
  }
  std::optional<Unit> factor() {
    if (take('(')) {
      auto inner = product();
      return inner && take(')') ? inner : std::nullopt;
    }
    blanks();
    std::size_t const begin = at_;
    while (at_ < text_.size() &&
           ((text_[at_] >= 'a' && text_[at_] <= 'z') || (text_[at_] >= 'A' && text_[at_] <= 'Z') || text_[at_] == '_'))
      ++at_;
    std::optional<Unit> unit;
    if (at_ > begin) unit = unit_atom(text_.substr(begin, at_ - begin));
    if (at_ == begin && at_ < text_.size() && text_[at_] == '1') ++at_, unit = Unit{};
    if (!unit) return std::nullopt;
    bool const raised = take('^');
    int exponent = 0;
    char const* const from = text_.data() + at_;
    auto const [end, error] = std::from_chars(from, text_.data() + text_.size(), exponent);
    if (error != std::errc{}) return raised ? std::nullopt : unit;
    if (exponent == 0 || exponent > 9 || exponent < -9) return std::nullopt;
    at_ += static_cast<std::size_t>(end - from);
    return power(*unit, {exponent, 1});
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

/// As the language writes it: powers with `^`, products with blanks, one `/` and what follows it in parentheses.
std::string in_language(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char const c = text[i];
    bool const after_letter = i > 0 && ((text[i - 1] >= 'a' && text[i - 1] <= 'z') || (text[i - 1] >= 'A' && text[i - 1] <= 'Z'));
    bool const digit = c >= '0' && c <= '9';
    bool const minus = c == '-' && i + 1 < text.size() && text[i + 1] >= '0' && text[i + 1] <= '9';
    if (after_letter && (digit || minus)) out += '^';
    if (c == '*' || c == '.')
      out += ' ';
    else
      out += c;
  }
  std::size_t const first = out.find('/');
  for (std::size_t at = first == std::string::npos ? first : out.find('/', first + 1); at != std::string::npos;
       at = out.find('/', at + 1)) {
    out[at] = ' ';  // a/b/c is a/(b c)
    if (out[first + 1] != '(') {
      out.insert(first + 1, "(");
      out += ')';
    }
  }
  if (first != std::string::npos && out.find_first_of("( ", first) != std::string::npos && out[first + 1] != '(') {
    // `m/s kg` is read from left to right elsewhere; here the order would have to be known.
    return {};
  }
  return out;
}

std::string_view without_brackets(std::string_view text) {
  text = trimmed(text);
  for (std::string_view const pair : {"[]", "()", "<>", "{}"})
    if (text.size() > 2 && text.front() == pair[0] && text.back() == pair[1]) text = trimmed(text.substr(1, text.size() - 2));
  return text;
}

}  // namespace

std::optional<Unit> unit_of_text(std::string_view text) {
  text = without_brackets(text);
  if (text.empty() || text.size() > longest_unit ||
      std::count_if(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; }) > 4)
    return std::nullopt;
  std::string meant(text);
  for (Spelling const& each : whole_texts)
    if (in_small_letters(text) == each.written) meant = each.meant;
  if (meant == "-") {
    Unit plain;
    plain.text = "-";
    return plain;
  }
  for (Spelling const& each : unit_signs)
    for (std::size_t at; (at = meant.find(each.written)) != std::string::npos;) meant.replace(at, each.written.size(), each.meant);
  auto unit = UnitReader(meant).read();
  if (!unit) return std::nullopt;
  std::string const written = in_language(meant);
  if (written.empty()) return std::nullopt;
  unit->text = written;
  return unit;
}

std::optional<Unit> unit_of_text(std::string_view text, Unit const& wanted) {
  auto unit = unit_of_text(text);
  if (unit && unit->dimension == wanted.dimension) return unit;
  std::string_view const bare = without_brackets(text);
  auto const take = [&](std::span<Spelling const> spellings) {
    for (Spelling const& each : spellings) {
      std::optional<Unit> const meant = bare == each.written ? unit_atom(each.meant) : std::nullopt;
      if (meant && meant->dimension == wanted.dimension) unit = meant;
    }
  };
  take(of_accelerations);
  take(of_temperatures);
  return unit;
}

std::optional<NumberWithUnit> split_number(std::string_view cell) {
  constexpr std::string_view digits = "0123456789";
  cell = trimmed(cell);
  std::size_t at = cell.find_first_not_of("+-");
  std::size_t const first = at == std::string_view::npos || at > 1 ? std::string_view::npos : cell.find_first_of(digits, at);
  if (first == std::string_view::npos || cell.substr(at, first - at).find_first_not_of(".,") != std::string_view::npos)
    return std::nullopt;
  at = std::min(cell.find_first_not_of("0123456789.,", first), cell.size());
  if (at < cell.size() && (cell[at] == 'e' || cell[at] == 'E')) {  // an exponent, where digits follow
    std::size_t const digit = std::min(cell.find_first_not_of("+-", at + 1), cell.size());
    if (digit < cell.size() && digit <= at + 2 && digits.find(cell[digit]) != std::string_view::npos)
      at = std::min(cell.find_first_not_of(digits, digit), cell.size());
  }
  std::string_view const behind = trimmed(cell.substr(at));
  if (behind.empty() || behind == "-" || behind == "e" || behind == "E" || digits.find(behind.front()) != std::string_view::npos)
    return std::nullopt;
  auto const unit = unit_of_text(behind);
  if (!unit) return std::nullopt;
  return NumberWithUnit{std::string(cell.substr(0, at)), unit->text};
}

std::optional<NameWithUnit> split_name(std::string_view text) {
  text = trimmed(text);
  auto const made = [](std::string_view name, std::string_view unit) -> std::optional<NameWithUnit> {
    name = trimmed(name);
    while (!name.empty() && (name.back() == ',' || name.back() == '_' || name.back() == ' ')) name.remove_suffix(1);
    unit = trimmed(unit);
    if (name.empty() || unit.empty()) return std::nullopt;
    return NameWithUnit{std::string(name), std::string(unit)};
  };
  for (std::string_view const pair : {"[]", "()", "<>", "{}"})
    if (text.size() > 3 && text.back() == pair[1])
      if (std::size_t const open = text.rfind(pair[0]); open != text.npos && open > 0)
        return made(text.substr(0, open), text.substr(open + 1, text.size() - open - 2));
  for (std::string_view const between : {" / ", " in ", ", "})
    if (std::size_t const at = text.rfind(between); at != text.npos && at > 0)
      if (unit_of_text(text.substr(at + between.size()))) return made(text.substr(0, at), text.substr(at + between.size()));
  return std::nullopt;
}

}  // namespace sysid
