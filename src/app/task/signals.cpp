// Signals from core/numeric/elementary and counter-based streams, so that made data are the same bytes everywhere.
#include "app/task/signals.hpp"

#include <cmath>
#include <numbers>

#include "check/checked/harmonics.hpp"
#include "core/numeric/elementary.hpp"
#include "core/numeric/fourier.hpp"
#include "core/system/interrupt.hpp"
#include "core/text/diagnostic.hpp"

namespace sysid {
namespace {

constexpr int many = 1 << 16;  // samples between two looks at the signals

std::vector<double> multisine(InputGenerator const& generator, int samples, double step, Stream& stream) {
  HarmonicRange const band = harmonics_in_band(generator.arguments.at("lowest"), generator.arguments.at("highest"), samples, step);
  if (band.empty()) throw InternalError("a multisine without a harmonic was let through");
  auto const size = static_cast<std::size_t>(samples);
  // sin(2 pi k i/N + phase) is the imaginary part of exp(i phase) exp(2 pi i k i/N).
  std::vector<double> re(size, 0.0), values(size, 0.0);
  for (int k = band.first; k <= band.last; ++k) {
    if (k % many == 0) stop_if_interrupted();
    double const phase = 2 * std::numbers::pi * stream.uniform();
    re[static_cast<std::size_t>(k)] = elementary::cos(phase);
    values[static_cast<std::size_t>(k)] = elementary::sin(phase);
  }
  add_harmonics(re, values, &stop_if_interrupted);
  double const amplitude = generator.arguments.at("sd") * std::sqrt(2.0 / (band.last - band.first + 1));
  for (double& value : values) value = generator.arguments.at("mean") + amplitude * value;
  return values;
}

}  // namespace

std::vector<double> generate(InputGenerator const& generator, int samples, double step, StreamKey key) {
  Stream stream(key);
  auto const argument = [&](char const* name) { return generator.arguments.at(name); };
  if (generator.kind == InputGenerator::Kind::multisine) return multisine(generator, samples, step, stream);
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(samples));
  for (int i = 0; i < samples; ++i) {
    if (i % many == 0) stop_if_interrupted();
    switch (generator.kind) {
      case InputGenerator::Kind::gaussian:
        values.push_back(argument("mean") + argument("sd") * stream.normal());
        break;
      case InputGenerator::Kind::sine:
        values.push_back(argument("mean") +
                         argument("amplitude") *
                             elementary::sin(2 * std::numbers::pi * argument("frequency") * i * step + argument("phase")));
        break;
      default:
        values.push_back(argument("value"));
        break;
    }
  }
  return values;
}

}  // namespace sysid
