// The blocks of the program, one after the other.
#include "exchange/stan_program.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "exchange/stan_data.hpp"
#include "exchange/stan_functions.hpp"
#include "exchange/stan_names.hpp"
#include "exchange/stan_text.hpp"

namespace sysid {
namespace {

std::string head(Session const& session, StanFit const& fit) {
  return fmt::format(
      "// {0}: {1} fitted to {2}\n// Written by sysid {3}. Equations are in SI units.\n"
      "// Without Stan's adjustment for transforms, target is log_prior__ + log_likelihood__ as in the files of draws:\n"
      "// the log density, with all constants, of the parameters in their declared units.\n",
      fit.task.name, fit.model().name, data_names(session.file, fit.what.experiments), SYSID_VERSION);
}

std::string bounds(ParameterInfo const& info) {
  std::vector<std::string> bounds;
  if (std::isfinite(info.lower)) bounds.push_back("lower=" + stan_real(info.lower));
  if (std::isfinite(info.upper)) bounds.push_back("upper=" + stan_real(info.upper));
  return bounds.empty() ? "" : fmt::format("<{}>", fmt::join(bounds, ", "));
}

/// The blocks `parameters`, under the user's names where Stan takes them, and `transformed parameters`: all in SI.
std::string parameters_blocks(StanFit const& fit, std::vector<std::string>& taken) {
  std::string text = "parameters {\n";
  std::string si = fmt::format("transformed parameters {{\n  vector[{}] si;\n", fit.space->rows().size());
  std::size_t next = 0;
  for (std::size_t r = 0; r < fit.space->rows().size(); ++r) {
    FittedParameter const& row = fit.space->rows()[r];
    if (row.value) {
      si += fmt::format("  si[{}] = {};  // {}\n", r + 1, stan_real(*row.value), row.name);
      continue;
    }
    std::string const name = stan_identifier(row.name, taken);
    auto const prior =
        std::find_if(fit.priors.begin(), fit.priors.end(), [&](PriorInfo const& each) { return each.name == row.name; });
    text += fmt::format("  real{} {};  // {}{}{}\n", bounds(fit.space->infos()[next++]), name, row.name,
                        row.unit ? " [" + row.unit_text() + "]" : "", prior == fit.priors.end() ? "" : " ~ " + prior->text);
    std::string const scale = row.unit && row.unit->scale != 1 ? " * " + stan_real(row.unit->scale) : "";
    si += fmt::format("  si[{}] = {}{};\n", r + 1, name, scale);
  }
  return text + "}\n" + si + "}\n";
}

std::string model_block(StanFit const& fit, std::vector<StanDataNames> const& all) {
  std::string text = "model {\n  target += log_prior(si);\n";
  std::size_t const parameters = fit.model().parameters.size();
  for (std::size_t e = 0; e < all.size(); ++e) {
    StanDataNames const& names = all[e];
    text += fmt::format("  {{\n    vector[{}] p;\n", std::max<std::size_t>(1, parameters));
    for (std::size_t p = 0; p < parameters; ++p)
      text += fmt::format("    p[{}] = si[{}];\n", p + 1, fit.space->row(static_cast<int>(e), static_cast<int>(p)) + 1);
    text += fmt::format("    target += log_likelihood({}, {}, {}, {}p);\n  }}\n", names.samples, names.measured, names.scored,
                        fit.steps() ? fmt::format("{}, {}, {}", names.stages, names.h, fit.exact() ? "" : "substeps, ") : "");
  }
  return text + "}\n";
}

}  // namespace

StanProgram stan_program(Session& session, Task const& task, SolverSettings const& solver) {
  StanFit const fit = stan_fit(session, task, solver);
  StanColumns columns;
  std::vector<std::string> taken = stan_function_names(fit);
  std::string const functions = stan_functions_block(fit, columns);
  StanData const data = stan_data(fit, columns, taken);
  std::string const parameters = parameters_blocks(fit, taken);
  return {head(session, fit) + functions + data.block + parameters + model_block(fit, data.names), data.values.dump() + "\n"};
}

}  // namespace sysid
