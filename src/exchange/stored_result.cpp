// summary.json has the user's names and units, the CSV beside it the numbers.
#include "exchange/stored_result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "app/session/stored_draws.hpp"
#include "exchange/refused.hpp"
#include "report/file/stored_files.hpp"

namespace sysid {
namespace {

using json = nlohmann::ordered_json;

/// Members by the user's names. Whatever is none becomes the damage that its reader reports.
json const& named_members(json const& of, char const* name) {
  static json const none = json::object();
  auto const place = of.find(name);
  json const& members = place == of.end() ? none : *place;
  if (!members.is_object()) throw std::out_of_range(name);
  for (auto const& [key, value] : members.items()) {
    bool const readable =
        !key.empty() && std::none_of(key.begin(), key.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; });
    if (!readable || !value.is_object()) throw std::out_of_range(key);
  }
  return members;
}

/// Of a task: it becomes the name of a file.
void require_name(std::string const& task) {
  if (task.find_first_of(std::string_view("/\0", 2)) != task.npos || task.starts_with('.')) throw std::out_of_range(task);
}

}  // namespace

StoredResult read_stored_result(std::filesystem::path const& folder) {
  StoredResult stored{folder, json::parse(read_whole_summary(folder))};
  interpreted(folder / "summary.json", [&] {
    require_name(stored.task());
    (void)stored.what(), (void)stored.is(""), (void)stored.seed();
    (void)stored.summary.at("versions").value("sysid", std::string());
    (void)stored.summary.value("model", std::string());
    for (json const& each : named_members(stored.summary, "parameters")) (void)each.value("unit", std::string());
    for (json const& model : named_members(stored.summary, "models")) {
      (void)model.value("probability", 0.0);
      for (char const* const name : {"parameters", "polished"})
        for (json const& each : named_members(model, name)) (void)each.value("unit", std::string());
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
