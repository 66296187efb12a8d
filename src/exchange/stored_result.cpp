// summary.json has the user's names and units, the CSV beside it the numbers.
#include "exchange/stored_result.hpp"

#include <fmt/format.h>

#include "app/session/stored_draws.hpp"
#include "exchange/refused.hpp"
#include "report/file/stored_files.hpp"

namespace sysid {
StoredResult read_stored_result(std::filesystem::path const& folder) {
  StoredResult stored{folder, nlohmann::ordered_json::parse(read_whole_summary(folder))};
  return stored;
}

Draws stored_draws(StoredResult const& stored) {
  std::vector<std::string> names, units;
  for (auto const& [name, summary] : stored.summary["parameters"].items()) {
    names.push_back(name);
    units.push_back(summary.is_object() ? summary.value("unit", std::string()) : std::string());
  }
  Draws draws = read_fitted(stored.folder, names).draws;
  draws.units = units;
  std::size_t const length = draws.chains.empty() ? 0 : draws.chains.front().values.size();
  for (Chain const& chain : draws.chains)
    if (chain.values.size() != length)
      throw refused(fmt::format("the chains in `{}` have different lengths", stored.folder.string()),
                    "a file is truncated: run the fit again with --force");
  if (length == 0)
    throw refused(fmt::format("there are no draws in `{}`", stored.folder.string()), "run the fit again with --force");
  return draws;
}

}  // namespace sysid
