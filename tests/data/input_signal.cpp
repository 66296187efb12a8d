// Input rules: what each gives between its samples, at which order, and what a view and a shift leave unchanged.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/text/diagnostic.hpp"
#include "data/experiment.hpp"

using namespace sysid;

namespace {

constexpr double pi = std::numbers::pi;
std::vector<InputRule> const all_rules = [] {
  std::vector<InputRule> rules;
  for (InputRuleRow const& row : input_rules()) rules.push_back(row.rule);
  return rules;
}();

std::vector<double> grid(int n, double step) {
  std::vector<double> time;
  for (int i = 0; i < n; ++i) time.push_back(i * step);
  return time;
}

template <class F>
InputSignal sampled(InputRule rule, std::vector<double> const& time, F f) {
  std::vector<double> samples;
  for (double const t : time) samples.push_back(f(t));
  return InputSignal(rule, time, samples);
}

/// Largest error of the value over intervals [from, to).
template <class F>
double worst(InputSignal const& signal, std::vector<double> const& time, F f, int from, int to) {
  double error = 0;
  for (int i = from; i < to; ++i)
    for (double s = 0; s <= 1; s += 0.0625) {
      auto const k = static_cast<std::size_t>(i);
      error = std::max(error, std::fabs(signal.value(i, s) - f(time[k] + s * (time[k + 1] - time[k]))));
    }
  return error;
}

/// Sines at the given fractions of the sampling rate 1, phases spread, the sum of amplitudes 1.
struct Multisine {
  std::vector<double> frequencies;
  double operator()(double t) const {
    double sum = 0;
    for (std::size_t k = 0; k < frequencies.size(); ++k)
      sum += std::sin(2 * pi * frequencies[k] * t + 1.7 * static_cast<double>(k * k)) / static_cast<double>(frequencies.size());
    return sum;
  }
  double rate(double t) const {
    double sum = 0;
    for (std::size_t k = 0; k < frequencies.size(); ++k)
      sum += 2 * pi * frequencies[k] * std::cos(2 * pi * frequencies[k] * t + 1.7 * static_cast<double>(k * k)) /
             static_cast<double>(frequencies.size());
    return sum;
  }
};

}  // namespace

TEST_CASE("every rule but the held one goes through its samples exactly") {
  std::vector<double> const samples = {0.1, -1.3, 2.7, 1e-9, 3.3, 0.7, -12.1};
  for (InputRule const rule : all_rules) {
    InputSignal const signal(rule, grid(7, 0.1), samples);
    for (int i = 0; i + 1 < 7; ++i) {
      auto const k = static_cast<std::size_t>(i);
      CHECK(signal.sample(i) == samples[k]);
      CHECK(signal.value(i, 0) == samples[k]);
      CHECK(signal.value(i, 1) == (rule == InputRule::zero_order ? samples[k] : samples[k + 1]));
    }
  }
}

TEST_CASE("a zero-order hold keeps the sample until the next one") {
  InputSignal const signal(InputRule::zero_order, {0, 1, 3}, {5, -2, 7});
  CHECK(signal.degree() == 0);
  CHECK(signal.value(0, 0.999) == 5);
  CHECK(signal.value(1, 0.5) == -2);
  CHECK(signal.rate(0, 0.5) == 0);
}

TEST_CASE("a linear input and its rate are those of the straight line") {
  InputSignal const signal(InputRule::linear, {0, 1, 3}, {5, -2, 7});
  CHECK(signal.value(0, 0.25) == 3.25);
  CHECK(signal.value(1, 0.5) == 2.5);
  CHECK(signal.rate(0, 0.1) == -7);
  CHECK(signal.rate(1, 0.9) == 4.5);
}

TEST_CASE("the error of a linear input falls with the square of the step") {
  auto const f = [](double t) { return std::sin(t); };
  std::vector<double> const coarse = grid(41, 0.1), fine = grid(81, 0.05);
  double const error = worst(sampled(InputRule::linear, coarse, f), coarse, f, 0, 40);
  double const finer = worst(sampled(InputRule::linear, fine, f), fine, f, 0, 80);
  CHECK(error <= 0.1 * 0.1 / 8);  // h^2 / 8 max |f''|
  CHECK(std::log2(error / finer) == doctest::Approx(2).epsilon(0.02));
}

