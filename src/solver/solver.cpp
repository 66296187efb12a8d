// The table of solvers, one row each, and their settings: what `finer` and coarser ones are.
#include "solver/solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "core/setting/table.hpp"
#include "core/text/diagnostic.hpp"
#include "core/text/number.hpp"

namespace sysid {

// One file each.
std::vector<NodeId> rk4_step(Stages const& stages);
std::vector<NodeId> heun_step(Stages const& stages);
std::vector<NodeId> euler_step(Stages const& stages);
std::vector<NodeId> exponential_step(Stages const& stages);
EmbeddedMethod const& dopri5();

namespace {

constexpr SettingRow fixed_settings[] = {
    {"substeps", SettingKind::integer, "1", 1, 10000, "",
     "number of equal steps per sampling interval; if not given, a fit chooses it"},
    {"as_model", SettingKind::flag, "no", 0, 0, "",
     "whether the step is part of the model: a fit then keeps it, and the estimates are valid only with it"},
};

constexpr SettingRow adaptive_settings[] = {
    {"relative", SettingKind::real, "1e-8", 1e-13, 0.1, "", "error allowed per step, relative to each state"},
    {"absolute", SettingKind::real, "0", 0, 1e300, "",
     "error allowed per step near zero, in SI units; 0: `relative` times a thousandth of the largest value reached"},
    {"steps", SettingKind::integer, "10000", 1, 1e9, "",
     "maximum number of steps between two samples; a simulation that needs more fails"},
};

// To the digits that a person would write: 1e-5/100 is not the number nearest to 1e-7.
double hundredth(double value) { return leading_number(fmt::format("{:.12e}", value / 100)); }

}  // namespace

std::span<SolverRow const> solvers() {
  static constexpr SolverRow rows[] = {
      {.name = "rk4",
       .summary = "the classical Runge-Kutta method of order 4",
       .settings = fixed_settings,
       .stepping = Stepping::fixed,
       .order = 4,
       .in_program = true,
       .step = &rk4_step},
      {.name = "heun",
       .summary = "Heun's method of order 2 (explicit trapezoidal rule)",
       .settings = fixed_settings,
       .stepping = Stepping::fixed,
       .order = 2,
       .in_program = true,
       .step = &heun_step},
      {.name = "euler",
       .summary = "Euler's explicit method of order 1",
       .settings = fixed_settings,
       .stepping = Stepping::fixed,
       .order = 1,
       .in_program = true,
       .step = &euler_step},
      {.name = "exponential",
       .summary = "the exact step of equations that are linear in their states, by the exponential of their matrix",
       .settings = {},
       .stepping = Stepping::fixed,
       .order = 0,
       .in_program = true,
       .exact = true,
       .step = &exponential_step},
      {.name = "dopri5",
       .summary = "the adaptive method of Dormand and Prince of order 5, with separate steps for each simulation",
       .settings = adaptive_settings,
       .stepping = Stepping::lanes,
       .order = 5,
       .adaptive = true,
       .in_program = true,
       .embedded = &dopri5},
      {.name = "cvode",
       .summary = "backward differentiation formulas (BDF) of order 1 to 5, for stiff equations",
       .settings = adaptive_settings,
       .stepping = Stepping::cvode,
       .order = 0,
       .adaptive = true,
       .stiff = true},
      {.name = "ida",
       .summary = "backward differentiation formulas (BDF) for implicit and differential-algebraic equations",
       .settings = adaptive_settings,
       .stepping = Stepping::ida,
       .order = 0,
       .adaptive = true,
       .stiff = true,
       .implicit = true},
  };
  return rows;
}

SolverRow const* find_solver(std::string_view name) { return row_named(solvers(), name); }

namespace {

template <typename Wanted>
SolverRow const& first_solver(Wanted const& wanted) {
  for (SolverRow const& row : solvers())
    if (wanted(row)) return row;
  throw InternalError("no solver can do what is asked for");
}

}  // namespace

SolverRow const& adaptive_solver() {
  return first_solver([](SolverRow const& row) { return row.adaptive && row.in_program; });
}

SolverRow const& stiff_solver() {
  return first_solver([](SolverRow const& row) { return row.stiff && !row.implicit; });
}

SolverRow const& implicit_solver() {
  return first_solver([](SolverRow const& row) { return row.implicit; });
}

SolverRow const& exact_solver() {
  return first_solver([](SolverRow const& row) { return row.exact; });
}

SolverRow const& SolverSettings::row() const {
  SolverRow const* found = find_solver(method);
  if (found == nullptr) throw InternalError(fmt::format("there is no solver `{}`", method));
  return *found;
}

SolverSettings SolverSettings::finer() const {
  SolverSettings result = *this;
  result.as_model = false;
  if (row().exact) return result;
  if (fixed_step()) {
    result.substeps *= 2;
  } else {
    result.relative = std::max(hundredth(result.relative), 1e-14);  // rounding is not far below
    result.absolute = hundredth(result.absolute);
  }
  return result;
}

bool SolverSettings::within_limits() const {
  Settings const values = settings();
  return std::all_of(row().settings.begin(), row().settings.end(), [&](SettingRow const& each) {
    auto const value = values.all().find(std::string(each.name));
    return value == values.all().end() || refuse(each, value->second).empty();
  });
}

std::string SolverSettings::finer_words() const { return fixed_step() ? "half the step" : "tolerances 100 times smaller"; }

std::string SolverSettings::other_methods() const {
  std::string const stiff = fmt::format("`solver = {}`", stiff_solver().name);
  if (row().stiff) return {};
  if (row().exact) return stiff;
  if (row().adaptive) return stiff + " if the model is stiff";
  return fmt::format("`solver = {}`, or {} if the model is stiff", adaptive_solver().name, stiff);
}

std::string SolverSettings::option() const {
  SolverSettings const usual{.method = method};
  if (method == SolverSettings{}.method && !as_model) return fmt::format("substeps = {}", substeps);
  Settings const values = settings(), defaults = usual.settings();
  std::string arguments;
  for (SettingRow const& each : row().settings) {
    std::string const name(each.name);
    if (!values.all().contains(name)) continue;
    if (!defaults.all().contains(name) || values.all().at(name) != defaults.all().at(name))
      arguments += fmt::format("{}{} = {}", arguments.empty() ? "" : ", ", name, setting_text(values.all().at(name)));
  }
  return fmt::format("solver = {}{}", method, arguments.empty() ? "" : "(" + arguments + ")");
}

Settings SolverSettings::settings() const {
  Settings values;
  auto const set = [&](char const* name, SettingValue value) {
    if (find_setting(row().settings, name) != nullptr) values.set(name, value);
  };
  set("substeps", static_cast<std::int64_t>(substeps));
  set("relative", relative);
  set("absolute", absolute);
  set("steps", static_cast<std::int64_t>(steps));
  if (as_model) set("as_model", true);
  return values;
}

std::string SolverSettings::text() const {
  // In the order of the table.
  Settings const values = settings();
  std::string arguments;
  for (SettingRow const& each : row().settings)
    if (auto const value = values.all().find(std::string(each.name)); value != values.all().end())
      arguments += fmt::format("{}{} = {}", arguments.empty() ? "" : ", ", each.name, setting_text(value->second));
  return arguments.empty() ? method : fmt::format("{}({})", method, arguments);
}

double SolverSettings::near_zero(double reached) const {
  return absolute > 0 ? absolute : relative * std::max(reached, smallest_size) / 1000;
}

SolverSettings make_solver(SolverRow const& row, Settings const& values) {
  SolverSettings result;
  result.method = row.name;
  for (auto const& [name, value] : values.all()) {
    if (name == "substeps")
      result.substeps = static_cast<int>(values.integer(name));
    else if (name == "relative")
      result.relative = values.real(name);
    else if (name == "absolute")
      result.absolute = values.real(name);
    else if (name == "steps")
      result.steps = static_cast<int>(values.integer(name));
    else if (name == "as_model")
      result.as_model = values.flag(name);
    else
      throw InternalError(fmt::format("nothing reads the setting `{}` of a solver", name));
  }
  return result;
}

}  // namespace sysid
