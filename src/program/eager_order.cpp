// Whenever an operation is done, others may have become ready, or the last readers of a value.
#include "program/eager_order.hpp"

#include <algorithm>

namespace sysid {
namespace {

class Ordering {
 public:
  Ordering(std::vector<std::vector<std::size_t>> const& operands, std::vector<bool> const& kept)
      : operands_(operands), users_(operands.size()), missing_(operands.size()), readers_(operands.size()), done_(operands.size()) {
    for (std::size_t i = 0; i < operands.size(); ++i) {
      missing_[i] = operands[i].size();
      readers_[i] += kept[i] ? 1 : 0;
      for (std::size_t const operand : operands[i]) {
        users_[operand].push_back(i);
        ++readers_[operand];
      }
    }
  }

  std::vector<std::size_t> order() {
    for (std::size_t i = 0; i < operands_.size(); ++i) {
      if (!done_[i]) take(i);
      while (!ready_.empty()) {
        std::size_t const next = ready_.back();
        ready_.pop_back();
        if (!done_[next]) take(next);
      }
    }
    return std::move(order_);
  }

 private:
  bool ends_a_value(std::size_t i) const {
    return std::any_of(operands_[i].begin(), operands_[i].end(), [&](std::size_t operand) { return readers_[operand] == 1; });
  }

  void consider(std::size_t i) {
    if (!done_[i] && missing_[i] == 0 && ends_a_value(i)) ready_.push_back(i);
  }

  void take(std::size_t i) {
    done_[i] = true;
    order_.push_back(i);
    for (std::size_t const operand : operands_[i])
      if (--readers_[operand] == 1)
        for (std::size_t const user : users_[operand]) consider(user);
    for (std::size_t const user : users_[i]) --missing_[user];
    // The last one considered comes next: one that reads what has just been computed.
    for (std::size_t const user : users_[i]) consider(user);
  }

  std::vector<std::vector<std::size_t>> const& operands_;
  std::vector<std::vector<std::size_t>> users_;
  std::vector<std::size_t> missing_, readers_;  // operands not done; those who still read a value, and its being wanted
  std::vector<bool> done_;
  std::vector<std::size_t> ready_, order_;
};

}  // namespace

std::vector<std::size_t> eager_order(std::vector<std::vector<std::size_t>> const& operands, std::vector<bool> const& kept) {
  return Ordering(operands, kept).order();
}

}  // namespace sysid
