// Predictions of prior draws with the actual input: whether they can be simulated, and whether their size is that of the data.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "app/preflight/preflight.hpp"
#include "app/search/solver_refinement.hpp"
#include "core/numeric/elementary.hpp"
#include "core/numeric/statistics.hpp"
#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "diagnostics/prior_checks.hpp"
#include "likelihood/parameter_space.hpp"

namespace sysid {
namespace {

constexpr double many_wild = 0.5;     // share of the draws
constexpr double bare_mention = 3.2;  // a Bayes factor "not worth more than a bare mention" (Kass and Raftery 1995)

struct Draw {
  int lane;
  double mismatch;  // sum over channels of |log(predicted range / measured range)|
};

PriorPage counts(Preflight const& preflight, PriorSimulations const& simulations) {
  SolverRow const& stated = preflight.what.solver.row();
  PriorPage page;
  page.draws = preflight.effort.prior_draws;
  page.stated = (preflight.bounded() ? preflight.what.solver : preflight.stated).text();
  page.failed_as_stated = simulations.failed_as_stated;
  page.spent = stated.adaptive;
  page.failed_explicit = simulations.failed_explicit;
  auto const label = [&](SolverRow const& row) {
    return std::string(row.name) + (row.name == stated.name ? " and more steps" : "");
  };
  if (!stated.stiff && !stated.exact) page.explicit_solver = label(adaptive_solver());
  page.stiff_left = simulations.stiff_left;
  page.stiff_tried = simulations.stiff_tried;
  page.stiff_followed = simulations.stiff_followed;
  page.stiff_solver = label(stiff_solver());
  page.failed = static_cast<int>(std::count(simulations.followed.begin(), simulations.followed.end(), false));
  // Those that it could not try fail at the same rate.
  if (page.stiff_tried > 0)
    page.failed = static_cast<int>(
        std::lround(static_cast<double>(simulations.stiff_left) * (page.stiff_tried - page.stiff_followed) / page.stiff_tried));
  page.failures = simulations.ledger.failures();
  page.untraced = simulations.untraced;
  return page;
}

// What a data block may have in a wrong unit so that simulations fail.
std::string units_that_scale(Model const& model) {
  std::string const time = "the unit of time in the data block";
  return model.inputs.empty() ? "and " + time : "the units of the " + plural("input", model.inputs.size()) + ", and " + time;
}

// The step of the rows is too long for nearly all of the prior: so it is when milliseconds are read as seconds. Empty otherwise.
std::string unit_of_time_first(Preflight const& preflight) {
  constexpr double nearly_all = 0.9;
  PriorPage const& page = *preflight.page.prior;
  SolverSettings const& solver = preflight.what.solver;
  bool const coarse = preflight.bounded() || (preflight.model().integrated() && solver.fixed_step() && !solver.row().exact);
  if (!coarse || page.failed_as_stated < nearly_all * page.draws) return {};
  Experiment const& first = preflight.experiments.front();
  if (first.time.size() < 2) return {};
  double const step = (first.time.back() - first.time.front()) / static_cast<double>(first.time.size() - 1);
  return fmt::format(
      "check the unit of time in the data block first: its rows are {} s apart, too far to resolve the motion that {} of {} prior "
      "draws predict; if the unit is right, ",
      significant(step, 3), page.failed_as_stated, page.draws);
}

// Draws that only an implicit method follows. Fixed explicit steps as short as the motion asks for would follow them, too, but
// there would be as many of them as adaptive ones take.
void check_stiffness(Preflight const& preflight, double share) {
  PriorPage const& page = *preflight.page.prior;
  if (preflight.what.solver.row().stiff || share <= many_failures) return;
  std::string const followed =
      page.failed == 0 ? "all" : fmt::format("about {:.0f} %", 100 * share * page.draws / page.failed_explicit);
  if (preflight.what.solver.row().exact)
    return preflight.add(
        FindingCode::stiff_prior, Severity::warning, {},
        fmt::format("the motion of {:.0f} % of the prior draws is too fast for {}, and {} succeeds on {} of these",
                    100.0 * page.failed_explicit / page.draws, page.stated, page.stiff_solver, followed),
        fmt::format("use `solver = {}`, or narrow the priors if such fast motion is not intended", page.stiff_solver));
  std::string const exact = preflight.exact_steps
                                ? fmt::format("`solver = {}`, which is exact for these equations", exact_solver().name)
                                : fmt::format("`solver = {}`", page.stiff_solver);
  preflight.add(
      FindingCode::stiff_prior, Severity::warning, {},
      fmt::format("explicit steps ({}, {}) fail on {:.0f} % of the prior draws, and {} succeeds on {} of these: the model is stiff "
                  "for these draws",
                  page.stated, page.explicit_solver, 100.0 * page.failed_explicit / page.draws, page.stiff_solver, followed),
      fmt::format("{}use {}, or narrow the priors if such fast motion is not intended", unit_of_time_first(preflight), exact));
}

std::string finer_advice(SolverSettings const& solver) {
  if (!solver.fixed_step()) return fmt::format("allow more `steps` (now {}) between two samples", solver.steps);
  return "use shorter steps, or " + solver.other_methods();
}

// With the steps that a fit would choose for its search; nothing where trying them would take long.
void check_search(Preflight const& preflight) {
  constexpr double affordable = 5e9, all_steps = 256.0 * (1 + 4 + 16 + 64);
  PriorPage const& page = *preflight.page.prior;
  bool const refines = preflight.refines_solver() && preflight.what.solver.fixed_step();
  if (!refines || page.failed_as_stated <= many_failures * page.draws) return;
  if (preflight.step_work * preflight.solver_work() * all_steps > affordable) return;
  auto const make = [&](SolverSettings const& solver) {
    return make_fit_target(preflight.session, preflight.what, preflight.session.compiled(preflight.what, solver.method),
                           preflight.space, preflight.experiments, solver, preflight.session.abandonable());
  };
  std::uint64_t const seed = preflight.session.options.seed.value_or(preflight.what.seed.value_or(1));
  for (Finding const& each : stiff_prior(search_solver(make, preflight.what.solver, seed), preflight.exact_steps))
    preflight.add(each.code, each.severity, each.names, each.message, each.help);
}

// Whether most draws fail because the solver was given fewer steps here than the task allows.
bool out_of_steps(Preflight const& preflight) {
  if (!preflight.bounded()) return false;
  std::uint64_t of_steps = 0, all = 0;
  for (Failure const& each : preflight.page.prior->failures) {
    all += each.count;
    if (each.kind == FailureClass::step_limit) of_steps += each.count;
  }
  return 2 * of_steps > all;
}

void check_failures(Preflight const& preflight) {
  PriorPage const& page = *preflight.page.prior;
  if (preflight.scales) preflight.page.findings.push_back(*preflight.scales);
  SolverSettings const& solver = preflight.what.solver;
  double const share = static_cast<double>(page.failed) / page.draws;
  double const stiff = static_cast<double>(page.failed_explicit - page.failed) / page.draws;
  double const lost = solver.row().stiff ? stiff : static_cast<double>(page.failed_as_stated - page.failed_explicit) / page.draws;
  if (out_of_steps(preflight) && share > many_failures)
    preflight.add(
        FindingCode::prior_fails, Severity::warning, {},
        fmt::format("{:.0f} % of the prior draws need more than {} steps of {} between two samples: `check` leaves these draws out",
                    100 * share, solver.steps, solver.method),
        unit_of_time_first(preflight) + "narrow the priors if such fast motion is not intended");
  else if (page.failed == page.draws)
    preflight.add(FindingCode::prior_fails, Severity::error, {},
                  fmt::format("all {} prior draws fail: the simulation or its likelihood is not finite", page.draws),
                  fmt::format("check the named expression (for example for a noise sd of 0), the priors, {}",
                              units_that_scale(preflight.model())));
  else if (share > many_failures)
    preflight.add(
        FindingCode::prior_fails, !preflight.candidate() || 1 / (1 - share) > bare_mention ? Severity::warning : Severity::note, {},
        fmt::format("the simulations of {:.0f} % of the prior draws fail{}", 100 * share,
                    preflight.candidate()
                        ? fmt::format(": this lowers the probability of the candidate by a factor of {:.2g}", 1 / (1 - share))
                        : ""),
        unit_of_time_first(preflight) + "narrow the priors, or check the named part of the equation");
  if (preflight.scales) return;  // no solver mends that
  check_stiffness(preflight, stiff);
  if (stiff <= many_failures) check_search(preflight);
  if (preflight.bounded() || (preflight.refines_solver() && solver.fixed_step())) return;
  if (lost > many_failures)
    preflight.add(
        FindingCode::integration_step, solver.as_model ? Severity::note : Severity::warning, {},
        fmt::format("with {}, {:.0f} % of the prior draws {}", solver.text(), 100 * lost,
                    solver.fixed_step() ? "overflow, but not with adaptive steps" : "need more steps between two samples"),
        fmt::format(
            "{}: {}", preflight.candidate() ? "failed simulations are never accepted" : "the search ignores failed simulations",
            solver.as_model ? "remove `as_model`, unless the solver is meant to be a part of the model" : finer_advice(solver)));
}

// Whether a channel reads a state, so that its prediction is expected to move.
bool follows_states(Model const& model, Channel const& channel) {
  return std::any_of(channel.noise.arguments.begin(), channel.noise.arguments.end(), [&](NodeId argument) {
    return model.graph.depends(argument, [](Node const& node) {
      return node.operation == Operation::leaf && (node.leaf_kind == LeafKind::state || node.leaf_kind == LeafKind::unknown);
    });
  });
}

// Whether an equation of the states reads an input.
bool drives(Model const& model) {
  return std::any_of(model.states.begin(), model.states.end(), [&](State const& state) {
    return model.graph.depends(
        state.derivative, [](Node const& node) { return node.operation == Operation::leaf && node.leaf_kind == LeafKind::input; });
  });
}

// Nothing moves the model at any draw: no other check has a response to look at.
void check_motion(Preflight const& preflight, PriorPage::Channel const& line, Channel const& channel) {
  if (line.high > 0 || !follows_states(preflight.model(), channel)) return;
  if (preflight.model().filtered()) return;  // disturbances and random starts move it; draws of the prior have their means
  std::vector<std::string> still;
  for (std::size_t i = 0; i < preflight.model().inputs.size(); ++i)
    if (std::all_of(preflight.experiments.begin(), preflight.experiments.end(), [&](Experiment const& each) {
          InputSignal const& input = each.inputs[i];
          for (int row = 1; row < input.rows(); ++row)
            if (input.sample(row) != input.sample(0)) return false;
          return true;
        }))
      still.push_back(preflight.model().inputs[i].name);
  bool const driven = !preflight.model().inputs.empty(), dead = driven && still.size() == preflight.model().inputs.size();
  preflight.add(
      FindingCode::prior_at_rest, Severity::warning, {line.name},
      fmt::format("{} is constant in the simulation of every prior draw, but its measured range is {}{}", line.name,
                  significant(line.measured, 2), unit_after_number(line.unit)),
      dead ? fmt::format("{} constant in the data: check the column, or give initial values other than zero",
                         quoted(still) + (still.size() == 1 ? " is" : " are"))
      : driven
          ? (drives(preflight.model())
                 ? "an input enters the equations, but does not affect this channel for any prior draw: compare the size and the "
                   "unit of the input with thresholds of the model, such as a dead zone, and check the priors of these thresholds"
                 : "check that an equation of this state contains an input")
          : "the model has no input: give initial values other than zero, or the input that drove the motion");
}

void check_ranges(Preflight const& preflight, PriorPage::Channel const& line, Channel const& channel, double apart) {
  if (line.middle == 0) return check_motion(preflight, line, channel);
  double const ratio = line.middle / line.measured;
  std::string size;
  if (ratio > wild || ratio < 1 / wild)
    size =
        fmt::format("the median of the prior draws predicts a range of {} {} than the one measured", line.name, times_apart(ratio));
  else if (apart >= many_wild)
    size =
        fmt::format("{:.0f} % of the prior draws predict a range of {} more than {} times larger or smaller than the one measured",
                    100 * apart, line.name, wild);
  if (size.empty()) return;
  preflight.page.findings.push_back(prior_far_from_data({line.name}, size));
}

double range(auto const& value, int first, int end) {
  double low = value(first), high = low;
  for (int r = first; r < end; ++r) {
    low = std::min(low, value(r));
    high = std::max(high, value(r));
  }
  return high - low;
}

// One channel of one experiment: rows [first, end) of the predictions.
void compare_ranges(Preflight const& preflight, int first, int end, LaneArray const& centres, std::vector<Draw>& draws) {
  std::vector<Output::Place> const& places = preflight.output().places();
  double const measured = range([&](int r) { return places[static_cast<std::size_t>(r)].measured; }, first, end);
  std::vector<double> finite;
  double apart = 0;  // draws
  for (Draw& draw : draws) {
    double const predicted = range([&](int r) { return centres(r, draw.lane); }, first, end);
    // A record that stays where it is says nothing of size.
    double const mismatch = measured > 0 ? std::abs(elementary::log(predicted / measured)) : 0 * predicted;
    bool const near = mismatch <= elementary::log(wild);
    draw.mismatch += near ? mismatch : std::nan("");
    if (!std::isfinite(predicted)) continue;
    finite.push_back(predicted);
    apart += near ? 0 : 1;
  }
  if (finite.empty()) return;
  Output::Place const& place = places[static_cast<std::size_t>(first)];
  Channel const& channel = preflight.model().channels[static_cast<std::size_t>(place.channel)];
  std::string name = channel.name;
  if (preflight.experiments.size() > 1) name += " on " + preflight.experiments[static_cast<std::size_t>(place.experiment)].name;
  PriorPage::Channel line{name,
                          channel.unit_text(),
                          channel.from_si(quantile(finite, 0.05)),
                          channel.from_si(quantile(finite, 0.5)),
                          channel.from_si(quantile(finite, 0.95)),
                          channel.from_si(measured)};
  if (measured > 0) check_ranges(preflight, line, channel, apart / static_cast<double>(finite.size()));
  preflight.page.prior->channels.push_back(std::move(line));
}

}  // namespace

PriorDraws draw_prior(Preflight const& preflight) {
  int const count = preflight.effort.prior_draws;
  ParameterSpace const& space = *preflight.space;
  PriorDraws prior;
  LaneArray theta(space.dimension(), count), declared(space.dimension(), count);
  space.sample_prior({preflight.session.options.seed.value_or(preflight.what.seed.value_or(1)), Purpose::prior, 0, 0}, theta);
  space.constrain(theta, declared);
  prior.theta = theta;
  std::vector<ParameterRole> const roles = parameter_roles(preflight.model());
  std::vector<std::string> noise;
  for (int k = 0; k < space.dimension(); ++k) {
    FittedParameter const& row = space.rows()[static_cast<std::size_t>(space.sampled()[static_cast<std::size_t>(k)])];
    ParameterInfo const& info = space.infos()[static_cast<std::size_t>(k)];
    auto const values = declared.row(k);
    AssessedParameter coordinate{
        {row.name, info.unit, row.to_si(1)}, roles[static_cast<std::size_t>(row.parameter)], info.lower >= 0, 0, info.coefficient};
    coordinate.standardised = is_standardised(space.model(), space.model().parameters[static_cast<std::size_t>(row.parameter)]);
    std::vector<double> scaled;
    for (double const value : values) scaled.push_back(coordinate.relative ? elementary::log(value) : row.to_si(value));
    coordinate.spread = (quantile(scaled, 0.84) - quantile(scaled, 0.16)) / 2;  // heavy tails leave it alone
    if (coordinate.role == ParameterRole::noise) {
      double const middle = quantile(std::vector<double>(values.begin(), values.end()), 0.5);
      std::fill(values.begin(), values.end(), middle);
      noise.push_back(fmt::format("{} = {}{}", row.name, significant(middle, 2), unit_after_number(info.unit)));
    }
    prior.coordinates.push_back(std::move(coordinate));
  }
  prior.noise = listed(noise);
  // What the prior predicts knows nothing of the record.
  std::vector<Experiment> along = preflight.experiments;
  std::optional<Output> free;
  if (preflight.model().filtered()) {
    for (Experiment& each : along) each = each.unread();
    free.emplace(preflight.output_along(along));
  }
  Output const& stated = free ? *free : preflight.output();
  LaneArray const values = space.values_of_declared(declared);
  prior.points = LaneArray(stated.point_rows(), count);
  for (int r = 0; r < values.rows(); ++r)
    for (int w = 0; w < count; ++w) prior.points(r, w) = values(r, w);
  stated.start(prior.points);
  prior.simulations =
      simulate_prior(preflight.session, preflight.what, preflight.compiled, preflight.space, along, stated, theta, prior.points);
  return prior;
}

std::vector<int> describe_prior(Preflight const& preflight, PriorDraws const& prior) {
  preflight.page.prior = counts(preflight, prior.simulations);
  check_failures(preflight);
  std::vector<Draw> draws;
  for (int w = 0; w < preflight.effort.prior_draws; ++w)
    if (prior.simulations.followed[static_cast<std::size_t>(w)]) draws.push_back({w, 0});
  for (auto const& [first, end] : preflight.responses()) compare_ranges(preflight, first, end, prior.simulations.centres, draws);
  std::erase_if(draws, [](Draw const& draw) { return !std::isfinite(draw.mismatch); });
  std::stable_sort(draws.begin(), draws.end(), [](Draw const& a, Draw const& b) { return a.mismatch < b.mismatch; });
  std::vector<int> lanes;
  for (Draw const& draw : draws) lanes.push_back(draw.lane);
  return lanes;
}

}  // namespace sysid
