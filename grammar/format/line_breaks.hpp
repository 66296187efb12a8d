// Where the lines of a long statement end.
#pragma once
#include "grammar/format/pieces.hpp"

namespace sysid::grammar {

/// A line longer than this is broken where it can be.
inline constexpr int longest_line = 100;

struct Line {
  std::string code;
  std::string comment;  // behind the code, or alone
};

/// The lines of a statement or comment without the comment behind it: as few as fit, and among those with the ends that penalties
/// prefer.
std::vector<Line> lines_of(Item const& item);

}  // namespace sysid::grammar
