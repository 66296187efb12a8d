// What is to be expected of a model before any sampling: what draws of its prior predict with the actual input, what the data could
// tell of its parameters there, and which solver that needs.
#include <fmt/format.h>

#include <algorithm>

#include "app/preflight/check_file.hpp"
#include "app/preflight/check_process.hpp"
#include "app/preflight/preflight.hpp"
#include "core/text/words.hpp"
#include "likelihood/first_rows.hpp"

namespace sysid {
namespace {

std::string measured_channels(Preflight const& preflight) {
  std::vector<std::string> names;
  for (std::size_t c = 0; c < preflight.model().channels.size(); ++c)
    if (std::any_of(preflight.experiments.begin(), preflight.experiments.end(),
                    [&](Experiment const& each) { return !each.measured[c].empty(); }))
      names.push_back(preflight.model().channels[c].name);
  return listed(names);
}

// Why slopes cannot be taken; empty when they can.
std::string obstacle(Preflight const& preflight, PriorDraws const& prior, std::vector<int> const& sized) {
  if (preflight.output().places().empty()) return "no row that was examined has a sample that can be predicted";
  auto const responds = [](AssessedParameter const& each) { return each.role == ParameterRole::response; };
  if (std::none_of(prior.coordinates.begin(), prior.coordinates.end(), responds)) return "no sampled parameter enters the response";
  if (sized.size() < 2) return "fewer than two prior draws predict a response of the measured size";
  if (preflight.effort.examined == 0)
    return fmt::format("derivatives with respect to {} parameters would take too long for a model of this size",
                       prior.coordinates.size());
  return {};
}

}  // namespace

Findings check_prior_size(Session& session, FitTask const& what, std::vector<ExperimentData> const& data) {
  Model const& written = session.file.models[static_cast<std::size_t>(what.model)];
  if (written.improper() != nullptr) return {};
  PreflightPage page;
  if (!written.processes.empty()) {
    preflight_processes(session, what, data, page);
  } else {
    Preflight const preflight(session, what, data, page);
    PriorDraws const prior = draw_prior(preflight);
    describe_prior(preflight, prior);
    check_initial(preflight, prior);
  }
  std::erase_if(page.findings, [](Finding const& each) {
    return each.code != FindingCode::prior_far_from_data && each.code != FindingCode::prior_at_rest &&
           each.code != FindingCode::initial_far_off;
  });
  return page.findings;
}

void run_preflight(Session& session, FitTask const& what, std::vector<ExperimentData> const& data, PreflightPage& page) {
  Model const& written = session.file.models[static_cast<std::size_t>(what.model)];
  if (Parameter const* parameter = written.improper()) {
    page.not_examined =
        fmt::format("the prior-based checks: the prior of `{}` is improper ({})", parameter->name, parameter->prior->row->name);
    return;
  }
  if (!written.processes.empty()) {
    preflight_processes(session, what, data, page);
    page.not_examined = "identifiability: the model has a Gaussian process";
    return;
  }
  Preflight const preflight(session, what, data, page);
  std::string const skipped_words = preflight.model().integrated() ? "identifiability and the solver: " : "identifiability: ";
  PriorDraws const prior = draw_prior(preflight);
  std::vector<int> const sized = describe_prior(preflight, prior);
  check_initial(preflight, prior);
  Findings const method = check_method(session, what);
  page.findings.insert(page.findings.end(), method.begin(), method.end());
  describe_disturbances(preflight, prior, sized);
  if (std::string const why = obstacle(preflight, prior, sized); !why.empty()) {
    page.not_examined = skipped_words + why;
    return;
  }
  std::vector<LocalResponse> const responses = local_responses(preflight, prior, sized);
  if (responses.size() < 2) {
    page.not_examined = skipped_words + "the response is not smooth in the parameters at the prior draws that were examined";
    return;
  }
  page.information.emplace();
  page.information->draws = static_cast<int>(responses.size());
  page.information->noise = prior.noise;
  if (preflight.shortened) page.information->rows = most_scored_rows(preflight.experiments);
  std::vector<LocalSlopes> locals;
  for (LocalResponse const& each : responses) locals.push_back(each.slopes);
  describe_information(prior.coordinates, locals, measured_channels(preflight), !preflight.model().inputs.empty(), page);
  describe_solvers(preflight, prior, responses);
}

}  // namespace sysid
