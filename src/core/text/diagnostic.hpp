// What is wrong with the user's text or data, as a value: collected by the stages, rendered once at the end.
// The front end's wording lives in the files that own a stage's messages (check/message/errors_*.cpp, data/table/*_errors.cpp,
// grammar/errors.cpp), never at the place of detection; tasks word their few beside what they do.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/text/source.hpp"
#include "core/text/surface.hpp"

namespace sysid {

enum class Severity { error, warning, note };

/// A place with a few words under its carets ("[N/m]").
struct Label {
  Span span;
  std::string text;
};

struct Diagnostic {
  Severity severity = Severity::error;
  std::string code;              // "E2103"; E1 syntax, E2 names, types and units, E3 system, E4 data, E5 numerics, E6 inference
  std::string message;           // lower case, no full stop
  std::optional<Label> primary;  // absent: the message concerns no place in the text
  std::vector<Label> secondary;  // where two places conflict
  std::string help;              // what to do; may be empty
  // What it concerns. Rules over messages go by these, by code and by place, never by the sentences above.
  std::vector<std::string> names = {};      // as the user wrote them; where something is unknown or lacks something, that first
  std::string kind = {};                    // what the first of `names` was looked up as: "function", "fit"; empty: a name
  std::vector<std::string> suggested = {};  // names offered in place of an unknown one
  std::string prompt_help = {};             // in place of `help` where it is read at the prompt; empty: `help` holds there too
  std::string function = {};                // in whose body it was found, when it is told at a call of it
};

/// An error about stored results: it has no place in the text.
Diagnostic result_error(std::string code, std::string message, Help help);

/// What a message says, apart from its wording: code, places, names. Of a message without a code nothing but its place and its
/// names is known, so where it has neither, no two are the same.
bool same_matter(Diagnostic const& a, Diagnostic const& b);

/// Collects diagnostics of one source, in the order of detection.
class Diagnostics {
 public:
  void add(Diagnostic diagnostic) {
    if (reword_) reword_(diagnostic);
    all_.push_back(std::move(diagnostic));
  }
  /// Unless its code has been said of its place: what stands in several tasks or models is said once.
  void add_once(Diagnostic diagnostic);
  /// Among those added after the first `from`.
  bool has_errors(std::size_t from = 0) const;
  std::vector<Diagnostic> const& all() const { return all_; }
  void replace(std::vector<Diagnostic> all) { all_ = std::move(all); }
  /// Other words for all that is added from now on: tests show that no decision hangs on the sentences.
  void reword(std::function<void(Diagnostic&)> words) { reword_ = std::move(words); }

 private:
  std::vector<Diagnostic> all_;
  std::function<void(Diagnostic&)> reword_;
};

/// `file:line:col: error[E2103]: message`, the lines with carets, `help:` and `more:` lines. Sorted by place, those without one
/// last; of one that has no code either, `sysid` stands for the file. The first 20 errors, then how many more there are. colour:
/// ANSI colours. read_at: for the commands that help names.
std::string render(Diagnostics const& diagnostics, Source const& source, bool colour = false,
                   Surface read_at = Surface::command_line);
std::string render(Diagnostic const& diagnostic, Source const& source, bool colour = false,
                   Surface read_at = Surface::command_line);

/// For programs (`--error-format=json`): one JSON object per diagnostic and line, all of them, in the order of `render`.
std::string render_json(Diagnostics const& diagnostics, Source const& source);
std::string render_json(Diagnostic const& diagnostic, Source const& source);

/// Edit distance that counts a swap of two neighbours as one edit (Damerau and Levenshtein, no substring edited twice). In bytes.
int edit_distance(std::string_view a, std::string_view b);

/// Up to three of `known` nearest to `text` by edit distance, nearest first; empty when none is near enough. Names that differ in
/// capitals alone are nearest of all; a name that `text` begins (three letters at least) is near too.
std::vector<std::string> nearest(std::string_view text, std::vector<std::string> const& known);

/// "did you mean `a`, `b` or `c`?", or empty.
std::string did_you_mean(std::string_view text, std::vector<std::string> const& known);

/// A fault of ours: caught by the program's entry, which asks for the file and exits with 70.
class InternalError : public std::exception {
 public:
  explicit InternalError(std::string what) : what_(std::move(what)) {}
  char const* what() const noexcept override { return what_.c_str(); }

 private:
  std::string what_;
};

/// The user's data or request cannot be served; carries its diagnostic through code that has no Diagnostics at hand.
class UserError : public std::exception {
 public:
  explicit UserError(Diagnostic diagnostic) : diagnostic_(std::move(diagnostic)) {}
  Diagnostic const& diagnostic() const { return diagnostic_; }
  char const* what() const noexcept override { return diagnostic_.message.c_str(); }

 private:
  Diagnostic diagnostic_;
};

/// A file that cannot be read or written: exit code 74. help: what to do; may be empty.
class IoError : public std::exception {
 public:
  explicit IoError(std::string what, std::string help = {}) : what_(std::move(what)), help_(std::move(help)) {}
  char const* what() const noexcept override { return what_.c_str(); }
  std::string const& help() const { return help_; }

 private:
  std::string what_, help_;
};

}  // namespace sysid
