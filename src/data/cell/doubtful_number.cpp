// A spike of another size may be a measurement: it is left to the residuals.
#include "data/cell/doubtful_number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

namespace sysid {
namespace {

/// Numbers of nines, 99.99 and 9999, are marks besides these, of either sign.
constexpr double known_marks[] = {999.25, 7999, 32767, 32768, 65535,  2147483647, 2147483648,
                                  1e20,   1e30, 1e31,  1e35,  9.9e37, 9.91e37,    3.4e38};

/// Beyond what is measured in any unit, where the others are a millionth of it or less: 3.4028235e38 in as many digits as were
/// written.
constexpr double beyond_measure = 1e29, of_others = 1e-6;

/// But for rounding, as by a change of units and back.
bool is_known(double size) {
  return std::any_of(std::begin(known_marks), std::end(known_marks),
                     [&](double mark) { return std::fabs(size - mark) <= 1e-12 * mark; });
}

bool only_nines(double size) {
  constexpr double least = 9.99;
  if (size < least) return false;
  std::string digits = fmt::format("{:.11e}", size);
  digits.resize(digits.find('e'));
  std::erase(digits, '.');
  digits.erase(digits.find_last_not_of('0') + 1);
  return digits.size() >= 3 && digits.find_first_not_of('9') == std::string::npos;
}

/// A number that is one of single precision, as it was meant: 99.9 for 99.90000152587890625.
double as_written(double size) {
  auto const single = static_cast<float>(size);
  if (static_cast<double>(single) != size) return size;
  std::string const digits = fmt::format("{}", single);
  double written = size;
  std::from_chars(digits.data(), digits.data() + digits.size(), written);
  return written;
}

bool is_mark(double value) {
  if (!std::isfinite(value)) return false;
  double const size = std::fabs(value);
  if (size >= beyond_measure) return true;
  double const written = as_written(size);
  return is_known(written) || only_nines(written);
}

struct Others {
  double least = std::numeric_limits<double>::infinity(), most = -least;
};

bool is_far(double mark, Others const& others) {
  constexpr double times = 5, surely_below = -999;
  if (others.least > others.most) return false;  // there are none
  double const largest = std::max(std::fabs(others.least), std::fabs(others.most)), size = std::fabs(mark);
  if (size >= beyond_measure && !is_known(size) && largest > size * of_others) return false;
  if (mark <= surely_below && others.least >= mark / times) return true;
  double const range = others.most - others.least;
  double const distance = mark > others.most ? mark - others.most : others.least - mark;
  return range > 0 && size > times * largest && distance > times * range;
}

}  // namespace

std::vector<DoubtfulNumber> doubtful_numbers(std::vector<double> const& values) {
  std::vector<DoubtfulNumber> found;
  Others others;
  for (std::size_t i = 0; i < values.size(); ++i) {
    double const value = values[i];
    if (std::isnan(value)) continue;
    if (!is_mark(value)) {
      others.least = std::min(others.least, value);
      others.most = std::max(others.most, value);
      continue;
    }
    auto same = std::find_if(found.begin(), found.end(), [&](DoubtfulNumber const& each) { return each.value == value; });
    if (same == found.end()) {
      constexpr std::size_t most_marks = 16;  // of more, they are numbers as any others
      if (found.size() == most_marks) return {};
      same = found.insert(found.end(), {value, {}});
    }
    same->places.push_back(i);
  }
  std::erase_if(found, [&](DoubtfulNumber const& each) { return !is_far(each.value, others); });
  return found;
}

}  // namespace sysid
