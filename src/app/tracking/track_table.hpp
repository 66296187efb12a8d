// track.csv: a line for every row, complete whenever it is looked at.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "app/tracking/tracked_fit.hpp"
#include "result/report.hpp"

namespace sysid {

/// Scales of what a tracker reports: one of the declared unit in SI, per state, tracked parameter and channel.
struct TrackedUnits {
  std::vector<std::string> names, units;  // states, then tracked parameters
  std::vector<double> scales;
  std::vector<std::string> channels, channel_units;
  std::vector<double> channel_scales;
};
TrackedUnits units_of(Model const& model, std::vector<TrackedParameter> const& tracked);

class TrackTable {
 public:
  /// head: the comment lines. follows: each row is written at once and in one piece into track.csv itself, and an earlier result
  /// goes before the first; else rows are gathered in track.csv.partial, which becomes track.csv with the other files of the
  /// result.
  TrackTable(std::filesystem::path const& folder, TrackedUnits const& units, std::string const& head, bool follows);
  ~TrackTable();
  TrackTable(TrackTable const&) = delete;

  void add(TrackedRow const& row);
  /// All rows are there.
  void finish();
  /// The files that stand ready for the result, or have their names already, which whoever asks takes over.
  std::vector<std::string> taken_over();

 private:
  void open();
  void flush();
  void fail() const;

  TrackedUnits const& units_;
  std::filesystem::path path_, written_;
  bool follows_, kept_ = false;
  int file_ = -1;
  std::string lines_;
};

}  // namespace sysid
