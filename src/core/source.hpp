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

/// Line and column, both from 1; a column counts UTF-8 characters, not bytes.
struct Place {
  int line = 1;
  int column = 1;
};

class Source {
 public:
  Source(std::string name, std::string text);

  std::string const& name() const { return name_; }
  std::string_view text() const { return text_; }
  std::string_view text(Span span) const;
  Place place(std::uint32_t offset) const;
  /// The line (from 1) without its end; empty beyond the text.
  std::string_view line(int number) const;
  /// Offset of the first byte of the line; the end of the text beyond it.
  std::uint32_t line_begin(int number) const;

 private:
  std::string name_;
  std::string text_;
  std::vector<std::uint32_t> line_begins_;
};

}  // namespace sysid
