// Tables, and a comparison without capitals.
#include "syntax/foreign_words.hpp"

#include <algorithm>

#include "core/text/words.hpp"

namespace sysid::words {
namespace {

constexpr ForeignWord for_model_statements[] = {
    {"var", "let"},
    {"def", "let"},
    {"local", "let"},
    {"auto", "let"},
    {"set", "let"},
    {"define", "let"},
    {"real", "let"},
    {"double", "let"},
    {"float", "let"},
    {"int", "let"},
    {"variable", "let"},
    {"val", "let"},
    {"deterministic", "let"},
    {"const", "constant"},
    {"final", "constant"},
    {"param", "parameter"},
    {"params", "parameter"},
    {"parameters", "parameter"},
    {"unknown", "parameter"},
    {"free", "parameter"},
    {"output", "observe"},
    {"outputs", "observe"},
    {"measure", "observe"},
    {"measured", "observe"},
    {"measurement", "observe"},
    {"observed", "observe"},
    {"observation", "observe"},
    {"generated", "derive"},
    {"derived", "derive"},
    {"quantity", "derive"},
    {"init", "initial"},
    {"ic", "initial"},
    {"der", "state"},
    {"variables", "state"},
    {"component", "part"},
    {"noise", "disturbance"},
    {"process", "disturbance"},
    {"process_noise", "disturbance"},
    {"perturbation", "disturbance"},
    {"wiener", "disturbance"},
    {"white", "disturbance"},
    {"disturbances", "disturbance"},
};

constexpr ForeignWord for_data_statements[] = {
    {"csv", "file"},         {"load", "file"},          {"delimiter", "read"},  {"read_csv", "file"},    {"path", "file"},
    {"source", "file"},      {"filename", "file"},      {"table", "file"},      {"sampling", "rate"},    {"fs", "rate"},
    {"sample_rate", "rate"}, {"sampling_rate", "rate"}, {"samplerate", "rate"}, {"frequency", "rate"},   {"dt", "step"},
    {"ts", "step"},          {"sample_time", "step"},   {"timestep", "step"},   {"time_step", "step"},   {"observe", "measure"},
    {"output", "measure"},   {"outputs", "measure"},    {"channel", "measure"}, {"measured", "measure"}, {"observed", "measure"},
    {"u", "input"},          {"inputs", "input"},       {"rows", "split"},      {"train", "split"},      {"test", "split"},
    {"part", "split"},       {"parts", "split"},        {"t", "time"},          {"param", "constant"},   {"parameter", "constant"},
};

constexpr ForeignWord for_items[] = {
    {"import", "use"},       {"include", "use"},
    {"from", "use"},         {"using", "use"},
    {"require", "use"},      {"library", "use"},
    {"load", "use"},         {"dataset", "data"},
    {"experiment", "data"},  {"record", "data"},
    {"class", "model"},      {"system", "model"},
    {"def", "function"},     {"alternatives", "candidates"},
    {"terms", "dictionary"},
};

constexpr ForeignWord for_verbs[] = {
    {"sample", "fit"},       {"estimate", "fit"},  {"optimize", "fit"}, {"optimise", "fit"},   {"infer", "fit"},
    {"identify", "fit"},     {"calibrate", "fit"}, {"train", "fit"},    {"regress", "fit"},    {"mcmc", "fit"},
    {"forecast", "predict"}, {"sim", "simulate"},  {"run", "simulate"}, {"compare", "select"}, {"find", "discover"},
};

constexpr ForeignWord for_input_rules[] = {
    {"zoh", "zero_order"},       {"constant", "zero_order"}, {"previous", "zero_order"},
    {"zero", "zero_order"},      {"step", "zero_order"},     {"piecewise_constant", "zero_order"},
    {"hold", "zero_order"},      {"foh", "linear"},          {"first_order", "linear"},
    {"first", "linear"},         {"interp", "linear"},       {"piecewise_linear", "linear"},
    {"spline", "cubic"},         {"cubic_spline", "cubic"},  {"pchip", "cubic"},
    {"makima", "cubic"},         {"sinc", "band_limited"},   {"bandlimited", "band_limited"},
    {"fourier", "band_limited"},
};

}  // namespace

std::span<ForeignWord const> foreign_model_statements() { return for_model_statements; }
std::span<ForeignWord const> foreign_data_statements() { return for_data_statements; }
std::span<ForeignWord const> foreign_items() { return for_items; }
std::span<ForeignWord const> foreign_verbs() { return for_verbs; }
std::span<ForeignWord const> foreign_input_rules() { return for_input_rules; }

std::string_view translated(std::span<ForeignWord const> table, std::string_view word) {
  for (ForeignWord const& each : table)
    if (std::equal(word.begin(), word.end(), each.foreign.begin(), each.foreign.end(),
                   [](char written, char known) { return in_small_letters(written) == known; }))
      return each.ours;
  return {};
}

std::optional<DerivativeWord> as_derivative(std::string_view name, std::span<std::string const> known, bool brief) {
  struct Pattern {
    std::string_view before, behind;
    int primes;
    bool brief = false;
  };
  constexpr Pattern patterns[] = {{"", "dot", 1},     {"", "_dot", 1},     {"d", "", 1},        {"d", "dt", 1},
                                  {"", "ddot", 2},    {"", "_ddot", 2},    {"d2", "", 2},       {"d2", "dt2", 2},
                                  {"", "dotdot", 2},  {"", "_dotdot", 2},  {"", "prime", 1},    {"", "_prime", 1},
                                  {"", "d", 1, true}, {"", "dd", 2, true}, {"", "_d", 1, true}, {"", "_dd", 2, true},
                                  {"", "p", 1, true}, {"", "pp", 2, true}, {"", "_t", 1, true}, {"", "_tt", 2, true}};
  for (std::string const& each : known)
    for (Pattern const& pattern : patterns)
      if ((brief || !pattern.brief) && !each.empty() &&
          name.size() == pattern.before.size() + each.size() + pattern.behind.size() && name.starts_with(pattern.before) &&
          name.ends_with(pattern.behind) && name.substr(pattern.before.size()).starts_with(each))
        return DerivativeWord{each, pattern.primes};
  return std::nullopt;
}

}  // namespace sysid::words
