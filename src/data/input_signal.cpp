// An input record under its rule: builds the polynomials, reads them, and makes the records of the questions
// "half a sample later?" and "another rule?".
#include <algorithm>
#include <cmath>

#include "core/text/diagnostic.hpp"
#include "data/experiment.hpp"
#include "data/table/time_errors.hpp"

namespace sysid {

InputSignal::InputSignal(InputRule rule, std::vector<double> time, std::vector<double> samples) {
  if (time.size() < 2 || time.size() != samples.size()) throw InternalError("an input signal needs two samples, each with a time");
  InputRuleRow const& row = row_of(rule);
  if (row.equal_steps)
    if (std::size_t const i = unequal_step(time); i > 0)
      throw UserError(data_errors::unequal_steps(static_cast<int>(i) + 1, time[i] - time[i - 1], mean_step(time), std::nullopt));
  auto record = std::make_shared<Record>();
  record->rule = rule;
  record->degree = row.degree;
  record->coefficients = row.coefficients(time, samples);
  record->time = std::move(time);
  record->samples = std::move(samples);
  rows_ = static_cast<int>(record->samples.size());
  record_ = std::move(record);
}

InputSignal InputSignal::lines(std::vector<double> time, std::vector<double> const& begin, std::vector<double> const& end,
                               int pieces) {
  auto const each = static_cast<std::size_t>(pieces);
  std::vector<double> samples;
  for (std::size_t i = 0; i < time.size(); ++i) samples.push_back(begin[i * each]);
  InputSignal result(InputRule::zero_order, std::move(time), std::move(samples));
  Record record = *result.record_;
  record.degree = 1;
  record.pieces = pieces;
  record.ends_at_samples = false;
  record.coefficients.clear();
  for (std::size_t k = 0; k + each < begin.size(); ++k)
    record.coefficients.insert(record.coefficients.end(), {begin[k], end[k] - begin[k]});
  result.record_ = std::make_shared<Record const>(std::move(record));
  return result;
}

std::span<double const> InputSignal::piece(int interval, int piece) const {
  auto const count = static_cast<std::size_t>(record_->degree + 1);
  return std::span(record_->coefficients)
      .subspan(static_cast<std::size_t>((first_ + interval) * record_->pieces + piece) * count, count);
}

std::span<double const> InputSignal::coefficients(int interval) const {
  if (record_->pieces > 1) throw InternalError("an interval of several pieces has no polynomial");
  return piece(interval, 0);
}

double InputSignal::value(int interval, double s, bool from_left) const {
  // The next sample itself, not the sum of the coefficients, which is off in the last bit.
  if (s == 1 && record_->degree > 0 && record_->ends_at_samples) return sample(interval + 1);
  int which = 0;
  if (int const pieces = record_->pieces; pieces > 1) {
    // A place between two pieces is one, though the quotient that s is be off in the last bit: 15/22*22 is less than 15.
    double const exactly = s * pieces, whole = std::round(exactly);
    double const at = std::abs(exactly - whole) < 1e-9 ? whole : exactly;
    which = std::clamp(static_cast<int>(from_left ? std::ceil(at) - 1 : std::floor(at)), 0, pieces - 1);
    s = at - which;
  }
  std::span<double const> const c = piece(interval, which);
  double result = c.back();
  for (std::size_t p = c.size() - 1; p-- > 0;) result = result * s + c[p];
  return result;
}

double InputSignal::rate(int interval, double s) const {
  std::span<double const> const c = coefficients(interval);
  double result = 0;
  for (std::size_t p = c.size(); p-- > 1;) result = result * s + static_cast<double>(p) * c[p];
  auto const i = static_cast<std::size_t>(first_ + interval);
  return result / (record_->time[i + 1] - record_->time[i]);
}

InputSignal InputSignal::view(int first, int count) const {
  if (first < 0 || count < 1 || first + count > rows_) throw InternalError("a view of an input signal goes beyond it");
  InputSignal result = *this;
  result.first_ += first;
  result.rows_ = count;
  return result;
}

InputSignal InputSignal::reversed() const {
  auto record = std::make_shared<Record>(*record_);
  for (double& each : record->samples) each = -each;
  for (double& each : record->coefficients) each = -each;
  InputSignal result = *this;
  result.record_ = std::move(record);
  return result;
}

std::optional<InputSignal> InputSignal::under(InputRule rule) const {
  if (row_of(rule).equal_steps && unequal_step(record_->time) > 0) return std::nullopt;
  return InputSignal(rule, record_->time, record_->samples).view(first_, rows_);
}

InputSignal InputSignal::shifted(double samples) const {
  std::vector<double> const& old = record_->samples;
  std::size_t const n = old.size();
  bool const held = row_of(record_->rule).jumps;
  InputSignal whole = *this;
  whole.first_ = 0;
  std::vector<double> moved(n);
  for (std::size_t i = 0; i < n; ++i) {
    double const place = std::clamp(static_cast<double>(i) - samples, 0.0, static_cast<double>(n - 1));
    auto const before = std::min(static_cast<std::size_t>(place), n - 2);
    double const s = place - static_cast<double>(before);
    moved[i] = s == 0   ? old[before]
               : s == 1 ? old[before + 1]
               : held   ? old[before] + s * (old[before + 1] - old[before])
                        : whole.value(static_cast<int>(before), s);
  }
  return InputSignal(record_->rule, record_->time, std::move(moved)).view(first_, rows_);
}

}  // namespace sysid
