// The user's file with disturbances in the model of one fit: its text as it is, comments too, but for what has to change.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "app/disturbed/disturbed_equations.hpp"

namespace sysid {

/// What a disturbance is as a number: of the equation with the same place in a list of them.
struct DisturbanceSize {
  std::string unit;  // of the equation, without brackets; empty: not known
  double size = 0;   // in that unit: rms of the equation's inertia along the fit
  double step = 0;   // [s] between samples
};

/// "posterior_with_disturbance".
std::string changed_name(std::string const& task);

/// The file with the quantities `probe()` of the equations derived, and otherwise as it is.
std::string text_with_probes(Source const& source, std::vector<DisturbedEquation> const& equations);

/// The declarations of a disturbance and the equation with it in its place.
std::string text_with_disturbance(DisturbedEquation const& equation, DisturbanceSize const& size, std::string const& indent);

/// The file with the disturbances, the fit under its changed name and the predictions that it alone is behind; without all other
/// tasks. Data are read from where they are: paths start at `results`, where the text is to lie.
std::string text_with_disturbances(Source const& source, Task const& fit, std::vector<DisturbedEquation> const& equations,
                                   std::vector<DisturbanceSize> const& sizes, std::filesystem::path const& results);

/// One model of the file with its disturbances, under another name.
std::string model_with_disturbances(Source const& source, std::string const& model, std::string const& name,
                                    std::vector<DisturbedEquation> const& equations, std::vector<DisturbanceSize> const& sizes);

}  // namespace sysid
