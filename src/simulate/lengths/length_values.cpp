// Rows of registers are copied to and fro; what is not kept is computed again.
#include "simulate/lengths/length_values.hpp"

#include <algorithm>
#include <utility>

namespace sysid {
namespace {

constexpr std::size_t most_rows = 2048;  // of a block of 64 lanes a megabyte, which stays in the second-level cache

}  // namespace

LengthValues::LengthValues(SimulationProgram const& program, Executor executor, double* registers, int lengths, Run run,
                           Machine machine)
    : program_(program), executor_(executor), registers_(registers), run_(std::move(run)), lengths_(lengths), machine_(machine) {
  if (lengths_ == 1) return;
  if (machine_.function != nullptr) {
    auto const vector = static_cast<std::size_t>(machine_.lanes);
    inputs_.resize(static_cast<std::size_t>(program.registers.parameters) * vector);
    outputs_.resize(program.length_values.size() * vector);
  }
  std::size_t const of_a_length = program.length_values.size() + static_cast<std::size_t>(slopes());
  kept_.resize(std::clamp<std::size_t>(most_rows / std::max<std::size_t>(1, of_a_length), 1, static_cast<std::size_t>(lengths_)));
}

int LengthValues::first_slope() const {
  return program_.registers.first_slope() + static_cast<int>(program_.source.adjoint_by.size());
}

int LengthValues::slopes() const {
  int const all = program_.registers.slopes;
  return all == 0 ? 0 : all - static_cast<int>(program_.source.adjoint_by.size());
}

void LengthValues::parameters_changed() {
  if (lengths_ == 1) return;
  for (Kept& each : kept_) each.values.clear();
  current_ = computed_ = 0;
}

void LengthValues::registers_changed() {
  if (lengths_ == 1) return;
  parameters_changed();
  current_ = computed_ = -1;
}

void LengthValues::compute(int length) {
  if (computed_ == length) return;
  run_(program_.prologue, length);
  computed_ = length;
}

/// Parameters are read where they stand, so that it does not matter when they were put there.
bool LengthValues::compute_by_machine(int length) {
  if (machine_.function == nullptr) return false;
  std::vector<int> const& values = program_.length_values;
  int const vector = machine_.lanes;
  for (int first = 0; first < executor_.width; first += vector) {
    int const count = std::min(vector, executor_.width - first);
    double* to = inputs_.data();
    for (int p = 0; p < program_.registers.parameters; ++p, to += vector) {
      std::copy_n(row(p) + first, count, to);
      std::fill_n(to + count, vector - count, to[count - 1]);
    }
    native::Call call;
    call.registers = inputs_.data();
    call.rows = &machine_.rows;
    call.out = outputs_.data();
    call.from = call.look_from = length;
    call.to = length + 1;
    machine_.function(&call);
    double const* from = outputs_.data();
    for (int const each : values) {
      std::copy_n(from, count, row(each) + first);
      from += vector;
    }
  }
  return true;
}

void LengthValues::take(int length) {
  if (length == current_) return;
  if (backwards_) put_away_slopes();
  Kept* const place = kept(length);
  std::vector<int> const& rows = program_.length_values;
  auto const width = static_cast<std::size_t>(executor_.width);
  if (place != nullptr && !place->values.empty()) {
    for (std::size_t r = 0; r < rows.size(); ++r) std::copy_n(place->values.data() + r * width, executor_.width, row(rows[r]));
    computed_ = computed_ == length ? length : -1;
  } else {
    computed_ = -1;
    if (!compute_by_machine(length)) compute(length);
    if (place != nullptr) {
      place->values.resize(std::max<std::size_t>(1, rows.size() * width));
      for (std::size_t r = 0; r < rows.size(); ++r) std::copy_n(row(rows[r]), executor_.width, place->values.data() + r * width);
    }
  }
  current_ = length;
  if (backwards_) take_slopes(length);
}

void LengthValues::start_reverse() {
  if (lengths_ == 1) return;
  backwards_ = true;
  for (Kept& each : kept_) each.slopes.clear();
}

void LengthValues::put_away_slopes() {
  Kept* const place = kept(current_);
  if (place == nullptr) return;
  auto const width = static_cast<std::size_t>(executor_.width);
  place->slopes.resize(static_cast<std::size_t>(slopes()) * width);
  for (int r = 0; r < slopes(); ++r)
    std::copy_n(row(first_slope() + r), executor_.width, place->slopes.data() + static_cast<std::size_t>(r) * width);
}

void LengthValues::take_slopes(int length) {
  Kept const* const place = kept(length);
  auto const width = static_cast<std::size_t>(executor_.width);
  for (int r = 0; r < slopes(); ++r) {
    if (place != nullptr && !place->slopes.empty())
      std::copy_n(place->slopes.data() + static_cast<std::size_t>(r) * width, executor_.width, row(first_slope() + r));
    else
      std::fill_n(row(first_slope() + r), executor_.width, 0.0);
  }
}

void LengthValues::step_reversed() {
  if (lengths_ > 1 && !keeps(current_)) pass_on_slopes();
}

/// From those of the current length, which become 0.
void LengthValues::pass_on_slopes() {
  compute(current_);
  run_(program_.reverse.values, current_);
  for (int r = 0; r < slopes(); ++r) std::fill_n(row(first_slope() + r), executor_.width, 0.0);
}

void LengthValues::finish_reverse() {
  if (lengths_ == 1) return;
  put_away_slopes();
  for (int length = 0; length < static_cast<int>(kept_.size()); ++length) {
    if (kept_[static_cast<std::size_t>(length)].slopes.empty()) continue;
    take_slopes(length);
    current_ = length;
    pass_on_slopes();
  }
  backwards_ = false;
  current_ = computed_;
}

}  // namespace sysid
