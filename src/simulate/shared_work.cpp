// The lanes of a rank follow from the batch and the number of ranks alone, so nothing is said about who does what.
#include "simulate/shared_work.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>

#include "core/ranks/own.hpp"

namespace sysid {
namespace {

/// [s] of a lane-instruction on one thread, on the quick side: machine code in wide vectors.
constexpr double instruction = 5e-11;

int in_grains(int lanes, int grain) { return (lanes + grain - 1) / grain; }

/// The first lane of a part: whole grains, as evenly as they go.
int boundary(Work const& work, int part, int parts) {
  std::int64_t const grains = in_grains(work.width, work.grain);
  return std::min<int>(work.width, static_cast<int>(grains * part / parts) * work.grain);
}

double instructions(std::span<Work const> work, std::vector<LaneRange> const& lanes) {
  double sum = 0;
  for (std::size_t i = 0; i < work.size(); ++i)
    if (lanes[i].count > 0) sum += work[i].instructions / work[i].width * lanes[i].count;
  return sum;
}

/// Calls use(at, bytes) for what lies together of the results of some lanes, in one order.
template <class Use>
void for_results(std::span<Work const> work, std::vector<LaneRange> const& lanes, Use const& use) {
  for (std::size_t i = 0; i < work.size(); ++i)
    for (WrittenLanes const& each : work[i].written)
      for (std::size_t r = 0; r < each.rows; ++r) {
        std::byte* const first = each.data + r * each.row_step + static_cast<std::size_t>(lanes[i].first) * each.lane_step;
        auto const count = static_cast<std::size_t>(lanes[i].count);
        if (each.lane_step == each.size)
          use(first, count * each.size);
        else
          for (std::size_t w = 0; w < count; ++w) use(first + w * each.lane_step, each.size);
      }
}

/// What ranks must agree in to understand each other.
std::uint64_t digest(std::span<Work const> work) {
  std::uint64_t sum = work.size();
  auto const add = [&](std::uint64_t number) { sum = 31 * sum + number; };
  for (Work const& each : work) {
    add(static_cast<std::uint64_t>(each.width));
    add(std::bit_cast<std::uint64_t>(each.instructions));
    for (WrittenLanes const& part : each.written) add(part.rows * part.size);
  }
  return sum;
}

double bytes_of(std::span<Work const> work) {
  double sum = 0;
  for (Work const& each : work)
    for (WrittenLanes const& part : each.written) sum += static_cast<double>(part.rows * part.size) * each.width;
  return sum;
}

bool worth(std::span<Work const> work, int ranks) {
  double all = 0, most = 0;
  for (Work const& each : work) {
    if (each.width > 0 && each.written.empty()) return false;
    all += each.instructions;
  }
  // So little is decided without looking at who would do what.
  if (!ranks::perhaps_worth(all * instruction)) return false;
  for (int r = 0; r < ranks; ++r) most = std::max(most, instructions(work, lanes_of_rank(work, r, ranks)));
  return ranks::worth((all - most) * instruction / ranks::threads(), bytes_of(work));
}

}  // namespace

std::vector<LaneRange> lanes_of_rank(std::span<Work const> work, int rank, int ranks) {
  std::vector<LaneRange> lanes;
  std::int64_t before = 0;  // grains
  for (Work const& each : work) {
    // Parts are dealt out from where the last piece has ended.
    int const part = static_cast<int>(((rank - before) % ranks + ranks) % ranks);
    int const first = boundary(each, part, ranks);
    lanes.push_back({first, boundary(each, part + 1, ranks) - first});
    before += in_grains(each.width, each.grain);
  }
  return lanes;
}

bool do_share(std::span<Work const> work, ThreadPool* pool) {
  if (!ranks::together()) return false;
  int const ranks = ranks::size();
  if (!worth(work, ranks)) return false;
  std::vector<LaneRange> const mine = lanes_of_rank(work, ranks::rank(), ranks);
  std::string results;
  {
    ranks::Own const own;
    std::vector<Blocks> pieces;
    for (std::size_t i = 0; i < work.size(); ++i)
      if (mine[i].count > 0) pieces.push_back(work[i].blocks(mine[i].first, mine[i].count));
    do_blocks(pieces, pool);
  }
  for_results(work, mine, [&](std::byte* at, std::size_t bytes) { results.append(reinterpret_cast<char const*>(at), bytes); });
  std::vector<std::string> const all = ranks::gather_about(digest(work), results);
  for (int r = 0; r < ranks; ++r) {
    if (r == ranks::rank()) continue;
    std::string const& theirs = all[static_cast<std::size_t>(r)];
    std::size_t from = 0;
    std::vector<LaneRange> const lanes = lanes_of_rank(work, r, ranks);
    for_results(work, lanes, [&](std::byte*, std::size_t bytes) { from += bytes; });
    if (from != theirs.size()) throw ranks::Parted{70};  // it has done other work
    from = 0;
    for_results(work, lanes, [&](std::byte* at, std::size_t bytes) {
      std::memcpy(at, theirs.data() + from, bytes);
      from += bytes;
    });
  }
  return true;
}

}  // namespace sysid
