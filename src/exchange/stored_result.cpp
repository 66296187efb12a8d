// summary.json has the user's names and units, the CSV beside it the numbers.
#include "exchange/stored_result.hpp"

#include <fmt/format.h>

#include "app/session/stored_draws.hpp"
#include "exchange/refused.hpp"
#include "report/file/stored_files.hpp"

namespace sysid {
StoredResult read_stored_result(std::filesystem::path const& folder) {
  StoredResult stored{folder, nlohmann::ordered_json::parse(read_whole_summary(folder))};
  interpreted(folder / "summary.json", [&] {
    (void)stored.task(), (void)stored.what(), (void)stored.is(""), (void)stored.seed();
    (void)stored.summary.at("versions").value("sysid", std::string());
    (void)stored.summary.value("model", std::string());
    auto const members = [](nlohmann::ordered_json const& of, char const* name) {
      return of.value(name, nlohmann::ordered_json::object());
    };
    nlohmann::ordered_json const parameters = members(stored.summary, "parameters"), models = members(stored.summary, "models");
    for (auto const& each : parameters)
      if (each.is_object()) (void)each.value("unit", std::string());
    for (auto const& model : models) {
      (void)model.value("probability", 0.0);
      for (char const* const name : {"parameters", "polished"}) {
        nlohmann::ordered_json const summaries = members(model, name);
        for (auto const& each : summaries) (void)each.value("unit", std::string());
      }
    }
    return true;
  });
  return stored;
}

Draws stored_draws(StoredResult const& stored) {
  std::vector<std::string> names, units;
  auto const parameters = stored.summary.value("parameters", nlohmann::ordered_json::object());
  for (auto const& [name, summary] : parameters.items()) {
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
