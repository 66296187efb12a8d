// Sums of exponentials, and errors to first order.
#include "app/comparison/compared_evidence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "core/numeric/elementary.hpp"
#include "core/numeric/hypotenuse.hpp"
#include "core/text/words.hpp"

namespace sysid {
namespace {

using json = nlohmann::json;

constexpr double ruled_out = 10;  // nats below the best with every width that is tried

/// Whether the evidence of the first is the better known one: confirmed, then with an error, then with the smaller.
bool better_known(ComparedFit const& one, ComparedFit const& other) {
  if (one.not_confirmed.empty() != other.not_confirmed.empty()) return one.not_confirmed.empty();
  if (one.error.has_value() != other.error.has_value()) return one.error.has_value();
  return one.error.value_or(0) < other.error.value_or(0);
}

/// Places in `fits` of those that stand for a model, the best model first.
std::vector<std::size_t> standing(std::vector<std::string> const& models, std::vector<ComparedFit> const& fits) {
  std::vector<std::size_t> places;
  for (std::size_t f = 0; f < fits.size(); ++f) {
    if (!fits[f].log_evidence) continue;
    auto const known = std::find_if(places.begin(), places.end(), [&](std::size_t place) { return models[place] == models[f]; });
    if (known == places.end())
      places.push_back(f);
    else if (better_known(fits[f], fits[*known]))
      *known = f;
  }
  std::stable_sort(places.begin(), places.end(),
                   [&](std::size_t a, std::size_t b) { return *fits[a].log_evidence > *fits[b].log_evidence; });
  return places;
}

/// What one fit's log evidence changes by.
struct Widths {
  std::vector<double> factors;
  std::map<std::string, std::vector<std::optional<double>>> change;  // by parameter; "": all

