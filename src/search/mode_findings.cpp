// What the modes of a search say about its result.
#include "search/mode_findings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/numeric/statistics.hpp"
#include "core/text/number.hpp"
#include "core/text/without_index.hpp"
#include "core/text/words.hpp"
#include "search/laplace.hpp"
#include "search/objective.hpp"

namespace sysid {
namespace {

std::string describe(Target const& target, Mode const& mode) {
  std::string text;
  auto const parameters = target.parameters();
  for (std::size_t p = 0; p < parameters.size() && p < 6; ++p)
    text += fmt::format("{}{} = {:.4g}", p == 0 ? "" : ", ", parameters[p].name, mode.declared[p]);
  return parameters.size() > 6 ? text + ", ..." : text;
}

// Whether a parameter is known to a twentieth of the range of its prior, over decades in logarithms. Near a bound the unconstrained
// coordinate is flat, which the parameter is not.
bool is_known(ParameterInfo const& parameter, double value, double sd) {
  constexpr double part = 0.05;
  if (!std::isfinite(parameter.lower) || !std::isfinite(parameter.upper)) return false;
  if (parameter.lower > 0 && parameter.upper >= 10 * parameter.lower)
    return sd / value < part * elementary::log(parameter.upper / parameter.lower);
  return sd < part * (parameter.upper - parameter.lower);
}

// move [P]: of declared parameters. Nothing where all that take part are known.
std::optional<Finding> flat_direction(Target const& target, Mode const& mode, std::span<double const> move) {
  std::vector<std::string> names, moves;
  bool known = true;
  for (std::size_t p = 0; p < move.size(); ++p) {
    ParameterInfo const& parameter = target.parameters()[p];
    if (move[p] == 0) continue;
    known = known && is_known(parameter, mode.declared[p], mode.sd[p]);
    if (parameter.coefficient) {  // an unknown function stands for all its coefficients
      std::string const function = without_index(parameter.name);
      if (std::find(names.begin(), names.end(), function) == names.end()) names.push_back(function);
      continue;
    }
    names.push_back(parameter.name);
    moves.push_back(fmt::format("{} by {:+.2g}{}", parameter.name, move[p], unit_after_number(parameter.unit)));
  }
  if (known) return std::nullopt;
  if (names.size() == 1)
    return Finding{FindingCode::flat_direction, Severity::warning, names,
                   fmt::format("the data do not determine {}: its posterior is as wide as its prior", names.front()),
                   "fix it to a value, give it a narrower prior, or measure something that depends on it"};
  if (moves.empty())
    return Finding{
        FindingCode::flat_direction, Severity::warning, names,
        fmt::format("the data do not determine a combination of {}: its posterior is as wide as the prior", listed(names)),
        "fix an amplitude or a length, or measure a quantity that distinguishes the functions"};
  return Finding{FindingCode::flat_direction, Severity::warning, names,
                 fmt::format("the data do not determine a combination of {}: moving {} together leaves the fit nearly unchanged, "
                             "and along this combination the posterior is as wide as the prior",
                             listed(names), listed(moves)),
                 "fix one of them, give them narrower priors, or measure a quantity that distinguishes them"};
}

/// Nats below the best: a likelihood has no mass to share.
Finding second_optimum(Target const& target, std::vector<Mode> const& modes, std::size_t count) {
  double const below = modes.front().log_density - modes[1].log_density;
  return {FindingCode::second_mode,
          Severity::warning,
          {},
          fmt::format("{} nearly the same likelihood{} (log likelihood lower by {}): {}",
                      count == 1 ? "a second optimum has" : fmt::format("{} further optima have", count),
                      count == 1 ? "" : ", the best of them",
                      below < 0.005 ? std::string("less than 0.01") : fmt::format("{:.2g}", below), describe(target, modes[1])),
          "compare both solutions: add data that distinguish them, narrow the priors to the one that is possible, or use mh, which "
          "describes the whole posterior"};
}

bool is_notable(Mode const& mode) { return mode.share > notable_share; }

/// One finding, however many there are: they call for one thing.
std::optional<Finding> other_modes(Target const& target, std::vector<Mode> const& modes) {
  constexpr std::size_t most_listed = 4, many = 24;
  std::vector<std::string> shares;
  Mode const* largest = nullptr;
  for (std::size_t i = 1; i < modes.size(); ++i) {
    if (!is_notable(modes[i])) continue;
    if (largest == nullptr || modes[i].share > largest->share) largest = &modes[i];
    shares.push_back(fmt::format("{:.0f}", 100 * modes[i].share));
  }
  if (shares.empty()) return std::nullopt;
  std::size_t const count = shares.size();
  if (count > most_listed) shares = {shares.begin(), shares.begin() + most_listed};
  std::string const place = describe(target, *largest);
  return Finding{
      FindingCode::second_mode,
      Severity::warning,
      {},
      count == 1 ? fmt::format("a second mode has about {} % of the posterior mass: {}", shares.front(), place)
                 : fmt::format("{} further modes have about {}{} % of the posterior mass, the largest at {}{}", count,
                               fmt::join(shares, ", "), count > most_listed ? ", ..." : "", place,
                               count > many ? "; where there are so many, others may not have been found" : ""),
      "compare the solutions: add data or prior knowledge that distinguishes them, or run more chains and report them all"};
}

/// Whether the likelihood falls far at all of the prior's 16, 50 and 84 % points of parameter p, the others as they are. At a bound
/// the coordinate is flat for as long as one likes, though the data hold the parameter there.
bool is_held(Target const& target, Mode const& mode, std::size_t p) {
  constexpr double far = 4.5;  // three sds
  std::vector<double> values;
  LaneArray draws(target.dimension(), 2048);
  target.sample_prior({0, Purpose::start, 0, 0}, draws);
  for (double const value : draws.row(static_cast<int>(p))) values.push_back(value);
  std::sort(values.begin(), values.end());
  std::vector<Eigen::VectorXd> points(4, theta_of(mode));
  for (int k = 0; k < 3; ++k)
    points[static_cast<std::size_t>(k) + 1](static_cast<Eigen::Index>(p)) =
        sorted_quantile(values, std::array{0.16, 0.5, 0.84}[static_cast<std::size_t>(k)]);
  std::vector<double> reached(points.size());
  Ledger none;
  target.log_likelihood(to_lanes(points), reached, none);
  return std::all_of(reached.begin() + 1, reached.end(), [&](double each) { return each < reached.front() - far; });
}

}  // namespace

Findings mode_findings(Target const& target, ObjectiveKind objective_kind, std::vector<Mode> const& modes) {
  Findings findings;
  if (objective_kind == ObjectiveKind::likelihood) {
    auto const others = static_cast<std::size_t>(std::count_if(modes.begin() + 1, modes.end(), is_notable));
    if (others > 0) findings.push_back(second_optimum(target, modes, others));
  } else if (auto others = other_modes(target, modes)) {
    findings.push_back(std::move(*others));
  }
  auto const parameters = static_cast<std::size_t>(target.dimension());
  std::vector<std::vector<std::string>> told;
  for (std::size_t at = 0; at < modes.front().flat.size(); at += parameters) {
    std::span<double const> const move(modes.front().flat.data() + at, parameters);
    auto finding = flat_direction(target, modes.front(), move);
    // What concerns the same parameters is one thing to do something about, however many directions there are.
    if (!finding || std::find(told.begin(), told.end(), finding->names) != told.end()) continue;
    auto const moved = std::find_if(move.begin(), move.end(), [](double each) { return each != 0; });
    bool const alone = std::count(move.begin(), move.end(), 0.0) + 1 == static_cast<std::ptrdiff_t>(parameters);
    if (alone && is_held(target, modes.front(), static_cast<std::size_t>(moved - move.begin()))) continue;
    told.push_back(finding->names);
    findings.push_back(std::move(*finding));
  }
  return findings;
}

void remove_mode_findings(Findings& findings) {
  std::erase_if(findings, [](Finding const& each) {
    return each.code == FindingCode::second_mode || each.code == FindingCode::flat_direction;
  });
}

double highest(std::vector<Mode> const& modes) {
  double most = -infinity;
  for (Mode const& mode : modes) most = std::max(most, mode.log_density);
  return most;
}

}  // namespace sysid
