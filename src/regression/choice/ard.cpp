// MacKay's updates on a scaled problem reduced to its triangle.
#include "regression/choice/ard.hpp"

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "linear_algebra/decompositions.hpp"
#include "regression/choice/triangle.hpp"

namespace sysid::regression::ard {
namespace {

constexpr SettingRow rows[] = {
    {"iterations", SettingKind::integer, "1000", 1, 1e7, "", "maximum number of updates of the precisions"},
    {"tolerance", SettingKind::real, "1e-6", 0, 1, "",
     "stop when the sum of the changes of the scaled coefficients is smaller than this"},
    {"prune", SettingKind::real, "1e4", 1, 1e300, "",
     "precision of a scaled coefficient above which its term is dropped: 1e4 drops contributions below 1/sqrt(1e4), one hundredth"},
};

constexpr double hyper = 1e-6;     // shape and rate of the gamma priors of all precisions
constexpr double unbound = 1e-12;  // precision of a coefficient that is always in

struct Posterior {
  std::vector<int> terms;
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

/// The iteration: posterior of the coefficients, their precisions and the noise by it, terms of too large a precision left out.
class Relevance {
 public:
  explicit Relevance(LinearProblem const& problem)
      : problem_(problem),
        triangle_(reduce(problem)),
        count_(static_cast<int>(triangle_.r.cols())),
        rows_count_(triangle_.rows),
        unit_(std::sqrt(triangle_.total / rows_count_)),
        gram_(triangle_.r.transpose() * triangle_.r),
        right_(triangle_.r.transpose() * triangle_.known / unit_),
        rest_(triangle_.rest / (unit_ * unit_)),
        known_(triangle_.known / unit_),
        lambda_(Eigen::VectorXd::Ones(count_)),
        mean_(Eigen::VectorXd::Zero(count_)) {
    double const mean_known = problem.known.sum() / unit_ / rows_count_;
    alpha_ = 1 / (1 - mean_known * mean_known + std::numeric_limits<double>::epsilon());  // the variance of the known side
    for (int j = 0; j < count_; ++j) {
      if (problem.always[static_cast<std::size_t>(j)] != 0) lambda_(j) = unbound;
      kept_.push_back(j);
    }
  }

  bool empty() const { return kept_.empty(); }
  Eigen::VectorXd const& mean() const { return mean_; }

  void iterate(double prune) {
    Posterior const now = posterior();
    mean_.setZero();
    double effective = 0;
    for (std::size_t k = 0; k < kept_.size(); ++k) {
      auto const i = static_cast<Eigen::Index>(k);
      int const j = kept_[k];
      mean_(j) = now.mean(i);
      double const gamma = 1 - lambda_(j) * now.covariance(i, i);
      effective += gamma;
      if (problem_.always[static_cast<std::size_t>(j)] == 0) lambda_(j) = (gamma + 2 * hyper) / (mean_(j) * mean_(j) + 2 * hyper);
    }
    double const squares = rest_ + (known_ - triangle_.r * mean_).squaredNorm();
    alpha_ = (rows_count_ - effective + 2 * hyper) / (squares + 2 * hyper);
    std::erase_if(kept_, [&](int j) { return !(lambda_(j) < prune); });
    for (int j = 0; j < count_; ++j)
      if (!(lambda_(j) < prune)) mean_(j) = 0;
  }

  void describe(Choice& choice) const {
    choice.terms.resize(static_cast<std::size_t>(count_));
    for (TermChoice& term : choice.terms) term.precision = std::numeric_limits<double>::infinity();
    Posterior const last = posterior();
    choice.chosen = support_of(triangle_, kept_);
    choice.chosen.log_evidence = default_log_evidence(triangle_, problem_.always, kept_);
    choice.chosen.probability = 1;
    choice.noise_sd = unit_ / std::sqrt(alpha_);
    choice.supports.push_back(choice.chosen);
    for (std::size_t k = 0; k < kept_.size(); ++k) {
      auto const i = static_cast<Eigen::Index>(k);
      TermChoice& term = choice.terms[static_cast<std::size_t>(kept_[k])];
      double const back = unit_ / triangle_.scale(kept_[k]);
      term.kept = true;
      term.precision = lambda_(kept_[k]);
      term.measure = std::abs(last.mean(i));  // columns and known side have unit root mean square
      term.mean = last.mean(i) * back;
      term.sd = std::sqrt(last.covariance(i, i)) * back;
    }
  }

 private:
  Posterior posterior() const {
    auto const size = static_cast<Eigen::Index>(kept_.size());
    Posterior result{kept_, Eigen::VectorXd(size), Eigen::MatrixXd(size, size)};
    Eigen::MatrixXd precision(size, size);
    Eigen::VectorXd linear(size);
    for (Eigen::Index a = 0; a < size; ++a) {
      linear(a) = alpha_ * right_(kept_[static_cast<std::size_t>(a)]);
      for (Eigen::Index b = 0; b < size; ++b)
        precision(a, b) = alpha_ * gram_(kept_[static_cast<std::size_t>(a)], kept_[static_cast<std::size_t>(b)]);
      precision(a, a) += lambda_(kept_[static_cast<std::size_t>(a)]);
    }
    // Positive definite but for rounding, which a record almost without noise can bring near.
    auto const factor = cholesky(precision);
    result.covariance = factor ? solve_cholesky(*factor, Eigen::MatrixXd::Identity(size, size)) : inverse(precision);
    result.mean = factor ? solve_cholesky(*factor, linear) : result.covariance * linear;
    return result;
  }

  LinearProblem const& problem_;
  Triangle const triangle_;
  int const count_;
  double const rows_count_;
  double const unit_;  // of the known side
  Eigen::MatrixXd const gram_;
  Eigen::VectorXd const right_;
  double const rest_;
  Eigen::VectorXd const known_;
  double alpha_ = 1;               // precision of the noise
  Eigen::VectorXd lambda_, mean_;  // precisions and means of the coefficients
  std::vector<int> kept_;
};

}  // namespace

std::span<SettingRow const> settings() { return rows; }

Choice choose(LinearProblem const& problem, Settings const& settings, SelectorContext const& context) {
  Relevance relevance(problem);
  Eigen::VectorXd before = relevance.mean();
  Choice choice;
  choice.converged = relevance.empty();
  int const most = static_cast<int>(settings.integer("iterations"));
  double const prune = settings.real("prune"), tolerance = settings.real("tolerance");
  for (int iteration = 0; iteration < most && !relevance.empty(); ++iteration) {
    if (context.interrupted && context.interrupted()) break;
    relevance.iterate(prune);
    choice.iterations = iteration + 1;
    choice.converged = relevance.empty() || (iteration > 0 && (relevance.mean() - before).cwiseAbs().sum() < tolerance);
    if (choice.converged) break;
    before = relevance.mean();
  }
  relevance.describe(choice);
  return choice;
}

}  // namespace sysid::regression::ard
