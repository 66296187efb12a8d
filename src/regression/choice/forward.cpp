// Modified Gram-Schmidt on the triangle of the problem.
#include "regression/choice/forward.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "regression/choice/triangle.hpp"

namespace sysid::regression::forward {
namespace {

constexpr SettingRow rows[] = {
    {"least_ratio", SettingKind::real, "0", 0, 1, "",
     "smallest error reduction ratio of a term that is taken; 0: as many terms as maximise the evidence"},
};

/// Candidates beside the chosen one: supports of the way forward, up to so many terms before and behind where it ended. Terms that
/// are dropped after it are still in them.
constexpr int neighbours = 2;
/// Part of a column that must be left when those taken are removed from it: less is rounding.
constexpr double dependent_below = 1e-16;  // of its square

struct Step {
  int term;
  double ratio;
};

class Path {
 public:
  explicit Path(LinearProblem const& problem, Triangle const& triangle)
      : left_(triangle.r), known_(triangle.known), length_(left_.cols()), total_(triangle.total), rest_(triangle.rest) {
    for (Eigen::Index j = 0; j < left_.cols(); ++j) length_(j) = left_.col(j).squaredNorm();
    for (Eigen::Index j = 0; j < left_.cols(); ++j)
      if (problem.always[static_cast<std::size_t>(j)] != 0) take(static_cast<int>(j));
  }

  /// 0 for a term that is taken, or a sum of those that are.
  double ratio(Eigen::Index j) const {
    double const squares = left_.col(j).squaredNorm();
    if (!(squares > dependent_below * length_(j)) || !(total_ > 0)) return 0;
    double const product = left_.col(j).dot(known_);
    return product * product / squares / total_;
  }

  bool go_on(std::size_t most) {
    if (taken_.size() >= most) return false;
    Eigen::Index best = -1;
    double largest = 0;
    for (Eigen::Index j = 0; j < left_.cols(); ++j)
      if (double const each = ratio(j); each > largest) best = j, largest = each;
    if (best < 0) return false;
    take(static_cast<int>(best));
    return true;
  }

  /// Sum of squared residuals with what is taken.
  double squares() const { return rest_ + known_.squaredNorm(); }
  std::vector<Step> const& taken() const { return taken_; }
  std::vector<int> first(std::size_t count) const {
    std::vector<int> terms;
    for (std::size_t k = 0; k < count; ++k) terms.push_back(taken_[k].term);
    std::sort(terms.begin(), terms.end());
    return terms;
  }

 private:
  void take(int term) {
    taken_.push_back({term, ratio(term)});
    Eigen::VectorXd const direction = left_.col(term).normalized();
    known_ -= direction.dot(known_) * direction;
    for (Eigen::Index j = 0; j < left_.cols(); ++j) left_.col(j) -= direction.dot(left_.col(j)) * direction;
    left_.col(term).setZero();
  }

  Eigen::MatrixXd left_;
  Eigen::VectorXd known_, length_;
  double total_, rest_;
  std::vector<Step> taken_;
};

/// With so many terms to choose from, every size being as probable.
class Score {
 public:
  Score(LinearProblem const& problem, Triangle const& triangle, double base)
      : count_(static_cast<std::size_t>(problem.terms.cols())),
        always_(static_cast<std::size_t>(std::count(problem.always.begin(), problem.always.end(), 1))),
        most_(std::max(always_, std::min(count_, static_cast<std::size_t>(triangle.rows) / 2))),
        base_(base),
        rows_(triangle.rows - static_cast<double>(always_)) {}

  double operator()(std::size_t terms, double squares) const {
    auto const free = static_cast<double>(count_ - always_), size = static_cast<double>(terms - always_);
    return log_bayes_factor(CoefficientPrior::beta_prime, rows_, size, squares, base_, rows_) + elementary::lgamma(size + 1) +
           elementary::lgamma(free - size + 1) - elementary::lgamma(free + 1);
  }
  /// Terms that the way goes up to.
  std::size_t most() const { return most_; }
  std::size_t always() const { return always_; }

 private:
  std::size_t count_, always_, most_;
  double base_, rows_;
};

/// So many terms of the way, and their score.
struct Place {
  std::size_t terms;
  double score;
};

/// Where a term has a ratio below `least`, or, where that is 0, where the score is best.
Place walk(Path& path, Score const& score, double least) {
  Place chosen{path.taken().size(), score(path.taken().size(), path.squares())};
  while (path.go_on(score.most())) {
    std::size_t const size = path.taken().size();
    if (least > 0) {
      if (path.taken().back().ratio < least) break;
      chosen.terms = size;
    } else if (double const each = score(size, path.squares()); each > chosen.score) {
      chosen = {size, each};
    }
  }
  return chosen;
}

/// Terms go as long as the score rises.
void drop_needless(LinearProblem const& problem, Triangle const& triangle, Score const& score, double best,
                   std::vector<int>& terms) {
  for (bool lowered = true; lowered;) {
    lowered = false;
    for (std::size_t k = 0; k < terms.size() && !lowered; ++k) {
      if (problem.always[static_cast<std::size_t>(terms[k])] != 0) continue;
      std::vector<int> fewer = terms;
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(k));
      if (double const each = score(fewer.size(), residual_squares(triangle, fewer)); each > best) {
        best = each;
        terms = std::move(fewer);
        lowered = true;
      }
    }
  }
}

}  // namespace

std::span<SettingRow const> settings() { return rows; }

Choice choose(LinearProblem const& problem, Settings const& settings, SelectorContext const&) {
  Triangle const triangle = reduce(problem);
  double const least = settings.real("least_ratio");
  Path path(problem, triangle);
  Score const score(problem, triangle, path.squares());
  auto const [chosen, best] = walk(path, score, least);
  std::vector<int> terms = path.first(chosen);
  if (least == 0) drop_needless(problem, triangle, score, best, terms);

  Choice choice;
  choice.iterations = static_cast<int>(path.taken().size());
  choice.terms.resize(static_cast<std::size_t>(problem.terms.cols()));
  auto const offer = [&](std::vector<int> const& each) {
    Support support = support_of(triangle, each);
    support.log_evidence = default_log_evidence(triangle, problem.always, each);
    return support;
  };
  choice.chosen = offer(terms);
  choice.chosen.probability = 1;
  choice.noise_sd = choice.chosen.noise_sd;
  for (Step const& step : path.taken()) choice.terms[static_cast<std::size_t>(step.term)].measure = step.ratio;
  for (std::size_t k = 0; k < terms.size(); ++k) {
    auto const i = static_cast<Eigen::Index>(k);
    TermChoice& term = choice.terms[static_cast<std::size_t>(terms[k])];
    term.kept = true;
    term.mean = choice.chosen.coefficient(i);
    term.sd = std::sqrt(choice.chosen.covariance(i, i));
  }
  choice.supports.push_back(choice.chosen);
  for (int distance = 1; distance <= neighbours; ++distance) {
    auto const away = static_cast<std::size_t>(distance);
    if (chosen >= score.always() + away) choice.supports.push_back(offer(path.first(chosen - away)));
    if (chosen + away <= path.taken().size()) choice.supports.push_back(offer(path.first(chosen + away)));
  }
  return choice;
}

}  // namespace sysid::regression::forward
