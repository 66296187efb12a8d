// The data of a Stan program: what its equations read of the record at every sample and every stage of every step.
#pragma once
#include <nlohmann/json.hpp>

#include "exchange/stan_columns.hpp"
#include "exchange/stan_fit.hpp"

namespace sysid {

/// What the data of an experiment are called in the program.
struct StanDataNames {
  std::string samples, measured, scored, stages, h, count;
};

struct StanData {
  std::string block;  // `data`
  nlohmann::ordered_json values;
  std::vector<StanDataNames> names;  // per experiment
};

/// columns: what the functions read. taken: names that are in use; gets those of the data.
StanData stan_data(StanFit const& fit, StanColumns const& columns, std::vector<std::string>& taken);

}  // namespace sysid
