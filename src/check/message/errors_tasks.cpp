// The checker's wording about tasks, their options and their experiments.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <span>

#include "check/message/error_words.hpp"
#include "syntax/unparse.hpp"

namespace sysid::errors {
namespace {

constexpr Synonym solver_synonyms[] = {
    {"rk45", "dopri5"},     {"ode45", "dopri5"},   {"dopri", "dopri5"},  {"rkdp", "dopri5"},  {"dp5", "dopri5"},
    {"tsit5", "dopri5"},    {"rkf45", "dopri5"},   {"dop853", "dopri5"}, {"rk23", "dopri5"},  {"ode23", "dopri5"},
    {"vode", "cvode"},      {"bdf", "cvode"},      {"ode15s", "cvode"},  {"ode23s", "cvode"}, {"ode23t", "cvode"},
    {"radau", "cvode"},     {"lsoda", "cvode"},    {"cvodes", "cvode"},  {"adams", "cvode"},  {"rosenbrock", "cvode"},
    {"runge_kutta", "rk4"}, {"rungekutta", "rk4"}, {"ode4", "rk4"},      {"ode1", "euler"},   {"ode2", "heun"},
    {"dassl", "ida"},       {"daspk", "ida"},      {"idas", "ida"},      {"ode15i", "ida"},   {"expm", "exponential"}};

constexpr Synonym option_synonyms[] = {
    {"iter", "samples"},
    {"iterations", "samples"},
    {"niter", "samples"},
    {"n_iter", "samples"},
    {"num_samples", "samples"},
    {"n_samples", "samples"},
    {"nsamples", "samples"},
    {"draws", "samples"},
    {"n", "samples"},
    {"warmup", "burn_in"},
    {"tune", "burn_in"},
    {"burn", "burn_in"},
    {"burnin", "burn_in"},
    {"discard", "burn_in"},
    {"num_warmup", "burn_in"},
    {"n_warmup", "burn_in"},
    {"nchains", "chains"},
    {"n_chains", "chains"},
    {"num_chains", "chains"},
    {"walkers", "chains"},
    {"nwalkers", "chains"},
    {"thinning", "thin"},
    {"adapt_delta", "acceptance"},
    {"target_accept", "acceptance"},
    {"delta", "acceptance"},
    {"max_treedepth", "depth"},
    {"max_tree_depth", "depth"},
    {"fs", "rate"},
    {"sampling_rate", "rate"},
    {"frequency", "rate"},
    {"sample_rate", "rate"},
    {"dt", "step"},
    {"ts", "step"},
    {"integrator", "solver"},
    {"ode_solver", "solver"},
    {"random_seed", "seed"},
    {"rng", "seed"},
    {"random_state", "seed"},
    {"parameters", "values"},
    {"params", "values"},
    {"theta", "values"},
    {"init", "start"},
    {"initial", "start"},
    {"inits", "start"},
    {"x0", "start"},
    {"n_draws", "draws"},
    {"samples", "draws"},
    {"population", "particles"},
    {"metric", "distance"},
};

constexpr std::string_view of_threads = "threads are an option of the command: `sysid run FILE --threads 4`",
                           of_folder = "the folder of results is an option of the command: `sysid run FILE -o DIR`",
                           of_backend = "write the back end directly after `with`: `with mh`",
                           of_tolerance =
                               "tolerances are settings of a solver, `relative` and `absolute`: `solver = dopri5(relative = 1e-8)`",
                           of_step = "the solver step follows from the number of steps in each sampling interval: `substeps = 10`",
                           of_duration = "write the number of rows: `samples` is the duration times the rate";
/// What is no option of a task, and where it is written.
constexpr Synonym option_places[] = {
    {"threads", of_threads},
    {"cores", of_threads},
    {"jobs", of_threads},
    {"n_jobs", of_threads},
    {"parallel", of_threads},
    {"output", of_folder},
    {"out", of_folder},
    {"folder", of_folder},
    {"rtol", of_tolerance},
    {"reltol", of_tolerance},
    {"atol", of_tolerance},
    {"abstol", of_tolerance},
    {"dt", of_step},
    {"timestep", of_step},
    {"method", of_backend},
    {"algorithm", of_backend},
    {"backend", of_backend},
    {"sampler", of_backend},
    {"duration", of_duration},
    {"time", of_duration},
    {"snr", "noise is given relative to the standard deviation of the signal: `noise = 1 [percent]`"},
    {"input", "an input is named: `input x = gaussian(sd = 10)`"},
};
/// How what a task names is declared.
constexpr Synonym declared_by[] = {
    {"model", "model"}, {"data block", "data"}, {"dictionary", "dictionary"}, {"set of candidates", "candidates"}};
constexpr std::string_view of_backends[] = {"samples", "burn_in", "thin", "chains", "proposal", "particles", "variance"};

constexpr Synonym backend_synonyms[] = {
    {"hmc", "nuts"},
    {"hamiltonian", "nuts"},
    {"mcmc", "mh"},
    {"metropolis", "mh"},
    {"emcee", "mh"},
    {"dream", "mh"},
    {"gibbs", "mh"},
    {"slice", "mh"},
    {"stan", "nuts"},
    {"metropolis_hastings", "mh"},
    {"lsq", "ml"},
    {"least_squares", "ml"},
    {"leastsq", "ml"},
    {"mle", "ml"},
    {"optimize", "ml"},
    {"newton", "ml"},
    {"lm", "ml"},
    {"bfgs", "ml"},
    {"nlls", "ml"},
    {"vb", "map"},
    {"advi", "map"},
    {"laplace", "map"},
    {"vi", "map"},
    {"smc", "tempering"},
    {"pt", "tempering"},
    {"abc", "abc_smc"},
    {"rjmcmc", "reversible_jump"},
    {"rj", "reversible_jump"},
    {"sindy", "spike_slab"},
    {"rvm", "ard"},
    {"parallel_tempering", "tempering"},
    {"horseshoe", "spike_slab"},
};

template <class Words>
bool among(Words const& all, std::string const& word) {
  return std::find(std::begin(all), std::end(all), word) != std::end(all);
}

/// Help about an option that is written elsewhere, or empty.
std::string place_of_option(std::string const& option, OptionOwner const& owner, Names const& known) {
  bool const inside = owner.name != owner.verb, own = among(owner.verbs, owner.verb);
  if (inside && own) return fmt::format("`{0}` is an option of the task: write `{0} = ...` after the parentheses", option);
  if (inside && option == "x0") return "remove it: a fit has no start values, its search begins at draws of the prior";
  if (known.empty()) return fmt::format("it has none: write `{}`", owner.name);
  if (inside && (option == "step" || option == "dt" || option == "h") && among(known, "substeps"))
    return fmt::format("write the number of steps in each sampling interval: `{}(substeps = 10)`", owner.name);
  auto const kind = words::task_kind(owner.verb);
  if (!inside && kind == TaskKind::predict && (option == "steps" || option == "horizon"))
    return "a prediction from the samples up to some rows before is written `prediction = steps(10)`";
  constexpr std::string_view tolerances[] = {"rtol", "reltol", "atol", "abstol"};
  if (inside && among(tolerances, option) && among(known, "relative"))
    return fmt::format("write `{}(relative = 1e-8, absolute = 1e-10)`", owner.name);
  bool const has_backend = kind == TaskKind::fit || kind == TaskKind::select;
  if (!inside && has_backend && among(of_backends, option))
    return fmt::format("`{0}` is a setting of the back end: write it in its parentheses, `{1}({0} = ...)`", option,
                       kind == TaskKind::fit ? "mh" : "abc_smc");
  for (Synonym const& each : option_places)
    if (option == each.foreign) return std::string(each.ours);
  if (owner.verbs.empty() || own) return {};
  return fmt::format("remove it: `{}` is an option of {}", option, quoted(owner.verbs));
}

/// The word of a back end on one side of an operator; empty where there is none.
std::string word_of(ast::Expression const& tree) {
  if (auto const* call = std::get_if<ast::Box<ast::Call>>(&tree.node)) return unparse(ast::Expression{tree.span, *call});
  auto const* reference = std::get_if<ast::Reference>(&tree.node);
  return reference == nullptr || reference->primes > 0 ? std::string() : reference->name.text;
}

}  // namespace

Diagnostic unknown_item(ast::Name const& name, std::string const& kind, Names const& known) {
  std::string help = guess_or(name.text, known, choose(known, kind));
  for (Synonym const& each : declared_by)
    if (known.empty() && kind == each.foreign)
      help = fmt::format("this file has none: declare one, `{} NAME {{ ... }}`", each.ours);
  return about({name.text},
               error("E6001", name.span, fmt::format("there is no {} `{}` in this file", kind, name.text), std::move(help)), kind);
}

std::string verb_of_subject(ast::Task const& task, std::string const& kind, std::string const& verb) {
  std::string_view const preposition = verb == "discover" ? "from" : "to";
  std::string const data = task.data.empty() ? "DATA" : task.data.front().data.text;
  return fmt::format("`{0}` is a {1}: write `{2} {0} {3} {4}{5}`", task.subject.text, kind, verb, preposition, data,
                     verb == "select" ? " with abc_smc(particles = 1000)" : "");
}

Diagnostic unknown_fit(ast::Name const& name, Names const& known, bool is_data) {
  Diagnostic result = unknown_item(name, "fit", known);
  if (is_data)
    result.help = fmt::format("`{0}` is a data block: a fit predicts `on` data, `predict FIT on {0}`", name.text);
  else if (known.empty())
    result.help = "a fit is a task with a name: `posterior = fit MODEL to DATA with mh(samples = 1000)`";
  return result;
}

Diagnostic unknown_member(ast::Name const& name, Subject const& owner, std::string const& kind, Names const& known) {
  return also_about(owner.names, about({name.text},
                                       error("E6001", name.span, fmt::format("{} has no {} `{}`", owner.words, kind, name.text),
                                             guess_or(name.text, known, choose(known, kind))),
                                       fmt::format("{} of {}", kind, fmt::join(owner.names, " "))));
}

Diagnostic unknown_option(Span span, std::string const& option, OptionOwner const& owner, Names const& known) {
  constexpr std::string_view starts[] = {"starts", "n_starts", "nstarts", "restarts", "n_restarts", "multistart"};
  if (among(starts, option) && words::task_kind(owner.verb) == TaskKind::fit)
    return about({owner.name, option}, error("E6002", span, fmt::format("`{}` has no option `{}`", owner.name, option),
                                             "remove it: the search begins at many draws of the prior"));
  std::string help = guess_or(option_synonyms, option, known, place_of_option(option, owner, known));
  if (help.empty()) help = fmt::format("{} {}", known.size() == 1 ? "its option is" : "its options are", quoted(known));
  return about({owner.name, option},
               error("E6002", span, fmt::format("`{}` has no option `{}`", owner.name, option), std::move(help)));
}

Diagnostic option_without_name(ast::Expression const& option, std::string const& verb) {
  std::string help = "the back end is named first, then each option with `=`: `with mh, seed = 1`";
  if (auto const* text = std::get_if<ast::Text>(&option.node))
    help = fmt::format("write the name of a back end without quotes: `with {}`", text->value);
  auto const* both = std::get_if<ast::Box<ast::Binary>>(&option.node);
  if (both != nullptr)
    if (std::string const left = word_of(*(*both)->left), right = word_of(*(*both)->right); !left.empty() && !right.empty())
      help = fmt::format("a task has one back end: write `with {}` or `with {}`", left, right);
  return about({verb}, error("E6002", option.span, fmt::format("`{}` is no option of `{}`", unparse(option), verb), help));
}

Diagnostic list_without_parentheses(ast::Call const& call, std::size_t first, std::size_t last) {
  std::string const& name = call.arguments[first].name->text;
  std::string items = unparse(call.arguments[first].value);
  for (std::size_t i = first + 1; i <= last; ++i) items += ", " + unparse(call.arguments[i].value);
  return about({name}, error("E2106", cover(call.arguments[first + 1].span, call.arguments[last].span),
                             "the name of this argument is missing, or it belongs to the list before it",
                             fmt::format("a list is written in parentheses: `{} = ({})`", name, items)));
}

Diagnostic option_missing(ast::Task const& task, std::string const& option, std::string const& example) {
  return about({task.verb.text, option},
               error("E6003", task.verb.span, fmt::format("`{}` needs the option `{}`", task.verb.text, option),
                     fmt::format("add `{}` after `with`", example)));
}

Diagnostic option_kind(Span span, std::string const& option, Subject const& wanted, std::string const& example) {
  return also_about(wanted.names, about({option}, error("E6004", span, fmt::format("`{}` must be {}", option, wanted.words),
                                                        fmt::format("for example `{}`", example))));
}

Diagnostic option_range(Span span, std::string const& option, double given, double least, double most) {
  std::string const range = most < 1e9 || given > most ? fmt::format("lie between {} and {}", least, most)
                            : least > 1e-15            ? fmt::format("be at least {}", least)
                            : least == 0               ? std::string("not be negative")
                            : least > 0                ? std::string("be positive")
                                                       : std::string("be finite");
  return about({option}, error("E6005", span, fmt::format("`{}` must {}, but is {}", option, range, given),
                               "choose a number that satisfies this"));
}

Diagnostic angle_beyond_turn(ast::Expression const& given, std::string const& option) {
  std::string const number = unparse(given);
  return about({option},
               error("E6005", given.span,
                     fmt::format("`{}` without a unit is in radians, and {} radians are more than a turn", option, number),
                     fmt::format("write `{0} [deg]` for degrees, `{0} [rad]` for radians", number)));
}

Diagnostic option_range_or_zero(Span span, std::string const& option, double given, double least, double most) {
  return about({option},
               error("E6005", span, fmt::format("`{}` must be 0 or lie between {} and {}, but is {}", option, least, most, given),
                     "choose a number that satisfies this"));
}

Diagnostic option_choice(Span span, std::string const& option, std::string const& given, Names const& choices) {
  Names names{option};
  if (!given.empty()) names.push_back(given);
  return about(names, error("E6006", span, fmt::format("`{}` cannot be {}", option, given.empty() ? "this" : "`" + given + "`"),
                            guess_or(solver_synonyms, given, choices, fmt::format("choose {}", quoted(choices, "or")))));
}

Diagnostic backend_missing(ast::Task const& task, Names const& known) {
  bool const selects = words::task_kind(task.verb.text) == TaskKind::select;
  std::string const example = selects ? "with abc_smc(particles = 1000)" : "with mh(samples = 25000)";
  return error("E6007", task.verb.span, fmt::format("this {} has no back end", selects ? "selection" : "fit"),
               fmt::format("{}; back ends: {}",
                           task.options.empty() ? fmt::format("add `{}`", example)
                                                : fmt::format("name it before the options: `{}, ...`", example),
                           quoted(known)));
}

Diagnostic unknown_backend(ast::Name const& name, Names const& known) {
  if (name.text == "values" || name.text == "fix" || name.text == "fixed")
    return about({name.text}, error("E6008", name.span, fmt::format("there is no back end `{}`", name.text),
                                    "remove it, and give the parameter its value in the model: `parameter m [kg] = 1`"));
  if (name.text == "weights" || name.text == "weight")
    return about({name.text}, error("E6008", name.span, fmt::format("there is no back end `{}`", name.text),
                                    "remove it: a channel weighs by the size of its noise, `observe d ~ normal(y, sd = sigma)`"));
  return about({name.text}, error("E6008", name.span, fmt::format("there is no back end `{}`", name.text),
                                  guess_or(backend_synonyms, name.text, known, fmt::format("back ends: {}", quoted(known)))));
}

Diagnostic data_missing(ast::Task const& task, std::string const& preposition) {
  return error("E6009", task.verb.span, fmt::format("this {} has no data", task.verb.text),
               fmt::format("add `{} DATA` or `{} DATA.RANGE`", preposition, preposition));
}

Diagnostic data_unused(ast::Task const& task, Span data) {
  return about({task.verb.text}, error("E6013", data, fmt::format("`{}` takes no data: it generates its inputs", task.verb.text),
                                       "remove the data, or use `predict` with a fit"));
}

Diagnostic not_a_fit(ast::Name const& name, std::string const& verb) {
  return about({name.text}, error("E6010", name.span, fmt::format("`{}` is not a fit", name.text),
                                  words::task_kind(verb) == TaskKind::predict ? "`predict` needs the name of a fit or a selection"
                                                                              : "`search = near(...)` needs the name of a fit"));
}

Diagnostic fixed_parameter(ast::Name const& name, Span declaration) {
  return about({name.text}, conflict("E6014", name.span, "given another value here", declaration, "fixed here",
                                     fmt::format("parameter `{}` has a fixed value in the model", name.text),
                                     "change it there, or give it a prior"));
}

Diagnostic value_missing(Span span, Names const& parameters) {
  return about(parameters, error("E6011", span, fmt::format("a simulation needs a value for {}", quoted(parameters)),
                                 fmt::format("write `values({} = ..., ...)`", parameters.front())));
}

Diagnostic sine_beyond_half_rate(Span span, double frequency, double half_rate) {
  return error(
      "E6101", span,
      fmt::format("this sine has {:.6g} Hz, but half the sampling rate is {:.6g} Hz: its samples would be those of a sine of "
                  "a lower frequency",
                  frequency, half_rate),
      "reduce `frequency` or raise `rate`");
}

Diagnostic multisine_beyond_half_rate(Span span, double highest, double half_rate) {
  return error("E6101", span,
               fmt::format("this multisine reaches {:.6g} Hz, but half the sampling rate is {:.6g} Hz", highest, half_rate),
               "reduce `highest` or raise `rate`");
}

Diagnostic multisine_without_harmonic(Span span, double lowest, double highest, double resolution) {
  return error("E6101", span,
               fmt::format("no harmonic of the record (a multiple of {:.6g} Hz) lies between {:.6g} and {:.6g} Hz", resolution,
                           lowest, highest),
               "widen the band from `lowest` to `highest`, or use more samples");
}

Diagnostic solver_of_nothing(Span option, std::string const& subject) {
  return as_warning(about({subject}, error("E6019", option, fmt::format("`{}` has no differential equations to integrate", subject),
                                           "remove the option: it has no effect")));
}

Diagnostic value_outside_prior(Span value, std::string const& name, Span parameter) {
  return as_warning(
      about({name}, conflict("E6020", value, "this value", parameter, "its prior",
                             fmt::format("this value of `{}` is outside the bounds of its prior", name),
                             "check the value and its unit, or widen the prior: a fit of this model cannot find it")));
}

Diagnostic task_too_late(ast::Name const& name) {
  Diagnostic result = about({name.text}, error("E6012", name.span, fmt::format("task `{}` comes later in the file", name.text),
                                               "tasks run in the order of the file: move that task before this one"));
  result.prompt_help = fmt::format(
      "a task cannot use a task that was entered after it: give this task another name, or enter `{}` again", name.text);
  return result;
}

Diagnostic experiment_twice(Span second, Span first, std::string const& experiment, bool predicted) {
  return about({experiment}, conflict("E6304", second, "again", first, "first here",
                                      predicted ? fmt::format("`{}` would be predicted twice", experiment)
                                                : fmt::format("`{}` is used twice: its samples would count twice", experiment),
                                      "list each experiment once"));
}

Diagnostic experiments_overlap(Span second, Span first, std::string const& one, std::string const& other) {
  return about({one, other},
               conflict("E6304", second, "these rows", first, "already used here",
                        fmt::format("`{}` and `{}` overlap: the shared rows would count twice", one, other), "use separate rows"));
}

}  // namespace sysid::errors