  explicit Widths(json const& evidence) {
    json const stored = evidence.value("prior_widths", json::object());
    factors = stored.value("factors", std::vector<double>());
    auto const add = [&](std::string const& name, json const& entry) {
      for (json const& each : entry.at("change"))
        change[name].push_back(each.is_number() ? std::optional(each.get<double>()) : std::nullopt);
    };
    json const parameters = stored.value("parameters", json::object());
    for (auto const& [name, entry] : parameters.items()) add(name, entry);
    if (stored.contains("all")) add("", stored.at("all"));
    if (change.size() == 1) change[""] = change.begin()->second;
  }
  /// 0 for a parameter that the model has not.
  std::optional<double> at(std::string const& name, double factor) const {
    auto const entry = change.find(name);
    auto const place = static_cast<std::size_t>(std::find(factors.begin(), factors.end(), factor) - factors.begin());
    if (entry == change.end()) return 0;
    return place < entry->second.size() ? entry->second[place] : std::nullopt;
  }
};

/// Never "-0.0".
double to_tenth(double value) { return std::round(10 * value) / 10 + 0.0; }

constexpr double visible = 0.05;  // in the one decimal that is shown

/// A log Bayes factor over half and twice the widths.
struct Range {
  double low = 0, high = 0;
  double most = 0;      // what a single parameter changes
  std::string by = {};  // which
  std::vector<std::string> unknown = {};
  bool all = true;     // whether that of all together is known
  bool known = false;  // any
};

Range range_of(double log_bayes_factor, Widths const& of, Widths const& best) {
  Range range{log_bayes_factor, log_bayes_factor};
  std::set<std::string> names;
  for (Widths const* each : {&of, &best})
    for (auto const& [name, change] : each->change) names.insert(name);
  for (std::string const& name : names) {
    std::vector<double> changes;
    for (double const factor : {0.5, 2.0})
      if (auto const mine = of.at(name, factor), other = best.at(name, factor); mine && other) changes.push_back(*mine - *other);
    if (changes.size() < 2) {  // half of what a prior does is not what it does
      if (name.empty())
        range.all = false;
      else
        range.unknown.push_back(name);
      continue;
    }
    range.known = true;
    for (double const change : changes) {
      range.low = std::min(range.low, log_bayes_factor + change);
      range.high = std::max(range.high, log_bayes_factor + change);
      if (!name.empty() && std::fabs(change) > range.most) range.most = std::fabs(change), range.by = name;
    }
  }
  return range;
}

}  // namespace

void weigh_models(std::vector<std::string> const& models, std::vector<ComparedFit>& fits) {
  std::vector<std::size_t> const places = standing(models, fits);
  if (places.empty()) return;
  // One model with an evidence among others without has nothing to be more probable than.
  std::string const& first = models[places.front()];
  if (places.size() == 1 && std::any_of(models.begin(), models.end(), [&](std::string const& each) { return each != first; }))
    return;
  ComparedFit const best = fits[places.front()];
  double sum = 0, square = 0;  // square: of P_j s_j
  bool known = true;           // all s_j
  std::map<std::string, std::size_t> standing_for;
  for (std::size_t const p : places) sum += elementary::exp(*fits[p].log_evidence - *best.log_evidence);
  for (std::size_t const p : places) {
    standing_for[models[p]] = p;
    known = known && fits[p].error;
    double const part = elementary::exp(*fits[p].log_evidence - *best.log_evidence) / sum * fits[p].error.value_or(0);
    square += part * part;
  }
  std::vector<ComparedFit> const stored = fits;
  for (std::size_t f = 0; f < fits.size(); ++f) {
    ComparedFit& fit = fits[f];
    if (!fit.log_evidence) continue;
    ComparedFit const& one = stored[standing_for.at(models[f])];
    double const share = elementary::exp(*one.log_evidence - *best.log_evidence) / sum, error = one.error.value_or(0);
    double const others = std::max(0.0, square - share * share * error * error);
    fit.probability = share;
    if (known) fit.probability_error = share * std::sqrt((1 - share) * (1 - share) * error * error + others);
    fit.log_bayes_factor = *one.log_evidence - *best.log_evidence;
    if (standing_for.at(models[f]) != f) fit.counted = one.name;
    if (standing_for.at(models[f]) == places.front()) continue;
    if (one.error && best.error) fit.bayes_factor_error = hypotenuse(error, *best.error);
    fit.strength = evidence_strength(*fit.log_bayes_factor);
  }
}

std::vector<std::string> disagreements(std::vector<std::string> const& models, std::vector<ComparedFit> const& fits) {
  std::vector<std::string> notes;
  for (std::size_t const place : standing(models, fits))
    for (std::size_t f = 0; f < fits.size(); ++f) {
      if (f == place || models[f] != models[place] || !fits[f].log_evidence) continue;
      double const chance = 3 * hypotenuse(fits[f].error.value_or(0), fits[place].error.value_or(0)) + 0.2;
      if (std::fabs(*fits[f].log_evidence - *fits[place].log_evidence) > chance)
        notes.push_back(fmt::format("{} and {} are fits of one model, but their evidences differ by {:.1f}: that of {} is used",
                                    fits[f].name, fits[place].name, std::fabs(*fits[f].log_evidence - *fits[place].log_evidence),
                                    fits[place].name));
    }
  return notes;
}

std::string evidence_strength(double log_bayes_factor) {
  double const size = std::fabs(log_bayes_factor);
  return size < 1 ? "hardly any" : size < 3 ? "positive" : size < 5 ? "strong" : "very strong";
}

std::vector<std::string> prior_width_notes(std::vector<std::string> const& models, std::vector<ComparedFit> const& fits,
                                           std::vector<json> const& evidences) {
  std::vector<std::string> notes;
  std::vector<std::size_t> const places = standing(models, fits);
  for (std::size_t i = 1; i < places.size(); ++i) {
    ComparedFit const &of = fits[places[i]], &best = fits[places.front()];
    double const factor = *of.log_evidence - *best.log_evidence;
    Widths const mine(evidences[places[i]]), other(evidences[places.front()]);
    if (mine.change.empty() || other.change.empty()) continue;
    Range const range = range_of(factor, mine, other);
    if (range.high < -ruled_out) continue;
    std::string const unknown = fmt::format("{} of {}", plural("prior", range.unknown.size()), quoted(range.unknown));
    std::string note = fmt::format("{} against {}: ", of.name, best.name);
    if (range.known) {
      std::string const low = fmt::format("{:.1f}", to_tenth(range.low)), high = fmt::format("{:.1f}", to_tenth(range.high));
      note += fmt::format(
          "the log Bayes factor {} if {} half or twice as wide{}{}",
          low == high ? "stays " + low : fmt::format("lies between {} and {}", low, high),
          range.all ? "one prior or all priors are" : "one prior is",
          range.by.empty() || range.most < visible ? "" : fmt::format("; the prior of `{}` changes it most", range.by),
          range.unknown.empty() ? "" : fmt::format("; this does not include the {}, whose effect the draws do not show", unknown));
    } else if (!range.unknown.empty())
      note += fmt::format("the draws do not show how the log Bayes factor depends on the {}", unknown);
    else
      continue;
    notes.push_back(std::move(note));
  }
  return notes;
}

}  // namespace sysid
