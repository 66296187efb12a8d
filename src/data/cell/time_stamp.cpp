// Patterns are read into tokens once; a cell is matched token by token, without going back.
#include "data/cell/time_stamp.hpp"

#include <algorithm>
#include <array>

#include "core/text/words.hpp"
#include "data/cell/cells.hpp"

namespace sysid {
namespace {

/// Days since 1970-01-01 of a date of the Gregorian calendar (H. Hinnant, chrono-compatible low-level date algorithms).
std::int64_t days_from_civil(std::int64_t year, int month, int day) {
  year -= month <= 2;
  std::int64_t const era = (year >= 0 ? year : year - 399) / 400;
  auto const of_era = year - era * 400;
  auto const of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  return era * 146097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719468;
}

bool is_leap(std::int64_t year) { return (year % 4 == 0 && year % 100 != 0) || year % 400 == 0; }

int days_in(std::int64_t year, int month) {
  constexpr std::array<int, 12> days{31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  return days[static_cast<std::size_t>(month - 1)] + (month == 2 && is_leap(year) ? 1 : 0);
}

/// English and German; `Mär` may have lost its dots. In full they are read as well, and no other words: `marraskuu` is November.
struct MonthName {
  std::string_view name;
  int month;
};
constexpr MonthName month_names[] = {{"jan", 1},  {"feb", 2},  {"mar", 3},  {"mär", 3},  {"mrz", 3}, {"apr", 4},
                                     {"may", 5},  {"mai", 5},  {"jun", 6},  {"jul", 7},  {"aug", 8}, {"sep", 9},
                                     {"oct", 10}, {"okt", 10}, {"nov", 11}, {"dec", 12}, {"dez", 12}};
constexpr MonthName full_names[] = {{"january", 1},   {"januar", 1},   {"jänner", 1},   {"february", 2}, {"februar", 2},
                                    {"march", 3},     {"märz", 3},     {"maerz", 3},    {"marz", 3},     {"april", 4},
                                    {"june", 6},      {"juni", 6},     {"july", 7},     {"juli", 7},     {"august", 8},
                                    {"september", 9}, {"sept", 9},     {"october", 10}, {"oktober", 10}, {"november", 11},
                                    {"december", 12}, {"dezember", 12}};

/// word: in small letters; 0: it is none.
int month_of(std::string_view word) {
  for (MonthName const& each : month_names)
    if (word == each.name) return each.month;
  for (MonthName const& each : full_names)
    if (word == each.name) return each.month;
  return 0;
}

constexpr std::string_view iso = "iso";

}  // namespace

double seconds_between(TimeStamp const& from, TimeStamp const& to) {
  __extension__ typedef __int128 Wide;
  Wide const picoseconds = (static_cast<Wide>(to.second) - from.second) * 1000000000000 + (to.picosecond - from.picosecond);
  return static_cast<double>(static_cast<long double>(picoseconds) / 1e12L);
}

std::optional<StampPattern> StampPattern::parse(std::string_view text) {
  struct Word {
    std::string_view word;
    Part part;
  };
  static constexpr Word words[] = {{"YYYY", Part::year}, {"YY", Part::short_year},   {"MMM", Part::month_name},
                                   {"MM", Part::month},  {"DDD", Part::day_of_year}, {"DD", Part::day},
                                   {"hh", Part::hour},   {"mm", Part::minute},       {"ss", Part::second},
                                   {"zone", Part::zone}, {"AP", Part::half},         {"f", Part::fraction}};
  StampPattern pattern;
  pattern.text_ = text;
  if (text == iso) {
    pattern.has_date_ = true;
    return pattern;
  }
  unsigned seen = 0;
  auto const has = [&](Part part) { return (seen & (1U << static_cast<unsigned>(part))) != 0; };
  for (std::size_t at = 0; at < text.size();) {
    auto const word =
        std::find_if(std::begin(words), std::end(words), [&](Word const& each) { return text.substr(at).starts_with(each.word); });
    if (word == std::end(words)) {
      bool const blank = text[at] == ' ';
      if (is_decimal_digit(text[at])) return std::nullopt;
      pattern.tokens_.push_back({blank ? Part::blank : Part::sign, text[at]});
      ++at;
      continue;
    }
    if (has(word->part)) return std::nullopt;
    seen |= 1U << static_cast<unsigned>(word->part);
    auto const numeric = [](Part part) { return part <= Part::fraction && part != Part::month_name; };
    if (!pattern.tokens_.empty() && numeric(pattern.tokens_.back().part) && numeric(word->part))
      pattern.tokens_.back().exact = true;
    pattern.tokens_.push_back({word->part});
    at += word->word.size();
  }
  pattern.has_hours_ = has(Part::hour);
  bool const year = has(Part::year) || has(Part::short_year);
  bool const of_month = (has(Part::month) || has(Part::month_name)) && has(Part::day);
  pattern.has_date_ = year && (of_month || has(Part::day_of_year));
  bool const part_of_date = year || has(Part::month) || has(Part::month_name) || has(Part::day) || has(Part::day_of_year);
  if (part_of_date != pattern.has_date_ || (!pattern.has_date_ && !has(Part::hour) && !has(Part::minute))) return std::nullopt;
  // `hh:mm` is no such pattern: `59:59` would be hours as well as minutes.
  bool const packed = pattern.tokens_.front().exact;
  pattern.elapsed_ = !pattern.has_date_ && has(Part::second) && !has(Part::half) && !has(Part::zone) && !packed;
  return pattern;
}

/// Takes the parts of a cell one after the other.
struct StampPattern::Reader {
  std::string_view cell;
  std::size_t at = 0;
  std::int64_t year = 1970, offset_minutes = 0, picosecond = 0;
  int month = 1, day = 1, day_of_year = 0, hour = 0, minute = 0, second = 0;
  int decimals = 0;
  bool has_zone = false;
  std::optional<bool> afternoon{};
  static constexpr int most_digits_elapsed = 4;
  bool elapsed = false;
  bool first_is_minutes = false;

