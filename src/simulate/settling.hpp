// Sums of a filter whose covariance settles: the whole program until it has, then the one in which only means move.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "program/settled.hpp"
#include "simulate/block.hpp"
#include "simulate/simulator.hpp"

namespace sysid {

/// A part of a record that pays, and every how many samples lanes are looked at. Samples at which a lane may change programs are
/// the same ones for any width, so that lanes know nothing of one another.
constexpr int least_settling_samples = 128, settling_interval = 32;

/// What simulates the settled part; null where the program or the record has none.
std::shared_ptr<Simulator const> settled_simulator(SimulationProgram const& program, Schedule const& schedule,
                                                   ExecutionOptions const& options);

/// The sums of one block of lanes up to the last sample that is summed.
class SettlingLanes {
 public:
  SettlingLanes(Simulator const& whole, Simulator const& settled, Block& block, Lanes out, std::span<Outcome> outcome);
  void run(ConstLanes parameters);

 private:
  void run_whole();
  void look(int sample);
  bool has_settled(int lane) const;
  void take(int lane, int sample);
  void run_settled(int first, int lanes, Executor executor);
  void leave(int lane, bool ok, int sample);
  int lanes() const { return out_.width(); }

  Simulator const& whole_;
  Simulator const& settled_;
  SettledProgram const& program_;
  Block& block_;
  Lanes out_;
  std::span<Outcome> outcome_;
  ConstLanes parameters_;
  int begin_, end_;
  LaneArray before_, at_;   // [states x lanes] at the look before; of a settled lane where it settled
  std::vector<int> since_;  // the sample from which on a lane has settled; -1: it has not
};

}  // namespace sysid
