// The steps of a discovery, equation by equation.
#include "regression/discovery.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/numeric/elementary.hpp"
#include "regression/choice/triangle.hpp"
#include "regression/column/dependence.hpp"
#include "regression/error_concerns.hpp"
#include "regression/input_rules.hpp"
#include "regression/outside_term.hpp"
#include "regression/residual_concerns.hpp"

namespace sysid::regression {
namespace {

/// Choice and whitening go on until a support repeats; at most this often, should two take turns.
constexpr int most_choices = 5;
/// Steps for coefficients and moving average together, for each choice of terms: until none moves by this part of its sd.
constexpr int most_whitenings = 50;
constexpr double settled_step = 0.02;
/// Residual of all terms, of the target: rounding.
constexpr double exact_below = 1e-10;
/// A term that is needed, and a coefficient that is known: the least probability, and the largest sd as a part of it.
constexpr double settled_probability = 0.99, settled_sd = 0.05;

/// Of windows or samples for a choice among so many terms: more than twice as many; of a large dictionary a quarter more and
/// twenty, which determine the residual of all terms together, since few of them are chosen.
int least_rows(int terms) { return std::min(2 * terms + 1, terms + terms / 4 + 20); }

LinearProblem problem_of(Equation const& equation, Columns const& columns, std::vector<int> const& usable) {
  LinearProblem problem;
  problem.known = columns.known;
  problem.terms.resize(columns.terms.rows(), static_cast<Eigen::Index>(usable.size()));
  for (std::size_t k = 0; k < usable.size(); ++k) {
    problem.terms.col(static_cast<Eigen::Index>(k)) = columns.terms.col(usable[k]);
    problem.always.push_back(equation.terms[static_cast<std::size_t>(usable[k])].always ? 1 : 0);
  }
  return problem;
}

/// Over all terms of the dictionary, 0 where a term is not in the support; support's indices are into `usable`.
Eigen::VectorXd spread(Support const& support, std::vector<int> const& usable, Eigen::Index count) {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(count);
  for (std::size_t k = 0; k < support.terms.size(); ++k)
    all(usable[static_cast<std::size_t>(support.terms[k])]) = support.coefficient(static_cast<Eigen::Index>(k));
  return all;
}

Support renumbered(Support support, std::vector<int> const& usable) {
  for (int& term : support.terms) term = usable[static_cast<std::size_t>(term)];
  return support;
}

std::vector<int> all_of(std::size_t count) {
  std::vector<int> all;
  for (std::size_t k = 0; k < count; ++k) all.push_back(static_cast<int>(k));
  return all;
}

class Finder {
 public:
  Finder(Equation const& equation, Projection const& projection, int index, Method const& method)
      : equation_(equation), projection_(projection), index_(index), method_(method) {}

  FoundEquation find() {
    found_.name = equation_.name;
    for (Term const& term : equation_.terms) found_.terms.push_back({.name = term.name});
    found_.concerns = projection_.concerns(index_);
    if (any_fatal(found_.concerns)) return std::move(found_);
    Columns const& columns = projection_.columns(index_);
    found_.rows = static_cast<int>(columns.known.size());
    // Columns with fewer rows than there are terms always depend on each other, which says nothing of the terms.
    if (found_.rows >= static_cast<int>(equation_.terms.size())) {
      Usable usable = independent_terms(equation_, columns);
      usable_ = std::move(usable.terms);
      found_.concerns.insert(found_.concerns.end(), usable.concerns.begin(), usable.concerns.end());
    }
    if (!enough(columns)) return std::move(found_);
    for (FoundTerm& term : found_.terms) term.excluded = true;
    for (int const term : usable_) found_.terms[static_cast<std::size_t>(term)].excluded = false;
    std::optional<Choice> const choice = choose(columns);
    if (choice) report(columns, *choice);
    return std::move(found_);
  }