TEST_CASE("a cubic input reproduces cubics on uneven steps, ends included") {
  auto const f = [](double t) { return 1 - 2 * t + 0.5 * t * t - 0.25 * t * t * t; };
  auto const rate = [](double t) { return -2 + t - 0.75 * t * t; };
  for (std::vector<double> const& time : {std::vector<double>{0, 1, 1.5, 4, 4.25, 6}, std::vector<double>{0, 0.1, 2, 5}}) {
    InputSignal const signal = sampled(InputRule::cubic, time, f);
    int const intervals = signal.rows() - 1;
    CHECK(worst(signal, time, f, 0, intervals) < 1e-12);
    for (int i = 0; i < intervals; ++i) {
      auto const k = static_cast<std::size_t>(i);
      CHECK(signal.rate(i, 0.3) == doctest::Approx(rate(time[k] + 0.3 * (time[k + 1] - time[k]))).epsilon(1e-12));
    }
  }
}

TEST_CASE("a cubic input of two samples is a line and of three a parabola") {
  InputSignal const line(InputRule::cubic, {0, 2}, {1, 5});
  CHECK(line.value(0, 0.25) == doctest::Approx(2).epsilon(1e-15));
  auto const f = [](double t) { return 3 + t - t * t; };
  std::vector<double> const time = {0, 1, 4};
  CHECK(worst(sampled(InputRule::cubic, time, f), time, f, 0, 2) < 1e-14 * 10);
}

TEST_CASE("the error of a cubic input falls with the fourth power of the step, up to the ends") {
  auto const f = [](double t) { return std::sin(t + 0.4); };
  std::vector<double> const coarse = grid(41, 0.1), fine = grid(81, 0.05);
  double const error = worst(sampled(InputRule::cubic, coarse, f), coarse, f, 0, 40);
  double const finer = worst(sampled(InputRule::cubic, fine, f), fine, f, 0, 80);
  CHECK(std::log2(error / finer) > 3.8);
  // Inside, 5/384 h^4 max |f''''| (Hall and Meyer 1976), whose constant no C2 cubic spline interpolant exceeds there.
  double const inside = worst(sampled(InputRule::cubic, fine, f), fine, f, 20, 60);
  CHECK(inside <= 1.01 * 5.0 / 384 * std::pow(0.05, 4));
}

TEST_CASE("a cubic input is twice continuously differentiable") {
  std::vector<double> const time = {0, 1, 1.5, 4, 4.25, 6, 7};
  InputSignal const signal(InputRule::cubic, time, {0.1, -1.3, 2.7, 1e-9, 3.3, 0.7, -12.1});
  for (int i = 0; i + 2 < signal.rows(); ++i) {
    auto const k = static_cast<std::size_t>(i);
    CHECK(signal.rate(i, 1) == doctest::Approx(signal.rate(i + 1, 0)).epsilon(1e-12));
    auto const second = [&](int interval, double s, double h) {
      std::span<double const> const c = signal.coefficients(interval);
      return (2 * c[2] + 6 * c[3] * s) / (h * h);
    };
    CHECK(second(i, 1, time[k + 1] - time[k]) == doctest::Approx(second(i + 1, 0, time[k + 2] - time[k + 1])).epsilon(1e-11));
  }
}

TEST_CASE("a band-limited input reconstructs a multisine up to a third of the sampling rate") {
  Multisine const f{{0.01, 0.05, 0.11, 0.17, 0.23, 0.29, 0.33}};
  std::vector<double> const time = grid(400, 1);
  InputSignal const signal = sampled(InputRule::band_limited, time, f);
  // Away from the ends. Highest line: 2.07 rad a step, so the degree costs at most 2 * 1.04^8 / (2^7 8!) = 5e-7, the stop band (118
  // dB) 1.3e-6.
  CHECK(worst(signal, time, f, 40, 359) < 3e-6);
  double rate_error = 0;
  for (int i = 40; i < 359; ++i)
    for (double s = 0; s <= 1; s += 0.125) rate_error = std::max(rate_error, std::fabs(signal.rate(i, s) - f.rate(i + s)));
  CHECK(rate_error < 3e-5);  // differentiating loses one order of the degree
  // Where linear interpolation is off by tenths.
  CHECK(worst(sampled(InputRule::linear, time, f), time, f, 40, 359) > 0.1);
}

