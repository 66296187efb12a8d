// What 10 000 densities of Duffing cost in the engine: prior and likelihood of one batch, processor time of one thread, median.
// density.py runs this beside the same from NumPy.
//
//   bench_density [ROUNDS]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "app/density/fit_density.hpp"
#include "core/system/files.hpp"
#include "load/load.hpp"
#include "processor_time.hpp"

using namespace sysid;

namespace {

constexpr int count = 10000;
constexpr double truth[] = {1, 20, 1e4, 5e9, 8e10};

/// Values a thousandth apart around the true ones; density.py makes the same.
LaneArray some_values() {
  LaneArray values(5, count);
  for (int p = 0; p < 5; ++p)
    for (int w = 0; w < count; ++w) values(p, w) = truth[p] * (1 + 1e-3 * std::sin(0.1 * w + p));
  return values;
}

}  // namespace

int main(int argument_count, char** arguments) {
  int const rounds = argument_count > 1 ? std::atoi(arguments[1]) : 9;
  Source source(SYSID_SOURCE_DIR "/models/duffing/duffing.sysid", read_file(SYSID_SOURCE_DIR "/models/duffing/duffing.sysid"));
  Diagnostics diagnostics;
  auto const file = load(source, diagnostics);
  RunOptions options;  // one thread
  SilentProgress progress;
  std::ostringstream out, notices;
  Session session(source, *file, options, progress, out, notices);
  int fit = 0;
  while (!std::holds_alternative<FitTask>(file->tasks[static_cast<std::size_t>(fit)].what)) ++fit;
  FitDensity const density(session, fit);
  LaneArray const values = some_values();
  LaneArray theta(5, count);
  density.target().unconstrain(values, theta);
  std::vector<double> prior(count), likelihood(count), seconds;
  auto const batch = [&] {
    Ledger ledger;
    density.target().log_prior(theta, prior);
    density.target().log_likelihood(theta, likelihood, ledger);
  };
  for (int i = 0; i < 20; ++i) batch();  // machine code is there
  for (int round = 0; round < rounds; ++round) seconds.push_back(processor_time::of(batch));
  std::printf("%.6f\n", 1e3 * processor_time::median(seconds));
}