 private:
  bool enough(Columns const& columns) {
    Concern concern;
    bool const examined = found_.rows >= static_cast<int>(equation_.terms.size());
    std::size_t const terms = examined ? usable_.size() : equation_.terms.size();
    int const least = least_rows(static_cast<int>(terms));
    if (found_.rows < least) {
      int const half = projection_.half_width();
      concern.kind = Concern::Kind::too_few_rows;
      concern.value = found_.rows;
      concern.clause = found_.rows == 0 && half > 0
                           ? fmt::format("the scored rows are too few for windows of {} samples", 2 * half + 1)
                           : fmt::format("{} {} for {} terms are too few; at least {} are needed", found_.rows,
                                         half > 0 ? "windows" : "samples", terms, least);
    } else if (usable_.empty()) {
      concern.kind = Concern::Kind::nothing_left;
      concern.clause = "no term is left to choose from";
    } else if (!(columns.known.squaredNorm() > 0) || !columns.known.allFinite()) {
      concern.kind = Concern::Kind::nothing_to_explain;
      concern.clause =
          columns.known.allFinite() ? "the target is zero on the whole record" : "the target is not finite at some samples";
    } else {
      return true;
    }
    found_.concerns.push_back(std::move(concern));
    return false;
  }

  /// Nothing, with a concern, where the moving average that is asked for leaves too few rows.
  std::optional<Choice> choose(Columns const& columns) {
    auto const count = static_cast<Eigen::Index>(equation_.terms.size());
    SelectorContext const context{method_.seed, static_cast<std::uint64_t>(index_), method_.interrupted};
    auto const select = [&] {
      return method_.selector->choose(problem_of(equation_, whitened_, usable_), method_.selector_settings, context);
    };
    auto const fitted = [&](Columns const& on) {
      return spread(least_squares(problem_of(equation_, on, usable_), all_of(usable_.size())), usable_, count);
    };
    whitened_ = columns;
    if (NoiseOfEquation const* noise = projection_.noise_of_equation()) return choose_with(*noise, columns, select, fitted);
    if (projection_.reweightings() == 0) return select();
    // First with all terms, whose sum is well determined where single coefficients are not; then with those chosen.
    whitened_ = projection_.whitened(index_, fitted(columns), 0);
    whitened_ = projection_.whitened(index_, fitted(whitened_), 0);
    Choice choice = iterated(select(), select, 0);
    // What the channels' noise leaves over is asked of good coefficients: at poor ones all of the motion looks like an error.
    double const own = projection_.own_noise(index_, weights_);
    if (own > 0) {
      whitened_ = projection_.whitened(index_, weights_, own);
      choice = iterated(select(), select, own);
    }
    found_.own_noise = own * choice.chosen.noise_sd;
    return choice;
  }

  /// With a moving average of each order in turn, as the terms and the average that fit one another depend on where one begins:
  /// terms chosen in white noise hold the average's own expansion, and leave nothing for it. The order with the least
  ///
  ///   n log(squares/n) + log determinant + (k + q) log n + 2 log C(J, k)                    k of J terms; Schwarz 1978
  ///
  /// which counts that the k terms were chosen; no more orders are tried once two have been worse than the best.
  template <class Select, class Fitted>
  std::optional<Choice> choose_with(NoiseOfEquation const& noise, Columns const& columns, Select const& select,
                                    Fitted const& fitted) {
    auto const count = static_cast<Eigen::Index>(equation_.terms.size());
    auto const usable = static_cast<double>(usable_.size());
    Eigen::VectorXd const all_terms = fitted(columns);
    bool const exact = (columns.known - columns.terms * all_terms).norm() < exact_below * columns.known.norm();
    std::optional<Choice> best;
    Columns best_whitened;
    double least = 0;
    int worse = 0;
    for (int const order : noise.orders()) {
      if ((exact && order > 0 && best) || 10 * order > columns.known.size()) break;
      whitened_ = noise.whitened(index_, all_terms, order);
      if (whitened_.known.size() <= whitened_.terms.cols()) break;
      whitened_ = noise.whitened(index_, fitted(whitened_), order);
      Choice choice = select();
      for (int round = 0; round < most_choices && order > 0; ++round) {
        std::vector<int> const before = choice.chosen.terms;
        Eigen::VectorXd weights = spread(choice.chosen, usable_, count);
        Eigen::VectorXd last = choice.chosen.coefficient;
        for (int k = 0; k < most_whitenings; ++k) {
          whitened_ = noise.whitened(index_, weights, order);
          Support const refitted = least_squares(problem_of(equation_, whitened_, usable_), before);
          weights = spread(refitted, usable_, count);
          bool const settled =
              ((refitted.coefficient - last).array().abs() <= settled_step * refitted.covariance.diagonal().array().sqrt()).all();
          last = refitted.coefficient;
          if (settled) break;
        }
        choice = select();
        if (choice.chosen.terms == before) break;
      }
      EquationErrors const left = noise.errors(index_, spread(choice.chosen, usable_, count), order);
      auto const size = static_cast<double>(choice.chosen.terms.size());
      auto const rows = static_cast<double>(left.errors.size());
      double const score =
          rows * elementary::log(std::max(left.squares, std::numeric_limits<double>::min()) / rows) + left.log_determinant +
          (size + order) * elementary::log(rows) +
          2 * (elementary::lgamma(usable + 1) - elementary::lgamma(size + 1) - elementary::lgamma(usable - size + 1));
      if (best && !(score < least)) {
        if (++worse == 2) break;
        continue;
      }
      least = score;
      best = std::move(choice);
      best_whitened = whitened_;
      found_.moving_average = left.average;
      found_.moving_average_sd = left.average_sd;
      found_.own_noise = std::sqrt(left.squares / std::max(1.0, rows - size - order));
      if (!exact) errors_ = left.errors;
      runs_ = left.runs;
    }
    if (!best) {
      Concern concern{.kind = Concern::Kind::too_few_rows, .value = static_cast<double>(found_.rows)};
      concern.clause =
          fmt::format("{} samples are too few for a moving average of order {}: ten for each of its coefficients are needed",
                      found_.rows, noise.orders().front());
      found_.concerns.push_back(std::move(concern));
      return std::nullopt;
    }
    whitened_ = std::move(best_whitened);
    return best;
  }

