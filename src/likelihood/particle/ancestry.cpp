// One column of origins for each sample that is still followed.
#include "likelihood/particle/ancestry.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace sysid {

Ancestry::Ancestry(int particles, Emit emit)
    : particles_(particles),
      emit_(std::move(emit)),
      seen_(static_cast<std::size_t>(particles), 0),
      next_(static_cast<std::size_t>(particles)) {}

int Ancestry::fewest(int particles) { return std::max(1, std::min(particles / 4, 100)); }

void Ancestry::add(int kind, int sample, LaneArray values) {
  entries_.push_back({kind, sample, std::move(values), std::vector<int>(static_cast<std::size_t>(particles_))});
  std::iota(entries_.back().origin.begin(), entries_.back().origin.end(), 0);
}

int Ancestry::different(std::span<int const> origin) {
  ++mark_;
  int count = 0;
  for (int const each : origin) {
    int& seen = seen_[static_cast<std::size_t>(each)];
    count += seen != mark_ ? 1 : 0;
    seen = mark_;
  }
  return count;
}

void Ancestry::emit(Entry const& entry, std::span<double const> weights) const {
  emit_(entry.kind, entry.sample, entry.values.view(), entry.origin, weights);
}

// Ancestors of later samples are at least as many as those of earlier ones.
void Ancestry::resample(std::span<int const> ancestors, std::span<double const> weights) {
  std::size_t given = 0;
  bool enough = false;
  for (Entry& entry : entries_) {
    for (std::size_t w = 0; w < ancestors.size(); ++w) next_[w] = entry.origin[static_cast<std::size_t>(ancestors[w])];
    enough = enough || different(next_) >= fewest(particles_);
    if (!enough) {
      emit(entry, weights);
      ++given;
      continue;
    }
    entry.origin.swap(next_);
  }
  entries_.erase(entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(given));
}

void Ancestry::forget(int sample, std::span<double const> weights) {
  while (!entries_.empty() && entries_.front().sample < sample - longest) {
    emit(entries_.front(), weights);
    entries_.pop_front();
  }
}

void Ancestry::end(std::span<double const> weights) {
  for (Entry const& entry : entries_) emit(entry, weights);
  entries_.clear();
}

}  // namespace sysid
