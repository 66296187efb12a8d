// Findings about identifiability: named once each, with the number of draws that show them.
#include "app/preflight/check_information.hpp"
#include "core/text/without_index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sysid {
namespace {

constexpr double barely_narrowed = 0.5;
constexpr double informed = 0.5;  // sd of a logarithm, a factor of 1.6: a prior narrower than this is knowledge, meant to be kept
constexpr double strong_correlation = 0.99;
constexpr double still_unknown = 0.25;  // of the prior's sd: what a confounded pair may keep before it is worth a warning

class Description {
 public:
  Description(std::vector<AssessedParameter> const& coordinates, std::vector<LocalSlopes> const& locals,
              std::string const& channels, bool driven, PreflightPage& page)
      : coordinates_(coordinates), locals_(locals), channels_(channels), driven_(driven), page_(page) {
    for (AssessedParameter const& each : coordinates)
      if (each.role == ParameterRole::response) {
        asked_.push_back(each.words);
        standardised_.push_back(each.standardised);
        if (!each.coefficient) named_ = asked_.size();
      }
    null_.assign(asked_.size(), false);
    for (LocalSlopes const& local : locals) expectations_.push_back(expect(local));
  }

  void fill() {
    name_null_directions();
    std::size_t i = 0;
    for (AssessedParameter const& coordinate : coordinates_) {
      if (coordinate.coefficient) {
        count_coefficient(coordinate.words.name);
        continue;
      }
      InformationPage::Line line{coordinate.words.name, coordinate.words.unit, coordinate.relative, 0, 0, 0, {}};
      line.prior_width = coordinate.relative ? coordinate.spread : coordinate.spread / coordinate.words.scale;
      if (coordinate.role == ParameterRole::response)
        expect_knowledge(i++, line);
      else
        line.instead = unasked(coordinate);
      page_.information->lines.push_back(std::move(line));
    }
    for (std::size_t a = 0; a < named_; ++a)
      for (std::size_t b = a + 1; b < named_; ++b)
        if (!null_[a] && !null_[b]) name_correlation(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
  }

 private:
  // Which candidate is probable does not hang on parameters that the data leave open, so a candidate's weigh a step less.
  void add(FindingCode code, Severity severity, std::vector<std::string> names, std::string message, std::string help) {
    if (!page_.candidate.empty()) severity = severity == Severity::error ? Severity::warning : Severity::note;
    page_.findings.push_back({code, severity, std::move(names), std::move(message), std::move(help)});
  }

  // An unknown function is one line, whatever the number of its coefficients.
  void count_coefficient(std::string const& name) {
    std::string const function = without_index(name);
    std::vector<InformationPage::Line>& lines = page_.information->lines;
    coefficients_ = lines.empty() || lines.back().name != function ? 1 : coefficients_ + 1;
    if (coefficients_ == 1) lines.push_back({function, "", false, 1, 0, 0, {}});
    lines.back().instead = fmt::format("an unknown function: {} coefficients", coefficients_);
  }

  // Slopes in all but coefficients, which are free as far as their prior lets them. They stand last, so of a triangular factor the
  // leading block is the factor of the others.
  LocalSlopes without_coefficients(LocalSlopes local) const {
    auto const n = static_cast<Eigen::Index>(named_);
    local.sensitivity.slopes = local.sensitivity.slopes.topLeftCorner(n, n).eval();
    local.sensitivity.error = local.sensitivity.error.head(n).eval();
    local.sensitivity.others = local.sensitivity.others.topRows(std::min(n, local.sensitivity.others.rows())).eval();
    local.value = local.value.head(n).eval();
    local.scale = local.scale.head(n).eval();
    local.spread = local.spread.head(n).eval();
    return local;
  }

  void name_null_directions() {
    std::vector<LocalSlopes> locals;
    for (LocalSlopes const& local : locals_) locals.push_back(without_coefficients(local));
    NullSpace const space = find_null_space(locals);
    for (NullDirection const& direction : space.directions) {
      std::string const text = direction_words(direction, asked_, channels_, driven_);
      if (prior_separates(direction)) {
        page_.information->ridges.push_back(
            fmt::format("{}: only their priors separate them, as is usual in a hierarchy `mean + spread*z`", text));
        continue;
      }
      page_.information->null_directions.push_back(text);
      for (NullDirection::Part const& part : direction.parts) null_[static_cast<std::size_t>(part.parameter)] = true;
      std::vector<std::string> names;
      for (NullDirection::Part const& part : direction.parts)
        names.push_back(asked_[static_cast<std::size_t>(part.parameter)].name);
      add(FindingCode::not_identifiable, Severity::error, std::move(names),
          fmt::format("{} (at {} of {} prior draws)", text, space.draws, space.draws),
          direction.kind == NullDirection::Kind::no_influence
              ? std::string("fix it to a value (`=` in place of `~`)") +
                    (driven_ ? ", measure a quantity that it affects, or use an input that excites the motion on which it acts"
                             : ", or measure a quantity that it affects")
              : "fix one of them to a known value (`=` in place of `~`), or measure a quantity that distinguishes them");
    }
    int const size = static_cast<int>(named_);
    page_.information->rank_low = page_.information->rank_high = size;
    if (space.dimensions.empty()) return;
    auto const [least, most] = std::minmax_element(space.dimensions.begin(), space.dimensions.end());
    page_.information->rank_low = size - *most;
    page_.information->rank_high = size - *least;
  }

  // mean + spread*z of every experiment, z ~ normal(0, 1): the data know the sums alone, and the priors of z how they divide.
  bool prior_separates(NullDirection const& direction) const {
    auto const standardised = [&](NullDirection::Part const& part) {
      return standardised_[static_cast<std::size_t>(part.parameter)];
    };
    return std::any_of(direction.parts.begin(), direction.parts.end(), standardised) &&
           !std::all_of(direction.parts.begin(), direction.parts.end(), standardised);
  }

  // The expected sd of asked parameter i over the draws.
  void expect_knowledge(std::size_t i, InformationPage::Line& line) {
    double least = 1, most = 0;
    for (Expectation const& each : expectations_) {
      least = std::min(least, each.shrinkage(static_cast<Eigen::Index>(i)));
      most = std::max(most, each.shrinkage(static_cast<Eigen::Index>(i)));
    }
    line.low = least * line.prior_width;
    line.high = most * line.prior_width;
    if (null_[i]) line.instead = "not determined";
    bool const vague = !standardised_[i] && (!line.relative || line.prior_width > informed);
    if (!null_[i] && vague && least > barely_narrowed)
      add(FindingCode::barely_narrowed, Severity::warning, {line.name},
          fmt::format("the data are expected to contain little information on {}: expected sd {:.0f} to {:.0f} % of the prior's "
                      "(at {} of {} "
                      "prior draws)",
                      line.name, 100 * least, 100 * most, locals_.size(), locals_.size()),
          "its posterior will be close to its prior: use an informative prior, or fix it to a value");
  }

  std::string unasked(AssessedParameter const& coordinate) {
    if (coordinate.role == ParameterRole::noise) return "not computed (noise)";
    if (coordinate.role == ParameterRole::prior) return "not computed (used in priors only)";
    if (coordinate.role == ParameterRole::none) return "not used";  // the checker has warned of it
    add(FindingCode::not_identifiable, Severity::error, {coordinate.words.name},
        fmt::format("only derived quantities depend on {}: the data contain no information on it", coordinate.words.name),
        "fix it to a value (`=` in place of `~`), or use it in an equation");
    return "used in derived quantities only";
  }

  // A pair of which little but a combination is known: at every draw, or at most of them with the same combination each time.
  void name_correlation(Eigen::Index i, Eigen::Index j) {
    std::vector<double> sizes, slopes;  // at the draws where they are confounded; dp_j / dp_i along the long axis, SI
    double widest = 0;                  // of both, there, in sds of the prior
    for (std::size_t d = 0; d < locals_.size(); ++d) {
      Expectation const& each = expectations_[d];
      double const correlation = each.correlation(i, j);
      if (std::abs(correlation) < strong_correlation) continue;
      auto const sd = [&](Eigen::Index p) { return each.shrinkage(p) * locals_[d].spread(p) * locals_[d].scale(p); };
      sizes.push_back(std::abs(correlation));
      widest = std::max({widest, each.shrinkage(i), each.shrinkage(j)});
      slopes.push_back((correlation > 0 ? 1 : -1) * sd(j) / sd(i));
    }
    if (2 * sizes.size() <= locals_.size()) return;
    auto const [least, most] = std::minmax_element(slopes.begin(), slopes.end());
    double const middle = (*least + *most) / 2;
    bool const same = *most - *least < 0.2 * std::abs(middle);
    if (!same && sizes.size() < locals_.size()) return;
    std::string combination;
    if (same) {
      double slope = middle;
      for (double const simple : {1.0, 2.0, 0.5})
        if (std::abs(std::abs(middle) / simple - 1) < 0.1) slope = middle > 0 ? simple : -simple;
      NullDirection const direction{NullDirection::Kind::sum, {{static_cast<int>(i), 1, 1}, {static_cast<int>(j), slope, slope}}};
      combination = fmt::format("the data determine little more than {}; ", determined_combination(direction, asked_));
    }
    std::string const pair = fmt::format("{} and {} are nearly confounded", asked_[static_cast<std::size_t>(i)].name,
                                         asked_[static_cast<std::size_t>(j)].name);
    std::string const size = fmt::format("expected absolute correlation {:.3f} to {:.4f} (at {} of {} prior draws)",
                                         *std::min_element(sizes.begin(), sizes.end()),
                                         *std::max_element(sizes.begin(), sizes.end()), sizes.size(), locals_.size());
    if (standardised_[static_cast<std::size_t>(i)] != standardised_[static_cast<std::size_t>(j)]) {
      page_.information->ridges.push_back(
          fmt::format("{}, and only their priors separate them, as is usual in a hierarchy `mean + spread*z`: {}", pair, size));
      return;
    }
    if (widest < still_unknown) {
      page_.information->ridges.push_back(
          fmt::format("{}, but both posteriors are expected to be narrower than the priors: {}", pair, size));
      return;
    }
    add(FindingCode::nearly_confounded, Severity::warning,
        {asked_[static_cast<std::size_t>(i)].name, asked_[static_cast<std::size_t>(j)].name},
        fmt::format("{}: {}{}", pair, combination, size),
        "fix one of them, or measure a quantity that distinguishes them; what depends only on their combination is well "
        "determined");
  }

  std::vector<AssessedParameter> const& coordinates_;
  std::vector<LocalSlopes> const& locals_;
  std::string const& channels_;
  bool driven_;
  PreflightPage& page_;
  std::vector<ParameterWords> asked_;  // those that may show in the response
  std::size_t named_ = 0;              // of them, that are no coefficients
  int coefficients_ = 0;               // of the function whose line is the last
  std::vector<bool> null_;             // of them, part of a null direction
  std::vector<bool> standardised_;     // of them
  std::vector<Expectation> expectations_;
};

}  // namespace

void describe_information(std::vector<AssessedParameter> const& coordinates, std::vector<LocalSlopes> const& locals,
                          std::string const& channels, bool driven, PreflightPage& page) {
  Description(coordinates, locals, channels, driven, page).fill();
}

}  // namespace sysid