  bool number(int& value, int most_digits, bool exact) {
    std::size_t const begin = at;
    value = 0;
    while (at < cell.size() && is_decimal_digit(cell[at]) && at - begin < static_cast<std::size_t>(most_digits))
      value = value * 10 + (cell[at++] - '0');
    return at > begin && (!exact || at - begin == static_cast<std::size_t>(most_digits));
  }
  void fraction() {
    std::int64_t unit = 100000000000;
    for (; at < cell.size() && is_decimal_digit(cell[at]); ++at, unit /= 10, ++decimals) picosecond += (cell[at] - '0') * unit;
  }
  void blanks() {
    while (at < cell.size() && cell[at] == ' ') ++at;
  }
  bool name_of_month() {
    std::string word;
    std::size_t end = at;
    while (end < cell.size() && (in_small_letters(cell[end]) >= 'a' || static_cast<unsigned char>(cell[end]) >= 0x80U))
      word += in_small_letters(cell[end++]);
    month = month_of(word);
    at = end;
    return month > 0;
  }
  bool half_of_day() {
    blanks();
    if (at + 1 >= cell.size() || in_small_letters(cell[at + 1]) != 'm') return false;
    char const half = in_small_letters(cell[at]);
    if (half != 'a' && half != 'p') return false;
    afternoon = half == 'p';
    at += 2;
    return true;
  }
  bool zone() {
    has_zone = true;
    blanks();
    if (at < cell.size() && (cell[at] == 'Z' || cell[at] == 'z')) return ++at, true;
    if (cell.substr(at).starts_with("UTC") || cell.substr(at).starts_with("GMT")) return at += 3, true;
    if (at >= cell.size() || (cell[at] != '+' && cell[at] != '-')) return false;
    int const sign = cell[at++] == '-' ? -1 : 1;
    int hours = 0, minutes = 0;
    if (!number(hours, 2, true)) return false;
    if (at < cell.size() && cell[at] == ':') ++at;
    if (at < cell.size() && is_decimal_digit(cell[at]) && !number(minutes, 2, true)) return false;
    offset_minutes = sign * (hours * 60 + minutes);
    return hours <= 14 && minutes < 60;
  }
  bool take(Token const& token) {
    int value = 0;
    switch (token.part) {
      case Part::year:
        if (!number(value, 4, true)) return false;
        year = value;
        return true;
      case Part::short_year:
        if (!number(value, 2, true)) return false;
        year = value < 70 ? 2000 + value : 1900 + value;
        return true;
      case Part::month:
        return number(month, 2, token.exact);
      case Part::month_name:
        return name_of_month();
      case Part::day:
        return number(day, 2, token.exact);
      case Part::day_of_year:
        return number(day_of_year, 3, token.exact) && day_of_year >= 1;
      case Part::hour:
        return number(hour, elapsed ? most_digits_elapsed : 2, token.exact);
      case Part::minute:  // `0:05` of a stop watch, as `8:05` of a clock
        if (at == 0 && elapsed) {
          first_is_minutes = true;
          return number(minute, most_digits_elapsed, false);
        }
        return number(minute, 2, token.exact || at > 0);
      case Part::second:
        return number(second, 2, true);
      case Part::fraction:
        return fraction(), true;
      case Part::half:
        return half_of_day();
      case Part::zone:
        return zone();
      case Part::blank:
        if (at >= cell.size() || cell[at] != ' ') return false;
        return blanks(), true;
      case Part::sign:
        return at < cell.size() && cell[at++] == token.sign;
    }
    return false;
  }
  std::optional<TimeStamp> stamp() const {
    if (month < 1 || month > 12 || day < 1 || day > days_in(year, month) || second > 60) return std::nullopt;
    if (minute > 59 && !first_is_minutes) return std::nullopt;
    if (day_of_year > (is_leap(year) ? 366 : 365)) return std::nullopt;
    int hours = hour;
    if (afternoon) {
      if (hour < 1 || hour > 12) return std::nullopt;
      hours = hour % 12 + (*afternoon ? 12 : 0);
    }
    if (hours > 23 && !elapsed && (hours > 24 || minute > 0 || second > 0 || picosecond > 0)) return std::nullopt;
    std::int64_t const days = day_of_year > 0 ? days_from_civil(year, 1, 1) + day_of_year - 1 : days_from_civil(year, month, day);
    return TimeStamp{((days * 24 + hours) * 60 + minute - offset_minutes) * 60 + second, picosecond, decimals, has_zone};
  }
  std::optional<TimeStamp> iso_stamp() {
    int value = 0;
    auto const sign = [&](std::string_view allowed) {
      return at < cell.size() && allowed.find(cell[at]) != allowed.npos ? (++at, true) : false;
    };
    if (!number(value, 4, true) || !sign("-") || !number(month, 2, true) || !sign("-") || !number(day, 2, true))
      return std::nullopt;
    year = value;
    if (at == cell.size()) return stamp();
    if (!sign("T t")) return std::nullopt;
    blanks();
    if (!number(hour, 2, true) || !sign(":") || !number(minute, 2, true)) return std::nullopt;
    if (sign(":") && !number(second, 2, true)) return std::nullopt;
    if (sign(".,")) fraction();
    blanks();
    if (at != cell.size() && !zone()) return std::nullopt;
    return at == cell.size() ? stamp() : std::nullopt;
  }
};

std::size_t StampPattern::packed_digits(std::size_t token) const {
  auto const is = [&](std::size_t i, Part part) { return i < tokens_.size() && tokens_[i].part == part; };
  if (!is(token, Part::hour) || !is(token + 1, Part::minute) || (token > 0 && tokens_[token - 1].exact)) return 0;
  std::size_t const last = is(token + 2, Part::second) ? token + 2 : token + 1;
  return tokens_[last].exact ? 0 : 2 * (last - token + 1);
}

std::optional<TimeStamp> StampPattern::read(std::string_view text) const {
  std::string const cell = with_plain_blanks(text);
  Reader reader{.cell = trimmed(cell)};
  if (tokens_.empty()) return reader.iso_stamp();
  reader.elapsed = elapsed_;
  std::string padded;
  for (std::size_t i = 0; i < tokens_.size(); ++i) {
    // A fraction may be left out, with the sign before it: programs print whole seconds without one.
    bool const optional = tokens_[i].part == Part::sign && i + 1 < tokens_.size() && tokens_[i + 1].part == Part::fraction;
    if (optional && (reader.at >= reader.cell.size() || reader.cell[reader.at] != tokens_[i].sign)) {
      ++i;
      continue;
    }
    if (std::size_t const digits = packed_digits(i)) {
      std::size_t const there = reader.cell.substr(reader.at).find_first_not_of("0123456789");
      std::size_t const count = there == std::string_view::npos ? reader.cell.size() - reader.at : there;
      if (count > 0 && count < digits) {
        padded = std::string(reader.cell.substr(reader.at)).insert(0, digits - count, '0');
        reader.cell = padded;
        reader.at = 0;
      }
    }
    if (!reader.take(tokens_[i])) return std::nullopt;
  }
  return reader.at == reader.cell.size() ? reader.stamp() : std::nullopt;
}

bool is_time_stamp(std::string_view cell) {
  constexpr std::size_t longest = 48;
  if (cell.size() > longest) return false;
  std::string const with_blanks = with_plain_blanks(cell);
  std::string_view text = with_blanks;
  if (text.size() >= 2 && text.front() == '"') text = text.substr(1, text.size() - 2);
  if (text.empty()) return false;
  // Names of months, and nothing but digits and signs beside them.
  std::string plain;
  int letters = 0;
  bool named = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char const c = text[i];
    if (in_small_letters(c) >= 'a' && in_small_letters(c) <= 'z') {
      ++letters;
      plain += '-';
      if (i > 0 && in_small_letters(text[i - 1]) >= 'a' && in_small_letters(text[i - 1]) <= 'z') continue;  // within a word
      for (MonthName const& each : month_names) {
        std::string three;
        for (char const letter : text.substr(i, 3)) three += in_small_letters(letter);
        named = named || three == each.name;
      }
    } else {
      plain += c;
    }
  }
  if (named && letters <= 12 && is_decimal_digit(text[text.size() - 1]) &&
      plain.find_first_not_of("0123456789-/.:,+ ") == std::string::npos)
    return true;
  if (text.find_first_not_of("0123456789-/.:,+ TZAPMapmz") != std::string_view::npos || !is_decimal_digit(text[0])) return false;
  auto const count = [&](char sign) { return std::count(text.begin(), text.end(), sign); };
  std::size_t const dash = text.find('-', 1);
  bool const by_dashes = count('-') >= 2 && dash != std::string_view::npos && is_decimal_digit(text[dash - 1]);
  std::string_view const day = text.substr(0, text.find(' '));
  bool const by_points = std::count(day.begin(), day.end(), '.') == 2 && day.size() <= 10 && day.size() >= 6 &&
                         day.find_first_of(",'") == std::string_view::npos &&
                         (day.rfind('.') + 5 == day.size() || day.rfind('.') + 3 == day.size());
  return count(':') > 0 || count('/') == 2 || by_dashes || by_points;
}

}  // namespace sysid