TEST_CASE("a band-limited input keeps 0.45 of the sampling rate and gives way beyond") {
  std::vector<double> const time = grid(300, 1);
  Multisine const kept{{0.45}}, lost{{0.495}};
  CHECK(worst(sampled(InputRule::band_limited, time, kept), time, kept, 40, 259) < 1e-4);
  CHECK(worst(sampled(InputRule::band_limited, time, lost), time, lost, 40, 259) > 1e-3);
}

TEST_CASE("a band-limited constant and ramp are exact up to the ends") {
  std::vector<double> const time = grid(20, 0.5);
  auto const constant = [](double) { return 3.7; };
  auto const ramp = [](double t) { return 2 - 0.3 * t; };
  CHECK(worst(sampled(InputRule::band_limited, time, constant), time, constant, 0, 19) < 1e-13);
  // The kernel's weights sum to one; its first moment vanishes to the stop band's depth only, scaled by the reach.
  CHECK(worst(sampled(InputRule::band_limited, time, ramp), time, ramp, 0, 19) < 1e-5);
  CHECK(InputSignal(InputRule::band_limited, {0, 1}, {1, 3}).value(0, 0.5) == doctest::Approx(2).epsilon(1e-5));
}

TEST_CASE("near the ends a band-limited input of an odd function about them is as good as inside") {
  // sin is odd about t = 0 and about t = 400 for whole periods: the reflection continues it exactly.
  Multisine const f{{0.05}};
  std::vector<double> const time = grid(401, 1);
  auto const odd = [](double t) { return std::sin(2 * pi * 0.05 * t); };
  CHECK(worst(sampled(InputRule::band_limited, time, odd), time, odd, 0, 400) < 3e-6);
  // A cosine has a curved end that odd reflection kinks: a percent, and that only near it.
  auto const even = [](double t) { return std::cos(2 * pi * 0.05 * t); };
  InputSignal const signal = sampled(InputRule::band_limited, time, even);
  CHECK(worst(signal, time, even, 0, 400) < 3e-2);
  CHECK(worst(signal, time, even, 40, 360) < 3e-6);
}

TEST_CASE("uneven steps are refused under band_limited with the row, and fine elsewhere") {
  std::vector<double> time = grid(10, 0.1);
  time[6] += 1e-5;
  std::vector<double> const samples(10, 1.0);
  CHECK_NOTHROW(InputSignal(InputRule::cubic, time, samples));
  try {
    InputSignal const signal(InputRule::band_limited, time, samples);
    FAIL("nothing was thrown");
  } catch (UserError const& error) {
    CHECK(error.diagnostic().code == "E4015");
    CHECK(error.diagnostic().message.find("row 7") != std::string::npos);
  }
}

TEST_CASE("a view reads the same curve from another row") {
  Multisine const f{{0.05, 0.31}};
  for (InputRule const rule : all_rules) {
    InputSignal const signal = sampled(rule, grid(60, 1), f);
    InputSignal const view = signal.view(20, 10).view(3, 5);
    CHECK(view.rows() == 5);
    for (int i = 0; i < 4; ++i) {
      CHECK(view.sample(i) == signal.sample(i + 23));
      for (double const s : {0.0, 0.3, 1.0}) {
        CHECK(view.value(i, s) == signal.value(i + 23, s));
        CHECK(view.rate(i, s) == signal.rate(i + 23, s));
      }
    }
  }
  InputSignal const signal = sampled(InputRule::linear, grid(5, 1), f);
  CHECK_THROWS_AS(signal.view(3, 3), InternalError);
}

TEST_CASE("half a sample of delay is the mean of neighbours under the held and the linear rule") {
  for (InputRule const rule : {InputRule::zero_order, InputRule::linear}) {
    InputSignal const late = InputSignal(rule, {0, 1, 2, 3}, {4, 8, 2, 6}).shifted(0.5);
    CHECK(late.rule() == rule);
    CHECK(late.sample(0) == 4);  // holds the end sample
    CHECK(late.sample(1) == 6);
    CHECK(late.sample(2) == 5);
    CHECK(late.sample(3) == 4);
    InputSignal const early = InputSignal(rule, {0, 1, 2, 3}, {4, 8, 2, 6}).shifted(-0.5);
    CHECK(early.sample(0) == 6);
    CHECK(early.sample(3) == 6);
  }
}

