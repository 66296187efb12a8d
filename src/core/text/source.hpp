// A text the user wrote, and places in it. Stages carry byte offsets only; lines and columns are computed when a message is shown.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

/// Half-open range of bytes [begin, end) in one Source.
struct Span {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  friend bool operator==(Span, Span) = default;
};

/// The smallest span that covers both.
Span cover(Span a, Span b);

/// Line and column, both from 1; a column counts UTF-8 characters, not bytes. file: 0 for the text itself, then those it uses.
struct Place {
  int line = 1;
  int column = 1;
  int file = 0;
};

/// A file and the modules it uses, in one range of offsets: a span says by itself in which of them it lies.
class Source {
 public:
  Source(std::string name, std::string text);

  /// Takes a further file in; its offsets begin at `next_begin()` as it was before.
  void include(std::string name, std::string text);
  std::uint32_t next_begin() const { return static_cast<std::uint32_t>(text_.size() + 1); }

  int files() const { return static_cast<int>(files_.size()); }
  std::string const& name(int file = 0) const { return files_[static_cast<std::size_t>(file)].name; }
  std::string_view text(int file = 0) const;
  std::string_view text(Span span) const;
  /// Of all files, one behind the other.
  std::string const& all_text() const { return text_; }
  Place place(std::uint32_t offset) const;
  /// The line (from 1) of a file without its end; empty beyond the text.
  std::string_view line(int number, int file = 0) const;
  /// Offset of the first byte of the line; the end of the file beyond it.
  std::uint32_t line_begin(int number, int file = 0) const;

 private:
  struct File {
    std::string name;
    std::uint32_t begin, end;
    std::size_t first_line;  // index into line_begins_
  };
  std::string text_;  // all files, a newline between them
  std::vector<std::uint32_t> line_begins_;
  std::vector<File> files_;
};

/// Whether the name stands anywhere in the text, comments included; of a source, in the text itself.
bool mentions(std::string_view text, std::string_view name);
bool mentions(Source const& source, std::string_view name);

}  // namespace sysid
