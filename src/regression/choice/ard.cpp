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
    {"tolerance", SettingKind::real, "1e-6", 0, 1, "", "stop when the sum of the changes of the scaled coefficients is smaller"},
    {"prune", SettingKind::real, "1e4", 1, 1e300, "",
     "precision of a scaled coefficient above which its term is dropped: 1e4 is a contribution of one part in a hundred"},
};

constexpr double hyper = 1e-6;     // shape and rate of the gamma priors of all precisions
constexpr double unbound = 1e-12;  // precision of a coefficient that is always in

struct Posterior {
  std::vector<int> terms;
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

}  // namespace

std::span<SettingRow const> settings() { return rows; }

Choice choose(LinearProblem const& problem, Settings const& settings, SelectorContext const& context) {
  Triangle const triangle = reduce(problem);
  auto const count = static_cast<int>(triangle.r.cols());
  double const rows_count = triangle.rows;
  double const unit = std::sqrt(triangle.total / rows_count);  // of the known side
  Eigen::MatrixXd const gram = triangle.r.transpose() * triangle.r;
  Eigen::VectorXd const right = triangle.r.transpose() * triangle.known / unit;
  double const rest = triangle.rest / (unit * unit);
  Eigen::VectorXd const known = triangle.known / unit;

  double mean_known = problem.known.sum() / unit / rows_count;
  double alpha = 1 / (1 - mean_known * mean_known + std::numeric_limits<double>::epsilon());  // the variance of the known side
  Eigen::VectorXd lambda = Eigen::VectorXd::Ones(count), mean = Eigen::VectorXd::Zero(count), before = mean;
  for (int j = 0; j < count; ++j)
    if (problem.always[static_cast<std::size_t>(j)] != 0) lambda(j) = unbound;
  std::vector<int> kept;
  for (int j = 0; j < count; ++j) kept.push_back(j);

  auto const posterior = [&] {
    auto const size = static_cast<Eigen::Index>(kept.size());
    Posterior result{kept, Eigen::VectorXd(size), Eigen::MatrixXd(size, size)};
    Eigen::MatrixXd precision(size, size);
    Eigen::VectorXd linear(size);
    for (Eigen::Index a = 0; a < size; ++a) {
      linear(a) = alpha * right(kept[static_cast<std::size_t>(a)]);
      for (Eigen::Index b = 0; b < size; ++b)
        precision(a, b) = alpha * gram(kept[static_cast<std::size_t>(a)], kept[static_cast<std::size_t>(b)]);
      precision(a, a) += lambda(kept[static_cast<std::size_t>(a)]);
    }
    // Positive definite but for rounding, which a record almost without noise can bring near.
    auto const factor = cholesky(precision);
    result.covariance = factor ? solve_cholesky(*factor, Eigen::MatrixXd::Identity(size, size)) : inverse(precision);
    result.mean = factor ? solve_cholesky(*factor, linear) : result.covariance * linear;
    return result;
  };

  Choice choice;
  choice.converged = false;
  int const most = static_cast<int>(settings.integer("iterations"));
  double const prune = settings.real("prune"), tolerance = settings.real("tolerance");
  for (int iteration = 0; iteration < most && !kept.empty(); ++iteration) {
    if (context.interrupted && context.interrupted()) break;
    Posterior const now = posterior();
    mean.setZero();
    double effective = 0;
    for (std::size_t k = 0; k < kept.size(); ++k) {
      auto const i = static_cast<Eigen::Index>(k);
      int const j = kept[k];
      mean(j) = now.mean(i);
      double const gamma = 1 - lambda(j) * now.covariance(i, i);
      effective += gamma;
      if (problem.always[static_cast<std::size_t>(j)] == 0) lambda(j) = (gamma + 2 * hyper) / (mean(j) * mean(j) + 2 * hyper);
    }
    double const squares = rest + (known - triangle.r * mean).squaredNorm();
    alpha = (rows_count - effective + 2 * hyper) / (squares + 2 * hyper);
    std::erase_if(kept, [&](int j) { return !(lambda(j) < prune); });
    for (int j = 0; j < count; ++j)
      if (!(lambda(j) < prune)) mean(j) = 0;
    choice.iterations = iteration + 1;
    choice.converged = iteration > 0 && (mean - before).cwiseAbs().sum() < tolerance;
    if (choice.converged) break;
    before = mean;
  }

  choice.terms.resize(static_cast<std::size_t>(count));
  for (TermChoice& term : choice.terms) term.precision = std::numeric_limits<double>::infinity();
  Posterior const last = posterior();
  choice.chosen = support_of(triangle, kept);
  choice.chosen.log_evidence = default_log_evidence(triangle, problem.always, kept);
  choice.chosen.probability = 1;
  choice.noise_sd = unit / std::sqrt(alpha);
  choice.supports.push_back(choice.chosen);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    auto const i = static_cast<Eigen::Index>(k);
    TermChoice& term = choice.terms[static_cast<std::size_t>(kept[k])];
    double const back = unit / triangle.scale(kept[k]);
    term.kept = true;
    term.precision = lambda(kept[k]);
    term.measure = std::abs(last.mean(i));  // columns and known side have unit root mean square
    term.mean = last.mean(i) * back;
    term.sd = std::sqrt(last.covariance(i, i)) * back;
  }
  return choice;
}

}  // namespace sysid::regression::ard
