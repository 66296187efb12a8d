// One pass, after one that finds which channels have samples at all.
#include "app/preflight/rows_ahead.hpp"

#include <algorithm>
#include <vector>

namespace sysid {
namespace {

struct SeenSamples {
  std::size_t channel = 0;
  std::size_t samples = 0, rows = 0;  // so far; rows since the first sample, with its own
};

}  // namespace

int rows_ahead(Experiment const& experiment, std::size_t most) {
  std::size_t const all = experiment.time.size();
  std::vector<SeenSamples> channels;
  for (std::size_t c = 0; c < experiment.measured.size(); ++c) {
    std::size_t row = 0;
    while (row < all && !experiment.is_scored(c, row)) ++row;
    if (row < all) channels.push_back({c});
  }
  auto const seen = [&](SeenSamples const& each) { return 10 * each.samples >= most || each.rows >= most; };
  std::size_t row = 0, sampled = 0, since_last = 0;
  while (row < all && since_last < 10 * most && (sampled < most || !std::ranges::all_of(channels, seen))) {
    bool any = false;
    for (SeenSamples& each : channels) {
      bool const here = experiment.is_scored(each.channel, row);
      each.samples += here ? 1 : 0;
      each.rows += each.samples > 0 ? 1 : 0;
      any = any || here;
    }
    sampled += any ? 1 : 0;
    bool const begun = std::ranges::all_of(channels, [](SeenSamples const& each) { return each.samples > 0; });
    since_last += begun && !channels.empty() ? 1 : 0;
    ++row;
  }
  return static_cast<int>(row);
}

}  // namespace sysid