TEST_CASE("a shift counts rows, however far apart they are") {
  std::vector<double> const time = {0, 1, 1.5, 6, 7, 7.25};  // a gap
  for (InputRule const rule : {InputRule::zero_order, InputRule::linear, InputRule::cubic}) {
    InputSignal const signal(rule, time, {1, 2, 4, 8, 16, 32});
    for (int const rows : {1, 2, 3, -1, -2}) {
      InputSignal const moved = signal.shifted(rows);
      for (int i = 0; i < 6; ++i) CHECK(moved.sample(i) == signal.sample(std::clamp(i - rows, 0, 5)));
    }
  }
  InputSignal const late = InputSignal(InputRule::linear, time, {1, 2, 4, 8, 16, 32}).shifted(0.5);
  CHECK(late.sample(3) == 6);
  CHECK(late.sample(4) == 12);
  CHECK(InputSignal(InputRule::linear, time, {1, 2, 4, 8, 16, 32}).shifted(-0.5).sample(2) == 6);
}

TEST_CASE("a shift by a fraction delays a band-limited and a cubic signal") {
  Multisine const f{{0.02, 0.3}}, slow{{0.02}};
  std::vector<double> const time = grid(200, 1);
  auto const late = [&](double t) { return f(t - 0.3); };
  CHECK(worst(sampled(InputRule::band_limited, time, f).shifted(0.3), time, late, 90, 110) < 1e-5);
  auto const slow_late = [&](double t) { return slow(t - 0.3); };
  CHECK(worst(sampled(InputRule::cubic, time, slow).shifted(0.3), time, slow_late, 20, 180) <
        2 * 5.0 / 384 * std::pow(2 * pi * 0.02, 4));
}

TEST_CASE("a whole sample of delay moves the samples, and a view keeps its rows") {
  for (InputRule const rule : all_rules) {
    InputSignal const late = InputSignal(rule, grid(6, 0.5), {1, 2, 4, 8, 16, 32}).view(2, 3).shifted(1);
    REQUIRE(late.rows() == 3);
    CHECK(late.sample(0) == doctest::Approx(2).epsilon(1e-12));
    CHECK(late.sample(2) == doctest::Approx(8).epsilon(1e-12));
  }
}

TEST_CASE("input signals: lines on pieces of an interval jump between the pieces") {
  InputSignal const signal = InputSignal::lines({0, 2, 3}, {1, 5, 7, 9, 0, 0}, {2, 6, 8, 10, 0, 0}, 2);
  CHECK(signal.sample(1) == 7);
  CHECK(signal.value(0, 0) == 1);
  CHECK(signal.value(0, 0.25) == 1.5);
  CHECK(signal.value(0, 0.5) == 5);
  CHECK(signal.value(0, 0.5, true) == 2);
  CHECK(signal.value(0, 1) == 6);
  CHECK(signal.view(1, 2).value(0, 0.75) == 9.5);
}

TEST_CASE("each step reads its own line, whatever their number") {
  for (int const lines : {1, 8, 22, 23, 29, 50, 60, 104}) {
    CAPTURE(lines);
    std::vector<double> begin, end;
    for (int i = 0; i < 2 * lines; ++i) {
      begin.push_back(10 * i);
      end.push_back(10 * i + 2);
    }
    InputSignal const signal = InputSignal::lines({0, 1}, begin, end, lines);
    for (int step = 0; step < lines; ++step) {
      CAPTURE(step);
      CHECK(signal.value(0, (step + 0.0) / lines) == doctest::Approx(10 * step).epsilon(1e-12));
      CHECK(signal.value(0, (step + 0.5) / lines) == doctest::Approx(10 * step + 1).epsilon(1e-12));
      CHECK(signal.value(0, (step + 1.0) / lines, true) == doctest::Approx(10 * step + 2).epsilon(1e-12));
    }
  }
}
