// Stores preparations as JSON that is restored bit for bit.
#include "app/session/preparation.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/session/solver_record.hpp"
#include "inference/backend/checkpoint.hpp"

namespace sysid {

nlohmann::json store(Preparation const& preparation) {
  nlohmann::json modes = nlohmann::json::array();
  for (Mode const& mode : preparation.modes) modes.push_back(checkpoint::encode(mode));
  std::vector<double> standardised;
  for (MemberCoordinate const& each : preparation.standardised)
    standardised.insert(standardised.end(), {static_cast<double>(each.coordinate), each.precision, each.pull});
  std::vector<double> references;
  for (ImproperReference const& each : preparation.references)
    references.insert(references.end(), {static_cast<double>(each.coordinate), each.centre, each.width});
  nlohmann::json stored = {{"solver", write_solver(preparation.solver)},
                           {"modes", modes},
                           {"findings", checkpoint::encode(preparation.findings)},
                           {"ledger", checkpoint::encode(preparation.ledger)},
                           {"standardised", checkpoint::encode(std::span<double const>(standardised))},
                           {"moves", preparation.moves},
                           {"searched_again", preparation.searched_again}};
  if (!references.empty()) stored["references"] = checkpoint::encode(std::span<double const>(references));
  return stored;
}

Preparation restore_preparation(nlohmann::json const& stored) {
  Preparation preparation;
  preparation.solver = read_solver(stored.at("solver"));
  for (auto const& mode : stored.at("modes")) preparation.modes.push_back(checkpoint::decode_mode(mode));
  preparation.findings = checkpoint::decode_findings(stored.at("findings"));
  preparation.ledger = checkpoint::decode_ledger(stored.at("ledger"));
  std::vector<double> const standardised = checkpoint::decode(stored.at("standardised"));
  for (std::size_t i = 0; i < standardised.size(); i += 3)
    if (standardised.size() % 3 != 0 || !(standardised[i] >= 0 && standardised[i] <= 1e9))
      throw checkpoint::Mismatch("its hierarchies differ");
  for (std::size_t i = 0; i + 2 < standardised.size(); i += 3)
    preparation.standardised.push_back({static_cast<int>(standardised[i]), standardised[i + 1], standardised[i + 2]});
  std::vector<double> const references =
      stored.contains("references") ? checkpoint::decode(stored.at("references")) : std::vector<double>();
  if (references.size() % 3 != 0) throw checkpoint::Mismatch("its improper priors differ");
  for (std::size_t i = 0; i < references.size(); i += 3) {
    if (!(references[i] >= 0 && references[i] <= 1e9) || !std::isfinite(references[i + 1]) || !(references[i + 2] > 0))
      throw checkpoint::Mismatch("its improper priors differ");
    preparation.references.push_back(
        {ImproperReference::Kind::normal, static_cast<int>(references[i]), references[i + 1], references[i + 2]});
  }
  preparation.moves = stored.at("moves").get<std::vector<double>>();
  preparation.searched_again = stored.at("searched_again").get<int>();
  if (preparation.searched_again < 0) throw checkpoint::Mismatch("it has searched a negative number of times");
  return preparation;
}

}  // namespace sysid
