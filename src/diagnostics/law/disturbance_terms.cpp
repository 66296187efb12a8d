// Regressions of a smoothed disturbance on functions of smoothed states, and the words for the term that explains most.
#include "diagnostics/law/disturbance_terms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/numeric/elementary.hpp"
#include "core/text/number.hpp"
#include "diagnostics/law/noise_words.hpp"
#include "diagnostics/law/round_number.hpp"

namespace sysid {
namespace {

// 46 right records reach 0.2 and 3.9, with white and coloured disturbances; of 32 with a missing term 30 reach 0.42 and 7.
constexpr double least_share = 0.2, least_standard_errors = 6;
constexpr double least_independent = 20;  // a state that drifts through the record once looks like many functions of time
constexpr std::size_t least_samples = 50, longest_lag = 1000;
constexpr std::size_t edge = 3;          // samples at either end, of which the record says less
constexpr std::size_t most_crossed = 6;  // states whose products are tried

double dot(std::span<double const> a, std::span<double const> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// Orthonormal columns with the span of others.
class Basis {
 public:
  explicit Basis(std::span<std::vector<double> const> columns) {
    for (std::vector<double> const& column : columns) {
      auto rest = without(column);
      if (!rest) continue;
      double const length = std::sqrt(dot(*rest, *rest));
      for (double& each : *rest) each /= length;
      columns_.push_back(std::move(*rest));
    }
  }

  /// Nothing is left of a combination of the columns.
  std::optional<std::vector<double>> without(std::span<double const> column) const {
    constexpr double rounding = 1e-8;
    std::vector<double> rest(column.begin(), column.end());
    for (int pass = 0; pass < 2; ++pass)
      for (std::vector<double> const& each : columns_) {
        double const part = dot(each, rest);
        for (std::size_t i = 0; i < rest.size(); ++i) rest[i] -= part * each[i];
      }
    return dot(rest, rest) > rounding * dot(column, column) ? std::optional(rest) : std::nullopt;
  }

 private:
  std::vector<std::vector<double>> columns_;
};

/// c_0 + 2 (c_1 + c_2 + ...) up to the first pair of lags whose sum is not positive; c_0 at least.
double sum_of_lags(std::size_t n, std::function<double(std::size_t lag)> const& c) {
  std::size_t const lags = std::min(n / 3, longest_lag);
  double const at_once = c(0);
  double sum = -at_once;
  for (std::size_t lag = 0; lag + 1 < lags; lag += 2) {
    double const pair = c(lag) + c(lag + 1);
    if (!(pair > 0)) break;
    sum += 2 * pair;
  }
  return std::max(sum, at_once);
}

double autocovariance(std::span<double const> values, std::size_t lag) {
  return dot(values.first(values.size() - lag), values.subspan(lag));
}

double variance_of_product(std::span<double const> rest, std::span<double const> term) {
  return sum_of_lags(rest.size(), [&](std::size_t lag) {
    return autocovariance(rest, lag) * autocovariance(term, lag) / static_cast<double>(rest.size());
  });
}

double independent_values(std::span<double const> term) {
  auto const n = static_cast<double>(term.size());
  return n * autocovariance(term, 0) / sum_of_lags(term.size(), [&](std::size_t lag) { return autocovariance(term, lag); });
}

/// A function of states with its text, and the states that it is a product of.
struct Term {
  std::string text;
  std::vector<std::size_t> factors;  // indices of states; of a sign none
  std::vector<double> values;
};

/// What was smoothed, one experiment behind the other: no part of it is in another unit than in the report.
struct Smoothed {
  std::vector<std::size_t> states;           // of the model
  std::vector<std::vector<double>> columns;  // of these states
  std::vector<double> disturbance;
  double variance = 0;  // of the disturbance around its smoothed values, sum over the samples
  // Smoothing makes w of the state x that it moves, w = dx/dt - f(x): of a disturbance that is hardly seen, x itself explains up to
  // half in a right model.
  bool is_well_seen() const { return dot(disturbance, disturbance) > variance; }
};

PredictedQuantity const* quantity_named(Prediction const& of, std::string const& name, bool average) {
  auto const found = std::ranges::find_if(
      of.quantities, [&](PredictedQuantity const& each) { return each.name == name && each.average == average; });
  return found == of.quantities.end() ? nullptr : &*found;
}

bool is_memory(Model const& model, std::size_t state) {
  return std::ranges::any_of(model.disturbances, [&](Disturbance const& each) { return each.state == static_cast<int>(state); });
}

/// A parameter that wanders, k' = w: whatever moves it is a function of where it is, as long as it passes there once.
bool is_moved_by_disturbances_alone(Model const& model, std::size_t state) {
  return !model.graph.depends(model.states[state].derivative, [](Node const& node) {
    return node.operation == Operation::leaf &&
           (node.leaf_kind == LeafKind::state || node.leaf_kind == LeafKind::input || node.leaf_kind == LeafKind::unknown);
  });
}

Smoothed smoothed(Model const& model, Disturbance const& disturbance, std::span<Prediction const> states) {
  Smoothed all;
  for (std::size_t s = 0; s < model.states.size(); ++s)
    if (!is_memory(model, s) && !is_moved_by_disturbances_alone(model, s) && !states.empty() &&
        quantity_named(states.front(), model.states[s].name, false) != nullptr)
      all.states.push_back(s);
  all.columns.resize(all.states.size());
  for (Prediction const& each : states) {
    PredictedQuantity const* const values = quantity_named(each, disturbance.name, disturbance.state < 0);
    std::vector<PredictedQuantity const*> of;
    for (std::size_t const s : all.states) of.push_back(quantity_named(each, model.states[s].name, false));
    if (values == nullptr || std::ranges::find(of, nullptr) != of.end()) continue;
    for (std::size_t i = edge; i + edge < values->response.mean.size(); ++i) {
      bool known = each.scored[i] != 0 && std::isfinite(values->response.mean[i]);
      for (PredictedQuantity const* state : of) known = known && std::isfinite(state->response.mean[i]);
      if (!known) continue;
      all.disturbance.push_back(values->response.mean[i]);
      if (i < values->response.sd.size()) all.variance += values->response.sd[i] * values->response.sd[i];
      for (std::size_t s = 0; s < of.size(); ++s) all.columns[s].push_back(of[s]->response.mean[i]);
    }
  }
  return all;
}

double root_mean_square(std::span<double const> values) {
  return std::sqrt(dot(values, values) / static_cast<double>(values.size()));
}

/// A constant and the states themselves.
std::vector<Term> linear_terms(Model const& model, Smoothed const& of) {
  std::vector<Term> terms{{"", {}, std::vector<double>(of.disturbance.size(), 1.0)}};
  for (std::size_t s = 0; s < of.states.size(); ++s) terms.push_back({model.states[of.states[s]].name, {s}, of.columns[s]});
  return terms;
}

std::vector<Term> powers(Model const& model, Smoothed const& of) {
  std::vector<Term> terms;
  auto const name = [&](std::size_t s) { return model.states[of.states[s]].name; };
  auto const add = [&](std::string text, std::vector<std::size_t> factors, auto const& function) {
    std::vector<double> values(of.disturbance.size());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = function(i);
    terms.push_back({std::move(text), std::move(factors), std::move(values)});
  };
  std::size_t const count = of.states.size();
  for (std::size_t a = 0; a < count; ++a) {
    std::vector<double> const& x = of.columns[a];
    add(fmt::format("{}^2", name(a)), {a, a}, [&](std::size_t i) { return x[i] * x[i]; });
    add(fmt::format("{}^3", name(a)), {a, a, a}, [&](std::size_t i) { return x[i] * x[i] * x[i]; });
    add(fmt::format("abs({0})*{0}", name(a)), {a, a}, [&](std::size_t i) { return std::abs(x[i]) * x[i]; });
    double const small = 0.1 * root_mean_square(x);
    std::string const unit = model.states[of.states[a]].unit_text();
    if (small > 0)
      add(fmt::format("tanh({}/{})", name(a),
                      unit.empty() ? significant(small, 1) : fmt::format("({} [{}])", significant(small, 1), unit)),
          {}, [&](std::size_t i) { return elementary::tanh(x[i] / small); });
    for (std::size_t b = 0; b < count && count <= most_crossed; ++b) {
      std::vector<double> const& z = of.columns[b];
      if (b > a) add(fmt::format("{}*{}", name(a), name(b)), {a, b}, [&](std::size_t i) { return x[i] * z[i]; });
      if (b != a) add(fmt::format("{}^2*{}", name(a), name(b)), {a, a, b}, [&](std::size_t i) { return x[i] * x[i] * z[i]; });
    }
  }
  return terms;
}

struct Found {
  Term term;
  FollowedTerm followed;
};

bool follows(FollowedTerm const& each) {
  return each.share >= least_share && std::abs(each.standard_errors) >= least_standard_errors &&
         each.independent >= least_independent;
}

/// The one that explains most. A coloured disturbance and the states that it moves are alike by nature as far as they are linear,
/// and its own mean is not 0 over any record that its memory spans.
std::optional<Found> most_followed(Model const& model, Disturbance const& disturbance, Smoothed const& of) {
  std::vector<Term> const linear = linear_terms(model, of);
  std::vector<std::vector<double>> base;
  for (Term const& each : linear) base.push_back(each.values);
  std::optional<Found> best;
  auto const look = [&](Term const& term, std::span<std::vector<double> const> beside) {
    auto const followed = followed_term(of.disturbance, beside, term.values);
    if (followed && follows(*followed) && (!best || followed->share > best->followed.share)) best = Found{term, *followed};
  };
  for (Term const& each : powers(model, of)) look(each, base);
  if (best) return best;
  if (disturbance.state >= 0) return best;
  for (Term const& each : linear)
    if (each.factors.empty() || of.is_well_seen()) look(each, {});
  return best;
}

/// "[N/m^3]" and the coefficient in it; both in SI units, which is what numbers without a unit are in. No unit where one that it
/// is made of is not declared.
struct Sized {
  double value;
  std::string unit;
};

Sized sized(Model const& model, Disturbance const& disturbance, Smoothed const& of, Found const& found) {
  Unit unit = disturbance.unit.value_or(Unit{});
  double value = found.followed.coefficient * unit.scale;
  bool known = disturbance.unit.has_value();
  for (std::size_t const factor : found.term.factors) {
    std::optional<Unit> const& declared = model.states[of.states[factor]].unit;
    known = known && declared.has_value();
    unit = divide(unit, declared.value_or(Unit{}));
    value /= declared.value_or(Unit{}).scale;
  }
  if (!known) return {value, ""};
  std::string const text = format_dimension(unit.dimension);
  return {value, text == "1" ? "-" : text};
}

Finding finding(Model const& model, Disturbance const& disturbance, Smoothed const& of, Found const& found,
                std::function<bool(std::string const& name)> const& taken) {
  auto const [value, unit] = sized(model, disturbance, of, found);
  std::string const name = free_name("extra", taken_names(model, taken)), bracket = unit.empty() ? "" : fmt::format(" [{}]", unit);
  std::string const times = found.term.text.empty() ? "" : "*" + found.term.text;
  std::string const shown = found.term.text.empty() ? fmt::format("the constant {}{}", significant(value, 3), bracket)
                                                    : fmt::format("{}{}{}", significant(value, 3), bracket, times);
  // In a displacement of a linear system the two cannot be told apart.
  std::string const offset = !found.term.text.empty()
                                 ? ""
                                 : "; if a sensor has an offset, it leaves such a constant as well: then add a "
                                   "parameter to what `observe` predicts instead, as in `normal(y + offset, ...)`, "
                                   "and compare the evidence of both";
  return {
      FindingCode::disturbance_follows_states,
      Severity::warning,
      {disturbance.name},
      fmt::format("the smoothed `{}` is correlated with {}, which explains {:.0f} % of its mean square ({} standard errors): the "
                  "equation may lack this term",
                  disturbance.name, shown, 100 * found.followed.share, significant(std::abs(found.followed.standard_errors), 2)),
      fmt::format("add `{0}{1}` beside `{2}` in its equation, with `parameter {0}{3} ~ normal(0, sd = {4})`, and fit "
                  "again; while a term is missing, the disturbance depends on the states, and the other parameters are biased{5}",
                  name, times, disturbance.name, bracket, shortest(round_number_above(3 * std::abs(value))), offset)};
}

}  // namespace

std::optional<FollowedTerm> followed_term(std::span<double const> values, std::span<std::vector<double> const> base,
                                          std::span<double const> term) {
  Basis const basis(base);
  auto const part = basis.without(term);
  auto rest = basis.without(values);
  if (!part || !rest) return std::nullopt;
  double const power = dot(*part, *part);
  FollowedTerm followed;
  followed.coefficient = dot(*part, *rest) / power;
  followed.share = followed.coefficient * followed.coefficient * power / dot(values, values);
  for (std::size_t i = 0; i < rest->size(); ++i) (*rest)[i] -= followed.coefficient * (*part)[i];
  // Of a constant it is the other part that has independent values.
  bool const is_constant = std::ranges::all_of(term, [&](double each) { return each == term.front(); });
  followed.independent = independent_values(is_constant ? *rest : *part);
  followed.standard_errors = followed.coefficient * power / std::sqrt(variance_of_product(*rest, *part));
  return followed;
}

std::string without_disturbance_terms(Model const& model, std::span<Prediction const> states) {
  if (model.disturbances.empty()) return "the model has no disturbance";
  if (model.dynamics == Dynamics::discrete) return "in discrete time the states that a disturbance could follow are not smoothed";
  return states.empty() ? "the states were not smoothed" : "";
}

Findings check_disturbance_terms(Model const& model, std::span<Prediction const> states,
                                 std::function<bool(std::string const& name)> const& taken) {
  Findings findings;
  for (Disturbance const& disturbance : model.disturbances) {
    Smoothed const of = smoothed(model, disturbance, states);
    if (of.disturbance.size() < least_samples) continue;
    if (auto const found = most_followed(model, disturbance, of))
      findings.push_back(finding(model, disturbance, of, *found, taken));
  }
  return findings;
}

}  // namespace sysid
