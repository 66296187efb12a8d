// summary.json has the user's names and units, the CSV beside it the numbers.
#include "exchange/stored_result.hpp"

#include <fmt/format.h>

#include "app/session/results.hpp"
#include "app/session/stored_draws.hpp"
#include "core/system/files.hpp"
#include "exchange/refused.hpp"

namespace sysid {
StoredResult read_stored_result(std::filesystem::path const& folder) {
  StoredResult stored{folder, nlohmann::ordered_json::parse(read_file(folder / "summary.json"), nullptr, false)};
  auto const text = [&](char const* key) { return stored.summary.contains(key) && stored.summary[key].is_string(); };
  auto const object = [&](char const* key) { return stored.summary.contains(key) && stored.summary[key].is_object(); };
  bool const whole = stored.summary.is_object() && text("task") && text("what") && text("model") && object("versions") &&
                     object("parameters") && stored.summary.contains("seed") && stored.summary["seed"].is_number_unsigned();
  if (!whole)
    throw refused(fmt::format("`{}` is not the result of a task", (folder / "summary.json").string()),
                  "run the task again with --force");
  if (!has_deciding_fields(stored.summary)) throw older_version(folder);
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
