// What is to be expected of a model before any sampling: what draws of its prior predict with the actual input, what the data could
// tell of its parameters there, and which solver that needs.
#include <fmt/format.h>

#include <algorithm>

#include "app/preflight/check_file.hpp"
#include "app/preflight/check_process.hpp"
#include "app/preflight/preflight.hpp"
#include "core/text/words.hpp"

namespace sysid {
namespace {

std::string measured_channels(LookedAt const& look) {
  std::vector<std::string> names;
  for (std::size_t c = 0; c < look.model().channels.size(); ++c)
    if (std::any_of(look.experiments.begin(), look.experiments.end(),
                    [&](Experiment const& each) { return !each.measured[c].empty(); }))
      names.push_back(look.model().channels[c].name);
  return listed(names);
}

// Why slopes cannot be taken; empty when they can.
std::string obstacle(LookedAt const& look, PriorDraws const& prior, std::vector<int> const& sized) {
  auto const responds = [](JudgedParameter const& each) { return each.role == ParameterRole::response; };
  if (std::none_of(prior.coordinates.begin(), prior.coordinates.end(), responds)) return "no sampled parameter enters the response";
  if (sized.size() < 2) return "fewer than two prior draws predict a response of the measured size";
  if (look.effort.looked_at == 0)
    return fmt::format("derivatives with respect to {} parameters would take too long for a model of this size",
                       prior.coordinates.size());
  return {};
}

Parameter const* improper(Model const& model) {
  auto const found = std::find_if(model.parameters.begin(), model.parameters.end(),
                                  [](Parameter const& each) { return each.prior && !each.prior->row->proper; });
  return found == model.parameters.end() ? nullptr : &*found;
}

}  // namespace

Findings check_prior_size(Session& session, FitTask const& what, std::vector<ExperimentData> const& data) {
  Model const& written = session.file.models[static_cast<std::size_t>(what.model)];
  if (improper(written) != nullptr) return {};
  Outlook page;
  if (!written.processes.empty()) {
    look_at_processes(session, what, data, page);
  } else {
    LookedAt const look(session, what, data, page);
    describe_prior(look, draw_prior(look));
  }
  std::erase_if(page.findings, [](Finding const& each) { return each.code != FindingCode::prior_far_from_data; });
  return page.findings;
}

void look_ahead(Session& session, FitTask const& what, std::vector<ExperimentData> const& data, Outlook& page) {
  Model const& written = session.file.models[static_cast<std::size_t>(what.model)];
  if (Parameter const* parameter = improper(written)) {
    page.left_out =
        fmt::format("the prior-based checks: the prior of `{}` is improper ({})", parameter->name, parameter->prior->row->name);
    return;
  }
  if (!written.processes.empty()) {
    look_at_processes(session, what, data, page);
    page.left_out = "identifiability: the model has a Gaussian process";
    return;
  }
  LookedAt const look(session, what, data, page);
  std::string const unlooked = look.model().integrated() ? "identifiability and the solver: " : "identifiability: ";
  PriorDraws const prior = draw_prior(look);
  std::vector<int> const sized = describe_prior(look, prior);
  if (std::string const why = obstacle(look, prior, sized); !why.empty()) {
    page.left_out = unlooked + why;
    return;
  }
  std::vector<LocalResponse> const responses = local_responses(look, prior, sized);
  if (responses.size() < 2) {
    page.left_out = unlooked + "the response is not smooth in the parameters at the prior draws that were examined";
    return;
  }
  page.information.emplace();
  page.information->draws = static_cast<int>(responses.size());
  page.information->noise = prior.noise;
  if (look.shortened) page.information->rows = static_cast<int>(LookedAt::most_scored);
  std::vector<LocalSlopes> locals;
  for (LocalResponse const& each : responses) locals.push_back(each.slopes);
  describe_information(prior.coordinates, locals, measured_channels(look), page);
  describe_solvers(look, prior, responses);
}

}  // namespace sysid
