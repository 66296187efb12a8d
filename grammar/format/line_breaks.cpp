// The cheapest set of line ends, by dynamic programming from the statement's last piece to its first.
#include "grammar/format/line_breaks.hpp"

#include <limits>

#include "core/text/utf8.hpp"

namespace sysid::grammar {

namespace {

constexpr double new_line = 100, excess_character = 1000;
constexpr int block_indent = 2, continuation_indent = 4, bracket_indent = 2;

class Breaker {
 public:
  explicit Breaker(Item const& item) : item_(item), pieces_(item.pieces) {}

  std::vector<Line> run() {
    for (std::size_t first = 0; first < pieces_.size();) {
      std::size_t last = first + 1;
      while (last < pieces_.size() && pieces_[last].comments.empty()) ++last;
      comments(first);
      stretch(first, last);
      first = last;
    }
    return std::move(out_);
  }

 private:
  int indentation(std::size_t piece) const {
    int const base = block_indent * item_.level;
    return piece == 0 ? base : base + continuation_indent + bracket_indent * pieces_[piece].depth;
  }

  void comments(std::size_t piece) {
    for (Comment const& comment : pieces_[piece].comments) {
      if (!comment.own_line && out_.back().comment.empty() && !out_.back().code.empty())
        out_.back().comment = comment.text;
      else
        out_.push_back({std::string(static_cast<std::size_t>(indentation(piece)), ' ') + comment.text, ""});
    }
  }

  /// Pieces without comments between them.
  void stretch(std::size_t first, std::size_t last) {
    std::vector<double> cost(last + 1, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> next(last + 1, last);
    cost[last] = 0;
    for (std::size_t begin = last; begin-- > first;) {
      if (begin > first && !pieces_[begin].break_penalty) continue;
      int length = indentation(begin);
      for (std::size_t end = begin + 1; end <= last; ++end) {
        Piece const& piece = pieces_[end - 1];
        length += text_width(piece.text) + (end - 1 > begin ? (piece.blank_before ? 1 : 0) + piece.padding : 0);
        if (end < last && !pieces_[end].break_penalty) continue;
        int const excess = length > longest_line ? length - longest_line : 0;
        double const behind = end < last ? cost[end] + new_line + *pieces_[end].break_penalty : 0;
        // Of equals the one with the longest first line.
        if (double const total = excess_character * excess + behind; total <= cost[begin]) {
          cost[begin] = total;
          next[begin] = end;
        }
        if (excess > 0) break;
      }
    }
    for (std::size_t begin = first; begin < last; begin = next[begin]) {
      std::string line(static_cast<std::size_t>(indentation(begin)), ' ');
      for (std::size_t i = begin; i < next[begin]; ++i) {
        if (i > begin) line.append(static_cast<std::size_t>((pieces_[i].blank_before ? 1 : 0) + pieces_[i].padding), ' ');
        line += pieces_[i].text;
      }
      out_.push_back({std::move(line), ""});
    }
  }

  Item const& item_;
  std::vector<Piece> const& pieces_;
  std::vector<Line> out_;
};

}  // namespace

std::vector<Line> lines_of(Item const& item) {
  if (!item.pieces.empty()) return Breaker(item).run();
  return {{std::string(static_cast<std::size_t>(block_indent * item.level), ' ') + item.comment, ""}};
}

}  // namespace sysid::grammar
