// The state of a chain as one block of numbers: each part names its fields once, for storing and restoring alike.
#pragma once
#include <cmath>
#include <cstdint>
#include <vector>

#include "inference/backend/checkpoint.hpp"

namespace sysid::nuts {

/// Fields are visited in a fixed order: numbers as they are, vectors behind their length.
class NumberWriter {
 public:
  void operator()(double const& value) { numbers_.push_back(value); }
  void operator()(int const& value) { numbers_.push_back(value); }
  void operator()(bool const& value) { numbers_.push_back(value ? 1 : 0); }
  void operator()(std::uint64_t const& value) { numbers_.push_back(static_cast<double>(value)); }  // counts, below 2^53
  void operator()(std::vector<double> const& values) {
    numbers_.push_back(static_cast<double>(values.size()));
    numbers_.insert(numbers_.end(), values.begin(), values.end());
  }
  std::vector<double> const& numbers() const { return numbers_; }

 private:
  std::vector<double> numbers_;
};

/// Throws checkpoint::Mismatch where the block ends early or holds no such field.
class NumberReader {
 public:
  explicit NumberReader(std::vector<double> numbers) : numbers_(std::move(numbers)) {}
  void operator()(double& value) { value = next(); }
  void operator()(int& value) { value = static_cast<int>(count(1e9)); }
  void operator()(bool& value) { value = count(1) == 1; }
  void operator()(std::uint64_t& value) { value = static_cast<std::uint64_t>(count(9e15)); }
  void operator()(std::vector<double>& values) {
    auto const size = static_cast<std::size_t>(count(static_cast<double>(numbers_.size() - at_)));
    if (size > numbers_.size() - at_) throw checkpoint::Mismatch("its trajectories are truncated");
    auto const first = numbers_.begin() + static_cast<std::ptrdiff_t>(at_);
    values.assign(first, first + static_cast<std::ptrdiff_t>(size));
    at_ += size;
  }
  /// All has been read.
  void end() const {
    if (at_ != numbers_.size()) throw checkpoint::Mismatch("its trajectories differ in form");
  }

 private:
  double next() {
    if (at_ == numbers_.size()) throw checkpoint::Mismatch("its trajectories are truncated");
    return numbers_[at_++];
  }
  double count(double most) {
    double const value = next();
    if (!(value >= 0 && value <= most) || value != std::floor(value)) throw checkpoint::Mismatch("its trajectories are damaged");
    return value;
  }
  std::vector<double> numbers_;
  std::size_t at_ = 0;
};

}  // namespace sysid::nuts
