// Sentences with numbers in them. The bars are those of the checks, which alone decide the verdict.
#include "report/page/html_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <functional>
#include <tuple>
#include <vector>

#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "diagnostics/chain_checks.hpp"
#include "diagnostics/prior_checks.hpp"
#include "diagnostics/residuals/residual_tests.hpp"
#include "diagnostics/verdict.hpp"
#include "report/page/verb_words.hpp"

namespace sysid {

namespace {

/// A score on the channel where it is worst.
struct Worst {
  double value;
  std::string where;        // " (force on wave_06)"; empty where there is one line alone
  std::size_t samples = 0;  // of it; 0: not known
  bool counts = false;      // whether all of these are whole numbers
};

std::string number(double value, int digits = 3) { return pretty_number(significant(value, digits)); }

/// Scored samples of a line: of a channel those that were measured.
std::vector<double> samples_of(Report const& report, FitLine const& line) {
  std::vector<double> samples;
  for (Prediction const& prediction : report.predictions)
    for (PredictedQuantity const& quantity : prediction.quantities)
      if (prediction.experiment == line.experiment && quantity.name == line.channel)
        for (std::size_t i = 0; i < quantity.measured.size(); ++i)
          if (prediction.scored[i] != 0 && !std::isnan(quantity.measured[i])) samples.push_back(quantity.measured[i]);
  return samples;
}

bool all_whole(std::vector<double> const& samples) {
  return !samples.empty() && std::all_of(samples.begin(), samples.end(), [](double value) { return value == std::round(value); });
}

std::optional<Worst> worst(Report const& report, std::vector<FitLine> const& lines, ScoreName const& name,
                           std::function<double(Worst const&)> const& badness) {
  std::optional<Worst> out;
  for (FitLine const& line : lines)
    for (Score const& score : line.scores) {
      if (score.name != name || !std::isfinite(score.value)) continue;
      std::vector<double> const samples = samples_of(report, line);
      Worst here{score.value, lines.size() > 1 ? fmt::format(" ({})", line.what()) : "", samples.size(), all_whole(samples)};
      if (!out || badness(here) > badness(*out)) out = std::move(here);
    }
  return out;
}

std::string error_words(Worst const& nmse) {
  std::string out = fmt::format("{} % of the measured variance is not explained{}: ", number(nmse.value), nmse.where);
  if (nmse.value >= 100) return out + "no better than a constant equal to the mean.";
  if (nmse.value >= 5) return out + "the model misses a visible part; see the residuals.";
  if (nmse.value >= 1) return out + "a fair fit; the residuals show whether the rest is noise or structure.";
  return out + "model and measurement can hardly be distinguished by eye.";
}

/// The probability of a share as far off on the same side. Of samples that nobody has counted: 0.
double chance_of(Worst const& share, double expected) {
  if (share.samples == 0) return 0;
  auto const inside = static_cast<std::size_t>(std::llround(share.value * static_cast<double>(share.samples)));
  boost::math::binomial_distribution<double> const counts(static_cast<double>(share.samples), expected);
  return share.value > expected ? cdf(complement(counts, static_cast<double>(inside) - 1))
                                : cdf(counts, static_cast<double>(inside));
}

/// Three of four samples inside say less than 900 of 1000.
double badness_of_coverage(Worst const& share, double expected) {
  return -std::log(std::max(chance_of(share, expected), 1e-300)) + std::fabs(share.value - expected);
}

std::string coverage_words(Worst const& coverage, double expected) {
  // Five in a hundred may be missing where 95 % are expected, one in a hundred where 99.7 % are: chance goes by the root.
  double const off = coverage.value - expected, short_of = std::sqrt(0.05 * (1 - expected));
  bool const by_chance = chance_of(coverage, expected) >= 0.01;
  // The narrowest band of counts that holds 95 % holds more.
  bool const wide = off > 0.035 && !by_chance && !coverage.counts, narrow = off < -short_of && !by_chance;
  return fmt::format("{} % of the scored samples lie inside{}, {}{} % are expected: {}.", number(100 * coverage.value),
                     coverage.where, coverage.counts ? "at least " : "", number(100 * expected),
                     narrow ? "the bands are too narrow for these data"
                     : wide ? "the bands are too wide for these data"
                            : "the width of the bands is consistent with the data");
}

/// Three sds hold 99.7 % of a normal noise; counts and noise with long tails have fewer there, whatever their bands.
std::string three_sd_words(Worst const& coverage, double expected) {
  return fmt::format("{} % of the scored samples lie within three sds{}; of normal noise, {} % are expected.",
                     number(100 * coverage.value), coverage.where, number(100 * expected));
}

/// The check knows how much of it is chance. fitted: the noise is a parameter, which takes the size that the residuals leave.
std::string size_words(Worst const& size, bool found, bool fitted) {
  return fmt::format("The mean square of the residuals is {} times that of the model's noise{}: {}.", number(size.value),
                     size.where,
                     !found && fitted ? "the size of the noise was fitted to the residuals, so this does not test the model"
                     : !found         ? "the noise explains them"
                     : size.value > 1 ? "the noise is larger than in the model, or the model misses part of the response"
                                      : "the noise is smaller than in the model");
}

std::string chance_words(Worst const& p, std::string_view pattern, std::string_view none) {
  return fmt::format("p {}{}: {}.", p.value < 1e-4 ? "below 0.0001" : "= " + number(p.value, 2), p.where,
                     p.value < rare ? pattern : none);
}

bool has_chains(Report const& report) { return report.draws.total() > 1 && !report.summary.empty(); }

struct Extreme {
  double value;
  std::string name;
};

std::optional<Extreme> extreme(Report const& report, std::function<double(Summary const&)> const& of, bool largest) {
  std::optional<Extreme> out;
  for (Summary const& summary : report.summary) {
    double const value = of(summary);
    if (!std::isfinite(value)) continue;
    if (!out || (largest ? value > out->value : value < out->value)) out = {value, summary.name};
  }
  return out;
}

}  // namespace

std::string verdict_words(Report const& report) {
  if (!report.discovery || !has_verdict(report)) return verdict_headline(report);
  std::string missing;
  for (DiscoveredEquation const& each : report.discovery->equations)
    if (each.equation.empty()) missing += fmt::format("{}`{}`", missing.empty() ? "no equation found for " : ", ", each.target);
  return missing + (missing.empty() ? "" : "; ") + verdict_of(report.findings).headline;
}

namespace {

std::string calibration_meaning(Report const& report) {
  switch (grade(report)) {
    case Severity::error:
      return "Until this is fixed, do not rely on intervals and probabilities of such fits, for records like those simulated "
             "from the priors.";
    case Severity::warning:
      return "Check the points below before you rely on intervals of such fits.";
    default:
      return "Records were simulated with the model itself, with true values from its priors. The intervals of these fits contain "
             "the true values as often as they should, as far as the test can show. This does not prove the model: "
             "a real record does not come from it.";
  }
}

}  // namespace

std::string verdict_meaning(Report const& report) {
  if (!has_verdict(report)) return "";
  if (report.calibration) return calibration_meaning(report);
  if (report.verb == "track" && grade(report) == Severity::warning)
    return std::any_of(report.findings.begin(), report.findings.end(),
                       [](Finding const& each) { return each.code == FindingCode::parameter_changed; })
               ? "The parameters were moved where the rows show a change. The rows do not show its cause: the structure, its "
                 "surroundings or a sensor."
               : "No change of a parameter was found, but check the points below: with them the sds and alarms of the track are "
                 "not as stated.";
  VerbWords const& words = verb_words(report);
  switch (grade(report)) {
    case Severity::error:
      return fmt::format("Until this is fixed, {}. Each point below states what to do.", words.broken);
    case Severity::warning:
      return fmt::format("Check the points below before you use {}: each of them may or may not matter for your purpose.",
                         words.numbers);
    default:
      return std::string(words.sound);
  }
}

std::string score_words(Report const& report, std::vector<FitLine> const& lines, ScoreName const& score) {
  auto const say = [&](std::function<double(Worst const&)> const& badness, auto const& words) {
    auto const found = worst(report, lines, score, badness);
    return found ? words(*found) : std::string();
  };
  auto const high = [](Worst const& each) { return each.value; };
  auto const low = [](Worst const& each) { return -each.value; };
  auto const coverage = [&](double expected, auto const& words) {
    return say([=](Worst const& each) { return badness_of_coverage(each, expected); },
               [&](Worst const& each) { return words(each, expected); });
  };
  switch (score.kind) {
    case ScoreKind::nmse:
    case ScoreKind::nmse_left_out:
      return say(high, error_words);
    case ScoreKind::rmse:
      return "";
    case ScoreKind::coverage_95:
      return coverage(0.95, coverage_words);
    case ScoreKind::coverage_3sd:
      return coverage(0.9973, three_sd_words);
    case ScoreKind::log_score:
      return "mean log predictive density of a sample: higher is better, to be compared on these samples alone";
    case ScoreKind::chi_squared:
      return say([](Worst const& each) { return std::fabs(std::log(std::max(each.value, 1e-300))); },
                 [&](Worst const& each) {
                   bool const found = std::ranges::any_of(
                       report.findings, [](Finding const& finding) { return finding.code == FindingCode::noise_size; });
                   return size_words(each, found, !report.noise.empty());
                 });
    case ScoreKind::whiteness:
      return say(low, [](Worst const& p) {
        return chance_words(p, "the residuals are autocorrelated: dynamics are missing in the model, or the noise is not white",
                            "no autocorrelation of the residuals was found");
      });
    case ScoreKind::input_correlation:
      return say(low, [](Worst const& p) {
        return chance_words(p, "the residuals are correlated with the input: the model misses a part of the response",
                            "no correlation of the residuals with the input was found");
      });
  }
  return "";
}

std::vector<ChainWords> chain_words(Report const& report) {
  std::vector<ChainWords> out;
  if (!has_chains(report)) return out;
  if (auto const rhat = extreme(
          report, [](Summary const& s) { return s.rhat; }, true)) {
    bool const good = rhat->value <= rhat_threshold;
    out.push_back({"R-hat",
                   fmt::format("{:.3f} at most ({}): {} below {}.", rhat->value, rhat->name,
                               good                           ? "the chains agree; the value is"
                               : rhat->value > rhat_far_above ? "the chains disagree; the value should be"
                                                              : "the chains do not fully agree; the value should be",
                               rhat_threshold),
                   good});
  }
  for (auto const& [name, what, of] :
       {std::tuple("bulk ESS", "means", std::function([](Summary const& s) { return s.ess_bulk; })),
        std::tuple("tail ESS", "5 and 95 % quantiles", std::function([](Summary const& s) { return s.ess_tail; }))})
    if (auto const ess = extreme(report, of, false)) {
      bool const good = ess->value >= ess_threshold;
      out.push_back(
          {name,
           fmt::format("{:.0f} at least ({}): the draws are equivalent to this many independent draws for {}, {}.", ess->value,
                       ess->name, what,
                       good ? "which is enough" : fmt::format("which is fewer than the {} that are needed", ess_threshold)),
           good});
    }
  if (auto const error = extreme(
          report, [](Summary const& s) { return s.sd > 0 ? s.mcse_mean / s.sd : std::nan(""); }, true)) {
    // Of as many independent draws as are asked for.
    bool const good = error->value <= 1 / std::sqrt(ess_threshold) + 1e-12;
    out.push_back({"Monte Carlo error",
                   fmt::format("{} % of an sd at most ({}): another seed changes a mean by about this much.",
                               number(100 * error->value, 2), error->name),
                   good});
  }
  double accepted = 0, count = 0;
  for (Chain const& chain : report.draws.chains)
    for (double const each : chain.acceptance)
      if (std::isfinite(each)) accepted += each, ++count;
  if (count > 0) {
    double const rate = accepted / count;
    bool const good = rate >= least_acceptance;
    out.push_back(
        {"acceptance",
         fmt::format("The mean acceptance probability of the moves that led to the kept draws is {} %: {}.", number(100 * rate, 2),
                     !good        ? "the chains hardly moved"
                     : rate < 0.1 ? "low, but the effective sample sizes above decide"
                     : rate > 0.6 ? "high, as is usual for independence moves that fit the posterior, for nuts, and for short "
                                    "steps; the effective sample sizes above decide"
                                  : "in the usual range"),
         good});
  }
  return out;
}

std::string ledger_words(Report const& report) {
  Ledger const& ledger = report.ledger;
  if (ledger.solves() == 0 && ledger.failures().empty()) return "";
  if (ledger.failed() == 0) return fmt::format("{} simulations, none of them failed.", ledger.solves());
  double const share =
      100 * static_cast<double>(ledger.failed()) / static_cast<double>(std::max<std::uint64_t>(ledger.solves(), 1));
  Severity const severity = failure_severity(ledger.failed(), ledger.solves());
  return fmt::format("{} simulations, {} of them failed ({} %). {}: {}", ledger.solves(), ledger.failed(), number(share, 2),
                     verb_words(report).failures,
                     severity == Severity::note ? "so few failures do not affect the result."
                     : severity == Severity::warning
                         ? "check whether the posterior ends where simulations fail."
                         : "with so many failures the limits of the posterior may come from the solver and not from the data.");
}

std::string mode_words(Report const& report) {
  std::size_t const count = report.modes.size();
  std::vector<std::string> places;
  for (Mode const& mode : report.modes) places.push_back(std::to_string(mode.hits));
  bool const counted = std::any_of(report.modes.begin(), report.modes.end(), [](Mode const& each) { return each.hits > 0; });
  std::string out = fmt::format("The search found {}{}. ", count == 1 ? "one mode" : fmt::format("{} modes", count),
                                counted ? fmt::format(", reached by {} of its local searches", listed(places)) : "");
  if (grade(report) == Severity::error) {
    bool const near = std::any_of(report.findings.begin(), report.findings.end(),
                                  [](Finding const& each) { return each.code == FindingCode::searched_near; });
    return out + fmt::format(
                     "A check failed: a better mode may lie outside the searched region. Search again {}with wider "
                     "priors or with another seed.",
                     near ? "everywhere (`search = everywhere`), " : "");
  }
  if (count == 1) return out + "It found no other parameter values that explain the data nearly as well.";
  return out + (report.modes[1].share > 0.01
                    ? "More than one mode has considerable weight: these data alone do not determine the parameters."
                    : "The other modes have almost no weight.");
}

std::string learning_words(Report const& report) {
  if (grade(report) == Severity::error) return "";  // what the chains have not told
  std::string idle;
  int known = 0, more = 0;
  for (Summary const& summary : report.summary) {
    if (summary.coefficient) continue;
    for (PriorInfo const& prior : report.priors) {
      if (prior.name != summary.name) continue;
      auto const ratio = contraction(prior, summary);
      if (!ratio) continue;
      ++known;
      if (*ratio >= hardly_narrower) continue;
      if (++more <= 6) idle += (idle.empty() ? "" : ", ") + summary.name;
    }
  }
  if (known == 0) return "";
  if (more == 0) return "The posterior of every parameter with a prior of its own is narrower than its prior.";
  if (more > 6) idle += fmt::format(" and {} more", more - 6);
  return fmt::format(
      "The data contain little information on {}: the posterior is hardly narrower than the prior, so the choice of the prior "
      "matters.",
      idle);
}

}  // namespace sysid
