// The checks of a file in order, each task on its own.
#include "app/preflight/check_file.hpp"

#include <fmt/format.h>

#include "app/session/exact_steps.hpp"
#include "app/session/preconditions.hpp"
#include "app/session/provenance.hpp"
#include "app/session/resolved.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "experiment/experiments.hpp"
#include "model/same_equations.hpp"
#include "syntax/parse.hpp"

namespace sysid {
namespace {

// The data of a task that are there, each described; nothing when some are still to be made.
std::optional<std::vector<ExperimentData>> cover(Session& session, TaskData const& task, TaskPage& page) {
  bool complete = true;
  std::vector<ExperimentUse> there;
  for (ExperimentUse const& use : *task.experiments) {
    DataBlock const& block = session.file.data[static_cast<std::size_t>(use.data)];
    Task const* made = maker(session, block);
    if (made == nullptr || std::filesystem::exists(session.folder() / block.path)) {
      there.push_back(use);
      continue;
    }
    complete = false;
    CoveragePage coverage;
    coverage.name = data_name(block, use.part);
    coverage.file = block.mention();
    coverage.made_by = made->name;
    page.coverage.push_back(std::move(coverage));
  }
  Model const& model = *task.model;
  std::vector<ExperimentData> data = load_experiments(session, there, model, task.start, task.prediction, task.solver);
  for (ExperimentData const& each : data)
    page.coverage.push_back(describe_coverage(each, session.file.data[static_cast<std::size_t>(each.use.data)], task.start, model));
  look_at_all_data(session.file, data, model, page.findings);
  if (!complete) return std::nullopt;
  return data;
}

void check_bands(TaskPage& page) {
  for (CoveragePage const& coverage : page.coverage)
    for (CoveragePage::Input const& input : coverage.inputs)
      if (auto const rule = find_input_rule(input.rule);
          rule && row_of(*rule).band > 0 && input.high > row_of(*rule).band * coverage.rate)
        page.findings.push_back(
            {FindingCode::input_band,
             Severity::warning,
             {input.name, coverage.name},
             fmt::format("{} of {} has power up to {:.3g} Hz, which is {:.2f} times the sampling rate, but `{}` is exact only up "
                         "to {} times this rate",
                         input.name, coverage.name, input.high, input.high / coverage.rate, input.rule, row_of(*rule).band),
             "check whether the input was held between the samples, or sampled without an anti-aliasing filter"});
}

// Where the samples of an input contradict the curve that its rule draws through them. What was held cannot be told from what was
// sampled by the samples alone, so of `zero_order` nothing is said.
void check_rules(TaskPage& page) {
  constexpr double rough = 0.1, much = 0.02;
  for (CoveragePage const& coverage : page.coverage)
    for (CoveragePage::Input const& input : coverage.inputs) {
      if (!coverage.equal) break;
      auto const rule = find_input_rule(input.rule);
      if (!rule || input.constant || (*rule != InputRule::linear && *rule != InputRule::cubic)) continue;
      if (*rule == InputRule::linear && input.cut_by_lines && input.chords > much)
        page.findings.push_back(
            {FindingCode::input_rule,
             Severity::note,
             {input.name, coverage.name, "cubic"},
             fmt::format(
                 "{} of {} is smooth, and linear interpolation (`hold linear`) has an error of {} % of its sd between samples",
                 input.name, coverage.name, significant(100 * input.chords, 2)),
             "write `hold cubic` if the input was sampled from a smooth signal"});
      else if (input.top > rough)
        page.findings.push_back(
            {FindingCode::input_rule,
             Severity::note,
             {input.name, coverage.name, "zero_order"},
             fmt::format("{:.0f} % of the power of {} of {} is above 0.4 times the sampling rate: the samples do not determine how "
                         "the input varies between two samples",
                         100 * input.top, input.name, coverage.name),
             "write `hold zero_order` if a generator held the input between its samples; otherwise record it at a higher sampling "
             "rate"});
    }
}

/// [SI] between which the prior of a parameter of the model has its mass; infinite where it depends on other parameters.
std::pair<double, double> support_of(ParameterSpace const& space, int parameter) {
  for (int k = 0; k < space.dimension(); ++k) {
    FittedParameter const& row = space.rows()[static_cast<std::size_t>(space.sampled()[static_cast<std::size_t>(k)])];
    ParameterInfo const& info = space.infos()[static_cast<std::size_t>(k)];
    if (row.parameter == parameter) return {row.to_si(info.lower), row.to_si(info.upper)};
  }
  return {-infinity, infinity};
}

// Equal equations are two hypotheses where their priors exclude each other, or where nothing but the priors differs; else they are
// one, counted twice.
void compare_candidates(Session const& session, SelectTask const& selection, TaskPage& page) {
  CandidateSet const& set = session.file.candidates[static_cast<std::size_t>(selection.candidates)];
  auto const model = [&](std::size_t k) -> Model const& {
    return session.file.models[static_cast<std::size_t>(selection.fits[k].model)];
  };
  for (std::size_t j = 0; j < selection.fits.size(); ++j)
    for (std::size_t k = j + 1; k < selection.fits.size(); ++k) {
      std::optional<Likeness> const alike = same_equations(model(j), model(k));
      if (!alike || (alike->same_names && !alike->same_priors)) continue;
      auto const first = parameter_space(model(j), selection.fits[j].experiments);
      auto const second = parameter_space(model(k), selection.fits[k].experiments);
      if (std::ranges::any_of(alike->parameters, [&](auto const& pair) {
            auto const [low, high] = support_of(*first, pair.first);
            auto const [other_low, other_high] = support_of(*second, pair.second);
            return high <= other_low || other_high <= low;
          }))
        continue;
      page.findings.push_back(
          {FindingCode::candidates_alike,
           Severity::warning,
           {set.models[j].name, set.models[k].name},
           fmt::format(
               "candidates `{}` and `{}` have the same equations and the same noise: they differ at most in names and priors",
               set.models[j].name, set.models[k].name),
           "correct the equations of one of them, or leave it out: the two share the probability of one model"});
    }
}

// Each candidate as the fit of it would be, unless the selection cannot begin.
void preflight_candidates(Session& session, Task const& task, SelectTask const& selection, TaskPage& page) {
  std::vector<std::vector<ExperimentData>> data;
  for (FitTask const& fit : selection.fits)
    data.push_back(load_experiments(session, fit.experiments, session.file.models[static_cast<std::size_t>(fit.model)], fit.start,
                                    fit.prediction, fit.solver));
  for (std::size_t k = 0; k < data.size(); ++k)
    look_at_all_data(session.file, data[k], session.file.models[static_cast<std::size_t>(selection.fits[k].model)], page.findings);
  if (refusal(task, selection, session.file.models, data)) return;
  CandidateSet const& set = session.file.candidates[static_cast<std::size_t>(selection.candidates)];
  for (std::size_t k = 0; k < selection.fits.size(); ++k) {
    page.preflights.emplace_back().candidate = set.models[k].name;
    FitTask const& fit = selection.fits[k];
    run_preflight(session, with_exact_steps(fit, session.file.models[static_cast<std::size_t>(fit.model)], data[k]).task, data[k],
                  page.preflights.back());
  }
}

// One function for each kind of task: what it is, in a line, and what can be known of it before it runs. data: of a selection and
// its predictions the same for each candidate.
using TaskDataList = std::vector<TaskData>;

void preflight_simulate(Session& session, Task const& task, TaskDataList const&, TaskPage& page) {
  SimulateTask const& what = std::get<SimulateTask>(task.what);
  page.what = fmt::format("simulate {}: {} samples at {:.6g} Hz into {}",
                          session.file.models[static_cast<std::size_t>(what.model)].name, what.samples, 1 / what.step, what.file);
}

void preflight_fit(Session& session, Task const& task, TaskDataList const& data, TaskPage& page) {
  FitTask const& what = std::get<FitTask>(task.what);
  Model const& model = session.file.models[static_cast<std::size_t>(what.model)];
  page.what = fmt::format("fit {} to {} with {}", model.name, data_names(session.file, what.experiments), what.backend);
  auto const experiments = cover(session, data.front(), page);
  check_bands(page);
  check_rules(page);
  if (experiments && !refusal(task, what, model, *experiments))
    run_preflight(session, with_exact_steps(what, model, *experiments).task, *experiments, page.preflights.emplace_back());
}

void preflight_select(Session& session, Task const& task, TaskDataList const& data, TaskPage& page) {
  SelectTask const& what = std::get<SelectTask>(task.what);
  CandidateSet const& set = session.file.candidates[static_cast<std::size_t>(what.candidates)];
  page.what = fmt::format("select {} ({}) to {} with {}", set.name, counted(set.models.size(), "model"),
                          data_names(session.file, what.fits.front().experiments), what.backend);
  auto const experiments = cover(session, data.front(), page);
  check_bands(page);
  check_rules(page);
  compare_candidates(session, what, page);
  if (experiments) preflight_candidates(session, task, what, page);
}

void preflight_discover(Session& session, Task const& task, TaskDataList const& data, TaskPage& page) {
  DiscoverTask const& what = std::get<DiscoverTask>(task.what);
  CheckedDictionary const& dictionary = session.file.dictionaries[static_cast<std::size_t>(what.dictionary)];
  page.what = fmt::format("discover {} from {} with {}", dictionary.name, data_names(session.file, what.experiments),
                          method_text(dictionary, what));
  cover(session, data.front(), page);
  check_bands(page);
  check_rules(page);
}

void preflight_predict(Session& session, Task const& task, TaskDataList const& data, TaskPage& page) {
  PredictTask const& what = std::get<PredictTask>(task.what);
  page.what = fmt::format("predict {} on {}", predicted_names(session.file, what), data_names(session.file, what.experiments));
  cover(session, data.front(), page);
}

struct PreflightRow {
  TaskKind kind;
  void (*preflight)(Session&, Task const&, TaskDataList const&, TaskPage&);
};
constexpr PreflightRow preflight_rows[] = {
    {TaskKind::simulate, &preflight_simulate}, {TaskKind::fit, &preflight_fit},         {TaskKind::select, &preflight_select},
    {TaskKind::discover, &preflight_discover}, {TaskKind::predict, &preflight_predict},
};

static_assert(std::size(preflight_rows) == task_kind_count);

TaskPage check_task(Session& session, Task const& task) {
  TaskPage page;
  page.name = task.name;
  row_for(preflight_rows, kind_of(task)).preflight(session, task, task_row(task).data(session.file, task), page);
  return page;
}

/// Several tasks read one record: what is told of it is told once.
void tell_once(std::vector<TaskPage>& pages) {
  Findings told;
  for (TaskPage& page : pages)
    std::erase_if(page.findings, [&](Finding const& each) {
      if (!tells_of_data(each.code)) return false;
      if (std::find(told.begin(), told.end(), each) != told.end()) return true;
      told.push_back(each);
      return false;
    });
}

}  // namespace

CheckResult check_file(Session& session) {
  CheckResult result;
  result.page.file = session.source.name();
  result.page.data_blocks = static_cast<int>(session.file.data.size());
  Diagnostics known_to_parse;
  if (auto const written = parse(session.source, known_to_parse))
    for (Model const& model : session.file.models)
      result.page.models.push_back(describe_structure(*written, session.file.tree, model));
  for (CheckedDictionary const& dictionary : session.file.dictionaries)
    result.page.dictionaries.push_back(describe_dictionary(dictionary));
  Preconditions const preconditions = check_preconditions(session);
  result.diagnostics = preconditions.diagnostics;
  result.unreadable = preconditions.unreadable;
  for (Task const& task : session.file.tasks) {
    try {
      result.page.tasks.push_back(check_task(session, task));
    } catch (IoError const&) {  // said by `check_preconditions`
      result.page.tasks.push_back({task.name, "its data cannot be read", {}, {}, {}});
    } catch (UserError const&) {
      result.page.tasks.push_back({task.name, "its data cannot be used", {}, {}, {}});
    }
  }
  tell_once(result.page.tasks);
  return result;
}

}  // namespace sysid
