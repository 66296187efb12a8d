// Words from all tables.
#include "repl/help.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/catalogue/explain.hpp"
#include "app/catalogue/lists.hpp"
#include "app/catalogue/module_page.hpp"
#include "check/task/task_options.hpp"
#include "core/text/wrapped.hpp"
#include "data/input_rule.hpp"
#include "repl/statistics.hpp"
#include "repl/workbench.hpp"
#include "syntax/words.hpp"

namespace sysid::repl {
namespace {

constexpr KeywordRow keyword_rows[] = {
    // what stands in a file
    {"use", "use hysteresis",
     "imports the models and functions of a module, from the library (`list modules`) or from the folder of the file"},
    {"model", "model duffing { ... }",
     "a model: inputs, states, parameters, equations, what is observed; with arguments it is a family of models, `model law(n)`"},
    {"data", "data bench { ... }", "a record: its file, columns and units, the rule between the samples of an input, splits"},
    {"candidates", "candidates set { linear; law(n = 2..4) }", "candidate models for a selection"},
    {"dictionary", "dictionary spring { ... }", "the candidate terms of an unknown equation"},
    {"function", "function f(a, b) = a*b, function d(u) ~ gp(...)",
     "a user-defined function; with ~ an unknown function, a Gaussian process"},
    // tasks
    {"simulate", "made = simulate duffing with values(m = 1), input x = gaussian(sd = 10), samples = 500, rate = 1000 [Hz]",
     "generates a record from given parameter values"},
    {"fit", "posterior = fit duffing to bench.train with mh(samples = 25000)",
     "estimates the parameters; `map` is fast, `mh` gives the posterior (`list backends`)"},
    {"select", "chosen = select set to bench with abc_smc",
     "estimates the probabilities of candidate models, with their parameters"},
    {"discover", "found = discover spring from bench with spike_slab", "finds an equation from the terms of a dictionary"},
    {"predict", "forecast = predict posterior on bench.test with draws(200)", "predicts a record with the draws of a fit"},
    {"to", "fit duffing to bench.train", "comes before the records of `fit` and `select`"},
    {"on", "predict posterior on bench.test", "comes before the records of `predict`"},
    {"from", "discover spring from bench", "comes before the records of `discover`"},
    {"with", "fit duffing to bench with map, seed = 1", "comes before the options of a task"},
    // inside a model
    {"time", "time t [s], time discrete 0.25 [s]",
     "in a model: the name of time, or the step of discrete time; in a data block: the column with the time"},
    {"input", "input x [N]", "an input of a model; in a data block: its column, `input x = force [N] hold linear`"},
    {"state", "state y [m]", "an unknown of the equations; its order is the largest number of primes on it"},
    {"disturbance", "disturbance w [N] ~ white(intensity = q)",
     "an unmeasured quantity that drives the states (`list disturbances`)"},
    {"initial", "initial y = 0, y' = v0",
     "initial values of states and of their derivatives below the highest; random ones: `initial y ~ normal(0, sd = 0.1)`"},
    {"parameter", "parameter k [N/m] ~ log_uniform(1e3, 1e5)",
     "an unknown parameter with its prior, or one with a fixed value, `= 1`"},
    {"constant", "constant g [m/s^2] = 9.81", "a named number; in a data block: the value of a parameter in this experiment"},
    {"let", "let w0 = sqrt(k/m)", "an expression with a name"},
    {"derive", "derive fn [Hz] = sqrt(k/m)/(2*pi)", "a quantity of interest, which gets a posterior as parameters do"},
    {"observe", "observe displacement ~ normal(y, sd = sigma)",
     "the distribution of a measured channel: the response of the model, with noise"},
    {"part", "part joint = bouc_wen(n = 2, displacement = y)", "another model inside this one; its names are written joint.k"},
    {"discrete", "time discrete 0.25 [s]", "a model that steps from sample to sample"},
    {"per", "parameter k per experiment [N/m] ~ normal(mu, sd = tau)", "a parameter with a separate value in each experiment"},
    {"experiment", "parameter k per experiment [N/m] ~ normal(mu, sd = tau)", "each of the records that are fitted together"},
    {"lag", "lag(measured(level), 1)", "in discrete time: the value that a quantity had the given number of samples earlier"},
    {"lags", "lags(U, 0..4)", "in discrete time: the values that a quantity had at several lags, as arguments of a function"},
    {"since_last", "poisson(since_last(-S))", "the change of a quantity since the previous row"},
    {"gp", "function d(u) ~ gp(squared_exponential(amplitude = s, length = l))",
     "a Gaussian process with its covariance (`list kernels`)"},
    {"pi", "2*pi", "3.14159..., the ratio of circumference to diameter"},
    {"inf", "normal(0, sd = 1, lower = 0, upper = inf)", "infinity"},
    {"if", "if y > 0 then k else 0", "chooses one of two values by a condition"},
    {"then", "if y > 0 then k else 0", "comes before the value that applies if the condition holds"},
    {"else", "if y > 0 then k else 0", "comes before the value that applies if the condition does not hold"},
    {"and", "if y > 0 and x < 1 then k else 0", "both conditions hold"},
    {"or", "if y > 0 or x < 1 then k else 0", "at least one of the conditions holds"},
    {"not", "if not y > 0 then k else 0", "the condition does not hold"},
    // inside a data block
    {"file", "file \"bench.csv\"",
     "the file of a record: CSV, MATLAB, NetCDF or HDF5; its path is relative to the folder of the .sysid file"},
    {"read", "read decimal = \",\", names = 4", "the format of a file that is not plain CSV (`list reading` shows the settings)"},
    {"rate", "rate 1000 [Hz]", "samples per second, if no column contains the time"},
    {"step", "step 1 [ms]", "the time between samples, if no column contains it"},
    {"measure", "measure displacement = y_noisy [mm]", "the column with the samples of a channel, and its unit"},
    {"split", "split train = rows 1..500, test = rows 501..1500",
     "named ranges of rows, for example one to fit and one to test; rows count from 1, and both ends are included"},
    {"rows", "split train = rows 1..500", "a range of rows of the file; rows count from 1, and both ends are included"},
    {"hold", "input x = force [N] hold zero_order", "the rule for an input between samples"},
    {"error", "input x = force [N] hold zero_order error normal(sd = 0.5)", "the measurement error of the samples of an input"},
    // candidates and dictionaries
    {"shared", "shared m, c", "parameters that have the same meaning in every candidate"},
    {"probability", "linear probability 0.5",
     "prior probability of a candidate; at the prompt, `probability(k3 > 0)` is the fraction of the draws for which a comparison "
     "holds"},
    {"target", "target = m*y'' - x", "the known part of an equation to be discovered"},
    {"terms", "terms = polynomial(y, y', degree = 3), sign(y')", "the candidate terms of the equation"},
    {"exclude", "exclude = y*y'", "terms of a family that are not used"},
    {"coefficients", "coefficients = [N/m], [N/m^3]", "the units that coefficients may have"},
    // words in options of tasks
    {"record", "start = record", "the simulation starts at the first row of the file, from the model's initial values"},
    {"rest", "start = rest", "the simulation starts at the first scored row, from the model's initial values"},
    {"estimated", "start = estimated(rows = 50)", "the simulation starts in the state that best fits the first rows"},
    {"near", "search = near(posterior)", "starts the search where an earlier fit ended: fast, but finds no other modes"},
    {"everywhere", "search = everywhere", "starts the search from draws of the prior"},
    {"as_written", "prediction = as_written", "lagged samples are measured or predicted as written in the model"},
    {"one_step", "prediction = one_step",
     "lagged samples are the measured ones; random states are estimated from all samples before each row"},
    {"free_run", "prediction = free_run",
     "lagged samples are the predicted ones; random states are estimated only from the samples before the first predicted row"},
    {"steps", "prediction = steps(10)", "random states are estimated from the samples at least that many rows before each row"},
    {"gaussian", "input x = gaussian(sd = 10)", "a random input for a simulation"},
    {"sine", "input x = sine(amplitude = 1, frequency = 10 [Hz])", "an input of one frequency"},
    {"multisine", "input x = multisine(sd = 1, lowest = 1 [Hz], highest = 100 [Hz])", "an input of many frequencies"},
    {"derivatives", "spike_slab(derivatives = weak)", "how a discovery computes derivatives from a record"},
};

std::string entry_of(KeywordRow const& row) { return fmt::format("{}\n  {}\n", row.usage, row.summary); }

struct Lines {
  std::string_view text;
  bool next(std::string_view& line) {
    if (text.empty()) return false;
    auto const end = std::min(text.find('\n'), text.size());
    line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return true;
  }
};

bool begins_with_word(std::string_view line, std::string_view word) {
  return line.starts_with(word) && (line.size() == word.size() || !words::continues_name(line[word.size()]));
}

/// The lines about a word in what `list` prints: its own with those below it, or its line as a setting with the owner's.
std::string from_list(ListRow const& topic, std::string_view word) {
  std::string const text = topic.text();
  std::string found, owner;
  bool inside = false;
  Lines lines{text};
  for (std::string_view line; lines.next(line);) {
    bool const below = line.starts_with(' ');
    if (!below) {
      inside = begins_with_word(line, word);
      owner = line.substr(0, line.find(':'));
    }
    if (inside) {
      found += fmt::format("{}\n", line);
    } else if (below && begins_with_word(line.substr(line.find_first_not_of(' ')), word)) {
      found += fmt::format("{} of {}:\n{}\n", word, owner, line);
    }
  }
  return found;
}

void add_words(ListRow const& topic, std::vector<std::string>& words) {
  std::string const text = topic.text();
  Lines lines{text};
  for (std::string_view line; lines.next(line);) {
    if (line.empty() || line.starts_with("   ")) continue;
    if (line.starts_with("  ")) line.remove_prefix(2);  // a setting
    std::size_t end = 0;
    while (end < line.size() && words::continues_name(line[end])) ++end;
    bool const heading = line.find("  ") == std::string_view::npos && line.find(':') == std::string_view::npos;
    if (end > 0 && !heading) words.emplace_back(line.substr(0, end));
  }
}

}  // namespace

std::span<KeywordRow const> keywords() {
  static std::vector<KeywordRow> const rows = [] {
    std::vector<KeywordRow> all(std::begin(keyword_rows), std::end(keyword_rows));
    for (InputRuleRow const& rule : input_rules()) all.push_back({rule.name, rule.usage, rule.summary});
    for (std::string_view const verb : words::verbs)
      for (TaskOptionRow const& option : task_options(verb)) {
        bool const known = std::any_of(all.begin(), all.end(),
                                       [&](KeywordRow const& row) { return row.word == option.name && row.usage == option.usage; });
        if (!known) all.push_back({option.name, option.usage, option.summary});
      }
    return all;
  }();
  return rows;
}

std::optional<std::string> help_on(std::string const& word, int columns) {
  std::string text;
  auto const add = [&](std::string const& more) { text += (text.empty() || more.empty() ? "" : "\n") + more; };
  auto const add_rows = [&](std::string const& rows) { add(wrapped_rows(rows, columns)); };
  for (CommandRow const& row : commands())
    if (row.name == word) add_rows(fmt::format("{}\n  {}\n", row.usage, row.summary));
  for (PromptFunction const& row : prompt_functions())
    if (row.name == word) add_rows(fmt::format("{} (at the prompt)\n  {}\n", row.usage, row.summary));
  for (std::string_view const plot : {"plot", "trace", "histogram"})
    if (word == plot)
      add_rows(
          "plot(trace(k)), plot(histogram(k)), plot(k, k3), plot(residual(output)), plot(posterior), plot(bench)\n  a plot in "
          "characters: draws "
          "in order, a histogram, one quantity against another, a series along its record,\n  a fit or prediction of a record, the "
          "measured columns of a data block against time\n");
  for (KeywordRow const& row : keywords())
    if (row.word == word) add_rows(entry_of(row));
  for (ListRow const& topic : lists()) add_rows(from_list(topic, word));
  if (auto const page = module_page(word)) add(filled(*page, columns));
  if (text.empty())
    if (auto const section = explain(word)) add(filled(*section, columns));
  return text.empty() ? std::nullopt : std::optional(text);
}

std::string help_overview(int columns) {
  std::string const first =
      "Statements of the language, as in a file: a model, a data block, a task; a task is run when it is entered. Statements of "
      "a\nmodel or data block, `parameter k [N/m] ~ normal(1e4, sd = 100)` or an equation, change the one that was entered last. "
      "Lines\ncontinue while a brace or bracket is open. Expressions use results: mean(k), quantile(fn, 0.95), "
      "plot(trace(k)),\ncorr(k, k3), rms(residual(output)).\n\n";
  std::string rows;
  std::size_t width = 0;
  for (CommandRow const& row : commands()) width = std::max(width, row.usage.size());
  for (CommandRow const& row : commands()) rows += fmt::format("  {:<{}}  {}\n", row.usage, width, row.summary);
  std::string const last =
      "\n`help WORD` explains each word of the language and each code of a message: help log_uniform, help fit, help E2103.\n";
  return filled(first, columns) + wrapped_rows(rows, columns) + filled(last, columns);
}

std::vector<std::string> const& words_with_help() {
  static std::vector<std::string> const all = [] {
    std::vector<std::string> words = {"plot", "trace", "histogram"};
    for (CommandRow const& row : commands()) words.emplace_back(row.name);
    for (PromptFunction const& row : prompt_functions()) words.emplace_back(row.name);
    for (KeywordRow const& row : keywords()) words.emplace_back(row.word);
    for (ListRow const& topic : lists()) add_words(topic, words);
    std::sort(words.begin(), words.end());
    words.erase(std::unique(words.begin(), words.end()), words.end());
    return words;
  }();
  return all;
}

}  // namespace sysid::repl
