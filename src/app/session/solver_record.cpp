// Settings by name, in the order of the solver's table.
#include "app/session/solver_record.hpp"

#include <nlohmann/json.hpp>

namespace sysid {
namespace {

/// As of any value that is not what it should be, so that whoever reads the file says that it is damaged.
nlohmann::json::other_error no_solver(nlohmann::json const& settings) {
  return nlohmann::json::other_error::create(501, "not the settings of a solver", &settings);
}

}  // namespace

void add_solver(SolverSettings const& solver, Facts& facts) {
  facts.emplace_back("solver", solver.method);
  Settings const values = solver.settings();
  for (SettingRow const& row : solver.row().settings)
    if (auto const value = values.all().find(std::string(row.name)); value != values.all().end())
      facts.emplace_back(std::string(row.name), value->second);
}

SolverSettings read_solver(nlohmann::json const& settings) {
  SolverSettings solver;
  SolverRow const* row = find_solver(settings.value("solver", solver.method));
  if (row == nullptr) throw no_solver(settings);
  Settings values(row->settings);
  for (SettingRow const& each : row->settings) {
    std::string const name(each.name);
    if (!settings.contains(name)) continue;
    if (each.kind == SettingKind::flag)
      values.set(name, settings.at(name).get<bool>());
    else if (each.kind == SettingKind::integer)
      values.set(name, settings.at(name).get<std::int64_t>());
    else
      values.set(name, settings.at(name).get<double>());
  }
  solver = make_solver(*row, values);
  if (solver.substeps < 1 || solver.steps < 1 || !(solver.relative > 0) || !(solver.absolute >= 0)) throw no_solver(settings);
  return solver;
}

nlohmann::json write_solver(SolverSettings const& solver) {
  Facts facts;
  add_solver(solver, facts);
  nlohmann::json result;
  for (auto const& [name, value] : facts) std::visit([&, key = name](auto const& v) { result[key] = v; }, value);
  return result;
}

}  // namespace sysid
