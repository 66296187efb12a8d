// One row for each option; the verbs share most of them. Those of `select` alone are in select_options.cpp.
#include "check/task/task_options.hpp"

#include <algorithm>
#include <map>

#include "check/task/select_options.hpp"
#include "core/setting/table.hpp"
#include "syntax/words.hpp"

namespace sysid {
namespace {

constexpr TaskOptionRow rows[] = {
    {"start", "start = estimated(rows = 50)", "how a simulation starts: at which row, and in which state", "record rest estimated"},
    {"solver", "solver = cvode(relative = 1e-8)", "integration method of the equations", {}},
    {"substeps", "substeps = 2", "steps of rk4 between two samples; if not given, the fit chooses it", "automatic"},
    {"prediction", "prediction = free_run",
     "for a model in discrete time or with random states: which past samples a prediction uses", "as_written one_step free_run"},
    {"filter", "filter = unscented", "how the likelihood is computed where states are random: disturbances, random initial values",
     "auto kalman extended unscented particle"},
    {"particles", "particles = 1000", "particles of `filter = particle`; if not given, the fit chooses how many", "automatic"},
    {"search", "search = near(posterior)",
     "where the search for modes starts: at draws of the prior, or where an earlier fit ended", "everywhere near"},
    {"evidence", "evidence = bridge", "how the evidence of the model is computed", "auto importance bridge smc laplace none"},
    {"seed", "seed = 1", "seed of all random numbers; if not given, one is drawn and printed", {}},
    {"noise", "noise = 1 [percent]",
     "noise of the simulated channels: a percentage of each channel's standard deviation without noise, or `model`: the noise that "
     "the model declares",
     "model"},
    {"values", "values(m = 1, k = 1e4)", "values of parameters with a prior, in their declared units", {}},
    {"input", "input x = gaussian(sd = 10)", "the signal of an input", {}},
    {"samples", "samples = 500", "number of rows", {}},
    {"rate", "rate = 1000 [Hz]", "rows per second; a bare number is in Hz", {}},
    {"step", "step = 1 [ms]", "time between two rows; a bare number is in s", {}},
    {"file", "file = \"made.csv\"", "name of the CSV file in the result folder", {}},
    {"draws", "draws(200)", "number of posterior draws that are simulated", {}},
    {"redraw", "redraw = step", "parameters redrawn for each trajectory or at each step", "trajectory step"},
    {"weights", "weights = stacking", "how the weights of the fits in an averaged prediction are computed",
     "evidence stacking pseudo_bma equal"},
    {"top", "top = 5", "number of structures that are shown and refitted", {}},
    {"candidates", "candidates = yes", "whether found.sysid contains a model for each structure, as a set of candidates", "yes no"},
    {"refit", "refit = yes", "whether the best structures are refitted by simulation", "yes no"},
};
constexpr TaskOptionRow noise_of_discovery = {
    "noise", "noise(displacement = 0.1 [mm])", "standard deviation of the noise of a channel, if it is known", {}};

using Names = std::vector<std::string_view>;
std::map<TaskKind, Names> const& by_kind() {
  static std::map<TaskKind, Names> const all = {
      {TaskKind::simulate, {"values", "input", "noise", "samples", "rate", "step", "solver", "substeps", "seed", "file"}},
      {TaskKind::fit, {"start", "solver", "substeps", "prediction", "filter", "particles", "search", "evidence", "seed"}},
      {TaskKind::select, {"start", "solver", "substeps", "prediction", "filter", "seed"}},
      {TaskKind::discover, {"noise", "top", "candidates", "refit", "seed"}},
      {TaskKind::predict, {"draws", "weights", "redraw", "start", "prediction", "seed"}}};
  return all;
}

}  // namespace

std::vector<TaskOptionRow> task_options(std::string_view verb) {
  std::vector<TaskOptionRow> all;
  auto const kind = words::task_kind(verb);
  if (!kind) return all;
  if (kind == TaskKind::select)
    for (SelectOptionRow const& own : select_options()) all.push_back(own.option);
  for (std::string_view const name : by_kind().at(*kind))
    all.push_back(kind == TaskKind::discover && name == "noise" ? noise_of_discovery : *row_named(rows, name));
  return all;
}

std::vector<std::string> task_option_names(std::string_view verb) {
  std::vector<std::string> names;
  for (TaskOptionRow const& row : task_options(verb)) names.emplace_back(row.name);
  return names;
}

std::vector<std::string> verbs_with_option(std::string_view option) {
  std::vector<std::string> found;
  for (std::string_view const verb : words::verbs) {
    std::vector<TaskOptionRow> const all = task_options(verb);
    if (std::any_of(all.begin(), all.end(), [&](TaskOptionRow const& each) { return each.name == option; }))
      found.emplace_back(verb);
  }
  return found;
}

}  // namespace sysid
