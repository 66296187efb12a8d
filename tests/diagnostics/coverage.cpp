// Bands that are missed by errors which last, and by errors of each sample.
#include "diagnostics/coverage.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "core/numeric/random.hpp"
#include "diagnostics/scores.hpp"

using namespace sysid;

namespace {

/// Bands of sd 1 of which the response is `lasting` of the variance; errors of sd `size`, that part of them of an autoregression.
Report predicted(std::uint64_t seed, int samples, double lasting, double size, double memory, double offset = 0) {
  Stream stream({seed, Purpose::test, 0, 0});
  PredictedQuantity quantity;
  quantity.name = "y";
  Prediction prediction;
  double slow = stream.normal();
  for (int i = 0; i < samples; ++i) {
    double const signal = 20 * std::sin(0.1 * i), half = 1.96 * std::sqrt(lasting);
    double const error = size * (std::sqrt(lasting) * slow + std::sqrt(1 - lasting) * stream.normal()) + offset;
    slow = memory * slow + std::sqrt(1 - memory * memory) * stream.normal();
    quantity.response.mean.push_back(signal);
    quantity.response.sd.push_back(std::sqrt(lasting));
    quantity.response.lower.push_back(signal - half);
    quantity.response.upper.push_back(signal + half);
    quantity.noisy.mean.push_back(signal);
    quantity.noisy.sd.push_back(1);
    quantity.noisy.lower.push_back(signal - 1.96);
    quantity.noisy.upper.push_back(signal + 1.96);
    quantity.measured.push_back(signal + error);
    prediction.scored.push_back(1);
  }
  quantity.response.draws = quantity.noisy.draws = 400;
  prediction.experiment = "d";
  prediction.quantities.push_back(quantity);
  Report report;
  report.predictions.push_back(prediction);
  return report;
}

/// A right prediction of log-normal samples of this log-sd, beside a mean that their largest hide.
Report log_normal_samples(double log_sd, bool logarithmic) {
  Report report = predicted(1, 500, 0, 1, 0);
  PredictedQuantity& quantity = report.predictions[0].quantities[0];
  for (std::size_t i = 0; i < quantity.measured.size(); ++i) {
    double const error = quantity.measured[i] - quantity.response.mean[i];
    quantity.response.mean[i] = std::exp(quantity.response.mean[i] / 80);
    quantity.measured[i] = quantity.response.mean[i] * std::exp(log_sd * error);
  }
  quantity.noisy = {};
  quantity.logarithmic = logarithmic;
  return report;
}

/// Of log-normal bands of this log-sd, the errors in logarithms; `offset` in log-sds.
int warned_log_normal(int records, int samples, double log_sd, double lasting, double memory, double offset) {
  int count = 0;
  for (int k = 0; k < records; ++k) {
    Report report = predicted(static_cast<std::uint64_t>(k + 1), samples, lasting, 1, memory, offset);
    PredictedQuantity& quantity = report.predictions[0].quantities[0];
    for (std::size_t i = 0; i < quantity.measured.size(); ++i) {
      double const middle = quantity.response.mean[i] / 20;
      double const error = quantity.measured[i] - quantity.response.mean[i];
      for (auto* const band : {&quantity.response, &quantity.noisy})
        for (auto* const each : {&band->lower, &band->upper})
          (*each)[i] = std::exp(middle + log_sd * ((*each)[i] - quantity.response.mean[i]));
      quantity.noisy.mean[i] = std::exp(middle + log_sd * log_sd / 2);
      quantity.measured[i] = std::exp(middle + log_sd * error);
    }
    count += add_coverage(report, false) ? 1 : 0;
  }
  return count;
}

int warned(int records, int samples, double lasting, double size, double memory, double offset = 0) {
  int count = 0;
  for (int k = 0; k < records; ++k) {
    Report report = predicted(static_cast<std::uint64_t>(k + 1), samples, lasting, size, memory, offset);
    count += add_coverage(report, false) ? 1 : 0;
  }
  return count;
}

}  // namespace

TEST_CASE("bands that are right are not blamed for errors that last from sample to sample") {
  CHECK(warned(300, 150, 1, 1, 0.97) <= 1);
  CHECK(warned(300, 500, 0.5, 1, 0.99) <= 1);
  CHECK(warned(300, 150, 0, 1, 0) == 0);
  CHECK(warned(100, 900, 1, 0.1, 0.999, 2) == 0);
}

TEST_CASE("bands of log-normal quantities are judged by logarithms, above and below") {
  for (double const log_sd : {0.3, 1.0}) {
    CHECK(warned_log_normal(200, 300, log_sd, 1, 0.97, 0) <= 1);
    CHECK(warned_log_normal(50, 300, log_sd, 0.95, 0.97, 4) == 50);
    CHECK(warned_log_normal(50, 300, log_sd, 0.95, 0.97, -4) == 50);
  }
}

TEST_CASE("bands that are too narrow are found by independent errors, and by lasting ones that are many or large") {
  CHECK(warned(100, 150, 0, 1.7, 0) >= 98);
  CHECK(warned(100, 150, 1, 1.7, 0) >= 95);
  CHECK(warned(100, 2000, 1, 2.5, 0.9) >= 98);
  CHECK(warned(100, 150, 1, 1, 0.97, 6) == 100);
  // One deviation that lasts for the whole record, of four sds.
  CHECK(warned(100, 900, 1, 0.1, 0.999, 4) == 100);
  // Noise is the whole band: what lasts of the errors is the model's own mistake.
  CHECK(warned(100, 150, 0.02, 1, 0, 2) == 100);
}

TEST_CASE("a prediction of a channel whose noise multiplies is compared with the mean of logarithms") {
  Report by_logarithms = log_normal_samples(1, true), plain = log_normal_samples(1, false);
  // The variance of the signal is 1/32, so of 33/32 of the logarithms 1 is left; of the values more than their variance.
  CHECK(find_score(fit_lines(by_logarithms)[0].scores, {ScoreKind::nmse}).value() == doctest::Approx(3200 / 33.).epsilon(0.02));
  CHECK_FALSE(add_coverage(by_logarithms, false));
  CHECK(by_logarithms.findings.empty());
  CHECK_FALSE(add_coverage(plain, false));
  CHECK(plain.findings.size() == 1);
}
