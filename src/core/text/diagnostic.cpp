// Diagnostics as text for people and as JSON for programs.
#include "core/text/diagnostic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <tuple>

#include "core/text/utf8.hpp"

namespace sysid {

namespace {

constexpr std::size_t shown_errors = 20;
constexpr int tab_width = 4;
// Of the user's text in a message, and of a line as shown: a file may be one line of a million characters.
constexpr std::size_t longest_words = 2000, longest_line = 600, before_mark = 200;

std::string_view word(Severity severity) {
  switch (severity) {
    case Severity::warning:
      return "warning";
    case Severity::note:
      return "note";
    case Severity::error:
      break;
  }
  return "error";
}

/// ANSI colours, or nothing.
struct Paint {
  bool on;
  std::string operator()(std::string_view sequence, std::string_view text) const {
    return on && !text.empty() ? fmt::format("\033[{}m{}\033[0m", sequence, text) : std::string(text);
  }
  std::string severity(Severity severity, std::string_view text) const {
    return (*this)(severity == Severity::error ? "1;31" : severity == Severity::warning ? "1;33" : "1;36", text);
  }
  std::string gutter(std::string_view text) const { return (*this)("34", text); }
};

std::string shortened(std::string_view text) {
  if (text.size() <= longest_words) return std::string(text);
  return fmt::format("{} ... {}", text.substr(0, character_begin(text, longest_words / 2)),
                     text.substr(character_begin(text, text.size() - longest_words / 2)));
}

/// A line as shown: tabs become blanks, and `column[i]` is where byte first + i stands. Of a very long line the part around `mark`.
struct ShownLine {
  std::string text;
  std::size_t first = 0;
  std::vector<int> column;
};

ShownLine shown(std::string_view line, std::size_t mark) {
  ShownLine out;
  bool const cut = line.size() > longest_line;
  std::size_t const end = line.size();
  if (cut) {
    out.first = character_begin(line, mark > before_mark ? std::min(mark - before_mark, end) : 0);
    line = line.substr(out.first, character_begin(line, out.first + longest_line) - out.first);
  }
  bool const ends_early = out.first + line.size() < end;
  int column = 0;
  if (out.first > 0) {
    out.text = "... ";
    column = 4;
  }
  for (char const byte : line) {
    out.column.push_back(continues_character(byte) ? std::max(column - 1, 0) : column);
    if (continues_character(byte)) {
      out.text += byte;
    } else if (byte == '\t') {
      int const blanks = tab_width - column % tab_width;
      out.text.append(static_cast<std::size_t>(blanks), ' ');
      column += blanks;
    } else {
      out.text += static_cast<unsigned char>(byte) < 0x20U ? ' ' : byte;
      ++column;
    }
  }
  out.column.push_back(column);
  if (ends_early) out.text += " ...";
  return out;
}

/// One underlined stretch of a shown line.
struct Mark {
  int begin, end;
  bool primary;
  std::string text;
};

Mark mark_on(Label const& label, bool primary, std::uint32_t line_begin, ShownLine const& line) {
  std::size_t const last = line.column.size() - 1;
  line_begin += static_cast<std::uint32_t>(line.first);
  std::size_t const begin = label.span.begin > line_begin ? std::min<std::size_t>(label.span.begin - line_begin, last) : 0;
  // A span that runs on into later lines is underlined to the end of its first.
  std::size_t const end = std::clamp<std::size_t>(label.span.end > line_begin ? label.span.end - line_begin : 0, begin, last);
  int const first = line.column[begin];
  return {first, std::max(line.column[end], first + 1), primary, shortened(label.text)};
}

/// The rows under a line: all underlines with the text of the rightmost, then the other texts from right to left, each on the
/// first row where it is free to stand.
std::vector<std::string> mark_rows(std::vector<Mark> marks, Severity severity, Paint paint) {
  std::stable_sort(marks.begin(), marks.end(), [](Mark const& a, Mark const& b) { return a.begin < b.begin; });
  struct Piece {
    int begin;
    std::string text;
    bool primary;
  };
  std::vector<std::vector<Piece>> rows(1);
  int position = 0;
  for (Mark const& mark : marks) {
    int const begin = std::max(mark.begin, position);
    if (begin >= mark.end) continue;  // hidden by an overlapping mark; its text is still shown
    rows[0].push_back({begin, std::string(static_cast<std::size_t>(mark.end - begin), mark.primary ? '^' : '-'), mark.primary});
    position = mark.end;
  }
  for (std::size_t i = marks.size(); i-- > 0;) {
    Mark const& mark = marks[i];
    if (mark.text.empty()) continue;
    if (i + 1 == marks.size() && position <= mark.end) {
      rows[0].push_back({mark.end + 1, mark.text, mark.primary});
      continue;
    }
    // Texts are placed from right to left, so a row is free when its leftmost piece begins behind this one.
    std::size_t row = 1;
    while (row < rows.size() && !rows[row].empty() && mark.begin + text_width(mark.text) + 1 > rows[row].front().begin) ++row;
    if (row == rows.size()) rows.emplace_back();
    rows[row].insert(rows[row].begin(), {mark.begin, mark.text, mark.primary});
  }
  std::vector<std::string> out;
  for (std::vector<Piece> const& row : rows) {
    std::string text;
    int column = 0;
    for (Piece const& piece : row) {
      text.append(static_cast<std::size_t>(std::max(piece.begin - column, 0)), ' ');
      text += piece.primary ? paint.severity(severity, piece.text) : paint("36", piece.text);
      column = std::max(column, piece.begin) + text_width(piece.text);
    }
    out.push_back(std::move(text));
  }
  return out;
}

/// Of a file that is no text a line shows nothing.
bool printable(std::string_view line) {
  return std::none_of(line.begin(), line.end(),
                      [](char c) { return (static_cast<unsigned char>(c) < 0x20U && c != '\t' && c != '\r') || c == '\x7f'; });
}

std::string excerpt(Diagnostic const& diagnostic, Source const& source, Paint paint) {
  // Lines by file, that of the message first.
  int const own_file = source.place(diagnostic.primary->span.begin).file;
  std::map<std::pair<int, int>, std::vector<std::pair<Label const*, bool>>> by_line;
  int last_line = 0;
  auto const take = [&](Label const& label, bool primary) {
    Place const place = source.place(label.span.begin);
    by_line[{place.file == own_file ? -1 : place.file, place.line}].emplace_back(&label, primary);
    last_line = std::max(last_line, place.line);
  };
  take(*diagnostic.primary, true);
  for (Label const& label : diagnostic.secondary) take(label, false);
  int const digits = std::max(4, static_cast<int>(std::to_string(last_line).size()));
  std::string out;
  int previous = 0, previous_file = -1;
  for (auto const& [place, labels] : by_line) {
    auto const [file_key, number] = place;
    int const file = file_key < 0 ? own_file : file_key;
    if (file_key != previous_file)
      out += fmt::format("{} in {}\n", paint.gutter(fmt::format("{:>{}} |", "", digits)), source.name(file));
    else if (previous != 0 && number > previous + 1)
      out += paint.gutter("...") + "\n";
    previous = number;
    previous_file = file_key;
    if (!printable(source.line(number, file))) continue;
    std::uint32_t const line_begin = source.line_begin(number, file);
    ShownLine const line = shown(source.line(number, file), labels.front().first->span.begin - line_begin);
    out += fmt::format("{} {}\n", paint.gutter(fmt::format("{:>{}} |", number, digits)), line.text);
    std::vector<Mark> marks;
    for (auto const& [label, primary] : labels) marks.push_back(mark_on(*label, primary, line_begin, line));
    for (std::string const& row : mark_rows(std::move(marks), diagnostic.severity, paint))
      out += fmt::format("{} {}\n", paint.gutter(fmt::format("{:>{}} |", "", digits)), row);
  }
  return out;
}

/// What a message says, whatever its words. One mistake may be met from several places: only its own counts.
using Matter = std::tuple<std::uint32_t, std::uint32_t, std::string, std::vector<std::string>, std::string, std::string>;

Matter matter_of(Diagnostic const& each) {
  Span const place = each.primary ? each.primary->span : Span{~0U, ~0U};
  return {place.begin, place.end, each.code, each.names, each.kind, each.function};
}

/// In the order in which they are shown.
std::vector<Diagnostic const*> sorted(Diagnostics const& diagnostics) {
  std::vector<Diagnostic const*> out;
  for (Diagnostic const& diagnostic : diagnostics.all()) out.push_back(&diagnostic);
  std::stable_sort(out.begin(), out.end(), [](Diagnostic const* a, Diagnostic const* b) {
    if (!a->primary || !b->primary) return a->primary.has_value() && !b->primary.has_value();
    return a->primary->span.begin < b->primary->span.begin;
  });
  // A statement that stands for several (the elements of a vector, the uses of a model) may be found wrong several times.
  std::vector<Diagnostic const*> once;
  std::set<Matter> said;
  for (Diagnostic const* each : out)
    if (!each->primary || said.insert(matter_of(*each)).second) once.push_back(each);
  return once;
}

}  // namespace

Diagnostic result_error(std::string code, std::string message, Help help) {
  Diagnostic result{Severity::error, std::move(code), std::move(message), std::nullopt, {}, std::move(help.command_line)};
  result.prompt_help = std::move(help.prompt);
  return result;
}

bool same_matter(Diagnostic const& a, Diagnostic const& b) {
  if (a.code.empty() && !a.primary && a.names.empty()) return false;
  return matter_of(a) == matter_of(b);
}

void Diagnostics::add_once(Diagnostic diagnostic) {
  bool const said = std::any_of(all_.begin(), all_.end(), [&](Diagnostic const& other) {
    return other.code == diagnostic.code && other.primary && diagnostic.primary && other.primary->span == diagnostic.primary->span;
  });
  if (!said) add(std::move(diagnostic));
}

bool Diagnostics::has_errors(std::size_t from) const {
  return std::any_of(all_.begin() + static_cast<std::ptrdiff_t>(std::min(from, all_.size())), all_.end(),
                     [](Diagnostic const& d) { return d.severity == Severity::error; });
}

std::string render(Diagnostic const& diagnostic, Source const& source, bool colour, Surface read_at) {
  Paint const paint{colour};
  // A message that has neither a place nor a code is about files and options, not about the text.
  std::string where = diagnostic.primary || !diagnostic.code.empty() ? source.name() : "sysid";
  if (diagnostic.primary) {
    Place const place = source.place(diagnostic.primary->span.begin);
    where = source.name(place.file);
    where += fmt::format("{}{}:{}", where.empty() ? "" : ":", place.line, place.column);
  }
  std::string kind(word(diagnostic.severity));
  if (!diagnostic.code.empty()) kind += fmt::format("[{}]", diagnostic.code);
  std::string out = fmt::format("{}{}{}: {}\n", paint("1", where), where.empty() ? "" : ": ",
                                paint.severity(diagnostic.severity, kind), paint("1", shortened(diagnostic.message)));
  if (diagnostic.primary) out += excerpt(diagnostic, source, paint);
  bool const at_prompt = read_at == Surface::prompt;
  std::string const& help = at_prompt && !diagnostic.prompt_help.empty() ? diagnostic.prompt_help : diagnostic.help;
  if (!help.empty()) out += fmt::format("{} {}\n", paint("1;32", "help:"), shortened(help));
  if (!diagnostic.code.empty())
    out += fmt::format("{} {} {}\n", paint("1", "more:"), at_prompt ? "help" : "sysid explain", diagnostic.code);
  return out;
}

std::string render(Diagnostics const& diagnostics, Source const& source, bool colour, Surface read_at) {
  std::string out;
  std::size_t errors = 0;
  for (Diagnostic const* diagnostic : sorted(diagnostics)) {
    if (diagnostic->severity == Severity::error && ++errors > shown_errors) continue;
    if (!out.empty()) out += '\n';
    out += render(*diagnostic, source, colour, read_at);
  }
  if (errors > shown_errors) out += fmt::format("\n... and {} more\n", errors - shown_errors);
  return out;
}

std::string render_json(Diagnostic const& diagnostic, Source const& source) {
  int const file = diagnostic.primary ? source.place(diagnostic.primary->span.begin).file : 0;
  auto const place_of = [&](Label const& label) {
    Place const begin = source.place(label.span.begin);
    Place const end = source.place(label.span.end);
    std::uint32_t const file_begin = source.line_begin(1, begin.file);
    nlohmann::ordered_json place = {{"line", begin.line},
                                    {"column", begin.column},
                                    {"end_line", end.line},
                                    {"end_column", end.column},
                                    {"begin", label.span.begin - file_begin},
                                    {"end", label.span.end - file_begin},
                                    {"label", shortened(label.text)}};
    if (begin.file != file) place["file"] = source.name(begin.file);
    return place;
  };
  nlohmann::ordered_json out;
  out["file"] = source.name(file);
  out["severity"] = word(diagnostic.severity);
  out["code"] = diagnostic.code;
  out["message"] = shortened(diagnostic.message);
  out["primary"] = diagnostic.primary ? place_of(*diagnostic.primary) : nlohmann::ordered_json(nullptr);
  out["secondary"] = nlohmann::ordered_json::array();
  for (Label const& label : diagnostic.secondary) out["secondary"].push_back(place_of(label));
  out["help"] = shortened(diagnostic.help);
  // The user's text may hold any bytes: what is not UTF-8 is replaced, never thrown at the user.
  return out.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string render_json(Diagnostics const& diagnostics, Source const& source) {
  std::string out;
  for (Diagnostic const* diagnostic : sorted(diagnostics)) out += render_json(*diagnostic, source);
  return out;
}

}  // namespace sysid