  /// Choices and whitenings in turns until a support repeats.
  template <class Select>
  Choice iterated(Choice choice, Select const& select, double own) {
    auto const count = static_cast<Eigen::Index>(equation_.terms.size());
    for (int round = 0; round < most_choices; ++round) {
      std::vector<int> const before = choice.chosen.terms;
      weights_ = spread(choice.chosen, usable_, count);
      for (int k = 0; k < projection_.reweightings(); ++k) {
        whitened_ = projection_.whitened(index_, weights_, own);
        weights_ = spread(least_squares(problem_of(equation_, whitened_, usable_), before), usable_, count);
      }
      choice = select();
      if (choice.chosen.terms == before) break;
    }
    return choice;
  }

  void report(Columns const& columns, Choice const& choice) {
    found_.found = true;
    found_.iterations = choice.iterations;
    found_.converged = choice.converged;
    found_.exact = choice.exact;
    found_.chosen = renumbered(choice.chosen, usable_);
    for (Support const& support : choice.supports) found_.supports.push_back(renumbered(support, usable_));
    auto const count = static_cast<Eigen::Index>(equation_.terms.size());
    double const known = columns.known.norm();
    for (std::size_t k = 0; k < usable_.size(); ++k) {
      TermChoice const& from = choice.terms[k];
      FoundTerm& to = found_.terms[static_cast<std::size_t>(usable_[k])];
      to.kept = from.kept;
      to.measure = from.measure;
      to.measure_error = from.measure_error;
      to.precision = from.precision;
      to.dropped_in = from.dropped_in;
      to.mean = from.mean;
      to.mean_sd = from.sd;
    }
    std::vector<double> const inflation = variance_inflation(whitened_, found_.chosen.terms);
    Eigen::VectorXd residual = columns.known, whitened_residual = whitened_.known;
    for (std::size_t k = 0; k < found_.chosen.terms.size(); ++k) {
      auto const i = static_cast<Eigen::Index>(k);
      int const j = found_.chosen.terms[k];
      FoundTerm& term = found_.terms[static_cast<std::size_t>(j)];
      term.coefficient = found_.chosen.coefficient(i);
      term.sd = std::sqrt(found_.chosen.covariance(i, i));
      term.contribution = std::abs(term.coefficient) * columns.terms.col(j).norm() / known;
      term.inflation = inflation[k];
      residual -= term.coefficient * columns.terms.col(j);
      whitened_residual -= term.coefficient * whitened_.terms.col(j);
    }
    found_.explained = 1 - residual.squaredNorm() / (known * known);
    if (choice.joint.size() > 0) {
      found_.joint = Eigen::MatrixXd::Zero(count, count);
      for (std::size_t a = 0; a < usable_.size(); ++a)
        for (std::size_t b = 0; b < usable_.size(); ++b)
          found_.joint(usable_[a], usable_[b]) = choice.joint(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
      add(interchangeable_terms(equation_, found_.joint));
    }
    for (Concern& near : near_dependence(equation_, whitened_, found_.chosen.terms))
      if (std::any_of(near.terms.begin(), near.terms.end(), [&](int j) { return !is_settled(j); }))
        found_.concerns.push_back(std::move(near));
    if (NoiseOfEquation const* noise = projection_.noise_of_equation())
      add(error_concerns(*noise, index_, errors_, runs_, !found_.chosen.terms.empty(), !found_.moving_average.empty()));
    if (projection_.residual_size() == ResidualSize::one) {
      Columns const by_channels = found_.own_noise > 0 ? projection_.whitened(index_, weights_, 0) : whitened_;
      Eigen::VectorXd against_noise = by_channels.known;
      for (int const j : found_.chosen.terms)
        against_noise -= found_.terms[static_cast<std::size_t>(j)].coefficient * by_channels.terms.col(j);
      double const freedom = static_cast<double>(against_noise.size()) - static_cast<double>(found_.chosen.terms.size());
      found_.noise_ratio = std::sqrt(against_noise.squaredNorm() / freedom);
      add(unexplained_residual(found_.noise_ratio, residual.norm() / known, found_.own_noise > 0));
      add(correlated_windows(whitened_residual));
    }
    if (!choice.converged) {
      Concern concern{.kind = Concern::Kind::no_convergence, .value = static_cast<double>(choice.iterations)};
      concern.clause = fmt::format("the selection of terms did not converge in {} iterations", choice.iterations);
      found_.concerns.push_back(std::move(concern));
    }
  }

  // A large condition index is harmless where the data are good enough: the term is needed, by its probability, and known.
  bool is_settled(int j) const {
    FoundTerm const& term = found_.terms[static_cast<std::size_t>(j)];
    bool const needed = found_.joint.size() > 0 && found_.joint(j, j) > settled_probability;
    return needed && term.sd < settled_sd * std::abs(term.coefficient);
  }

  void add(Concerns const& concerns) { found_.concerns.insert(found_.concerns.end(), concerns.begin(), concerns.end()); }
  void add(std::optional<Concern> concern) {
    if (concern) found_.concerns.push_back(std::move(*concern));
  }

  Equation const& equation_;
  Projection const& projection_;
  int index_;
  Method const& method_;
  FoundEquation found_;
  std::vector<int> usable_;
  Columns whitened_;
  int runs_ = 1;             // of rows that follow one another
  Eigen::VectorXd errors_;   // of a difference equation; empty where they are rounding
  Eigen::VectorXd weights_;  // [J], those that whitened_ was last whitened with
};

}  // namespace

Discovery discover(Dictionary const& dictionary, std::span<Experiment const> experiments, Method const& method) {
  std::unique_ptr<Projection> const projection = method.form->project(dictionary, experiments, method.form_settings);
  Discovery discovery;
  discovery.noise_sd = projection->noise_sd();
  discovery.half_width = projection->half_width();
  for (std::size_t e = 0; e < dictionary.equations.size(); ++e) {
    int const index = static_cast<int>(e);
    discovery.equations.push_back(Finder(dictionary.equations[e], *projection, index, method).find());
    FoundEquation& found = discovery.equations.back();
    if (found.found && !dictionary.discrete && !(method.interrupted && method.interrupted()))
      if (auto concern = better_rule(dictionary, experiments, method, index, projection->columns(index), found))
        found.concerns.push_back(std::move(*concern));
    if (found.found && dictionary.discrete && !(method.interrupted && method.interrupted()))
      if (auto concern = outside_term(dictionary, experiments, method, index, found)) found.concerns.push_back(std::move(*concern));
    discovery.interrupted = discovery.interrupted || (method.interrupted && method.interrupted());
  }
  if (projection->residual_size() == ResidualSize::propagated)
    check_against_noise(dictionary, experiments, method, *projection, discovery);
  return discovery;
}

}  // namespace sysid::regression
