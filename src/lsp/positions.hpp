// Lines and columns as editors count them, from 0, columns in UTF-16 code units, to bytes of UTF-8 and back.
#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/text/source.hpp"

namespace sysid::lsp {

struct Position {
  int line = 0;
  int character = 0;
  friend bool operator==(Position, Position) = default;
};

/// Of one text, which it does not keep. A line ends with LF, CRLF or CR.
class Lines {
 public:
  explicit Lines(std::string_view text);
  /// Within a character: where it begins. Behind the text: its end.
  Position position(std::uint32_t offset) const;
  /// Behind the end of a line: that end. Within a pair of code units: before it. Below the last line: the end of the text.
  std::uint32_t offset(Position position) const;

 private:
  std::string_view text_;
  std::vector<std::uint32_t> begins_;
};

}  // namespace sysid::lsp
