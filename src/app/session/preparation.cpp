// Stores preparations as JSON that is restored bit for bit.
#include "app/session/preparation.hpp"

#include <nlohmann/json.hpp>

#include "app/session/solver_record.hpp"
#include "inference/backend/checkpoint.hpp"

namespace sysid {

nlohmann::json store(Preparation const& preparation) {
  nlohmann::json modes = nlohmann::json::array();
  for (Mode const& mode : preparation.modes) modes.push_back(checkpoint::encode(mode));
  return {{"solver", write_solver(preparation.solver)},
          {"modes", modes},
          {"findings", checkpoint::encode(preparation.findings)},
          {"ledger", checkpoint::encode(preparation.ledger)},
          {"moves", preparation.moves}};
}

Preparation restore_preparation(nlohmann::json const& stored) {
  Preparation preparation;
  preparation.solver = read_solver(stored.at("solver"));
  for (auto const& mode : stored.at("modes")) preparation.modes.push_back(checkpoint::decode_mode(mode));
  preparation.findings = checkpoint::decode_findings(stored.at("findings"));
  preparation.ledger = checkpoint::decode_ledger(stored.at("ledger"));
  preparation.moves = stored.at("moves").get<std::vector<double>>();
  return preparation;
}

}  // namespace sysid
