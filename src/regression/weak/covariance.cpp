// Banded products of sensitivities, their factor, and a search along one number.
#include "regression/weak/covariance.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/numeric/elementary.hpp"

namespace sysid::regression {
namespace {

/// Natural logarithms of the variance that is the equation's own over that of the channels, between which the search goes.
constexpr double least_share = -7, most_share = 7, share_step = 1, share_accuracy = 0.05;
constexpr double golden = 0.6180339887498949;

/// Windows that share samples lie at most this many apart in the list of centres.
int band_of(WeakBlock const& block) {
  std::vector<int> const& centres = block.integrals.windows().centres;
  int band = 0;
  for (int k = 0, first = 0; k < static_cast<int>(centres.size()); ++k) {
    while (centres[static_cast<std::size_t>(k)] - centres[static_cast<std::size_t>(first)] > 2 * block.integrals.reach()) ++first;
    band = std::max(band, k - first);
  }
  return band;
}

BandMatrix empty_covariance(WeakBlock const& block) {
  return {static_cast<int>(block.integrals.windows().centres.size()), band_of(block)};
}

/// covariance += G G^T, with G^T as WeakIntegrals::gradient has it.
void add_products(WeakBlock const& block, Eigen::MatrixXd const& gradient, BandMatrix& covariance) {
  std::vector<int> const& centres = block.integrals.windows().centres;
  for (int k = 0; k < covariance.size(); ++k)
    for (int l = std::max(0, k - covariance.band()); l <= k; ++l) {
      int const shift = centres[static_cast<std::size_t>(k)] - centres[static_cast<std::size_t>(l)];
      int const common = 2 * block.integrals.reach() + 1 - shift;
      if (common > 0) covariance(k, l) += gradient.col(k).head(common).dot(gradient.col(l).tail(common));
    }
}

double trace(BandMatrix const& matrix) {
  double sum = 0;
  for (int k = 0; k < matrix.size(); ++k) sum += matrix(k, k);
  return sum;
}

double trace(std::vector<BandMatrix> const& blocks) {
  double sum = 0;
  for (BandMatrix const& block : blocks) sum += trace(block);
  return sum;
}

/// Nothing when no sample enters the block.
std::optional<BandMatrix> factored(BandMatrix const& covariance) {
  double const sum = trace(covariance);
  if (!(sum > 0) || !std::isfinite(sum)) return std::nullopt;
  for (double nugget = 1e-10;; nugget *= 100) {
    BandMatrix factor = covariance;
    for (int k = 0; k < factor.size(); ++k) factor(k, k) += nugget * sum / factor.size();
    if (factor.factor()) return factor;
  }
}

}  // namespace

WeakCovariance::WeakCovariance(std::span<WeakBlock const> blocks, std::vector<int> const& channels,
                               std::vector<double> const& noise_sd, Eigen::VectorXd const& coefficients)
    : coefficients_(coefficients) {
  for (WeakBlock const& block : blocks) {
    Sensitivities sum = block.known.sensitivities;
    for (std::size_t j = 0; j < block.terms.size(); ++j) {
      double const w = coefficients(static_cast<Eigen::Index>(j));
      if (w == 0) continue;  // a term left out may not be finite
      for (auto const& [key, values] : block.terms[j].sensitivities) {
        auto const [place, fresh] = sum.try_emplace(key, -w * values);
        if (!fresh) place->second -= w * values;
      }
    }
    BandMatrix& of_channels = channels_.emplace_back(empty_covariance(block));
    for (int const channel : channels)
      add_products(block, noise_sd[static_cast<std::size_t>(channel)] * block.integrals.gradient(sum, channel), of_channels);
    add_products(block, block.integrals.known_gradient(), equation_.emplace_back(empty_covariance(block)));
  }
}

double WeakCovariance::whiten(Eigen::Ref<Eigen::MatrixXd> rows, double own_variance) const {
  double log_determinant = 0;
  Eigen::Index first = 0;
  for (std::size_t b = 0; b < channels_.size(); ++b) {
    BandMatrix covariance = channels_[b];
    Eigen::Index const count = covariance.size();
    if (own_variance > 0) covariance.add(own_variance, equation_[b]);
    if (auto const factor = factored(covariance)) {
      factor->solve_lower(rows.middleRows(first, count));
      for (int k = 0; k < factor->size(); ++k) log_determinant += elementary::log((*factor)(k, k));
    }
    first += count;
  }
  return log_determinant;
}

Columns WeakCovariance::whitened(Columns const& columns, double own) const {
  Eigen::MatrixXd rows(columns.known.size(), columns.terms.cols() + 1);
  rows << columns.known, columns.terms;
  whiten(rows, own * own);
  return {rows.col(0), rows.rightCols(columns.terms.cols())};
}

double WeakCovariance::own_noise(Columns const& columns) const {
  double const ratio = trace(channels_) / trace(equation_), rows = static_cast<double>(columns.known.size());
  if (!(ratio > 0) || !std::isfinite(ratio)) return 0;
  Eigen::MatrixXd residual = columns.known;
  for (Eigen::Index j = 0; j < coefficients_.size(); ++j)
    if (coefficients_(j) != 0) residual -= coefficients_(j) * columns.terms.col(j);
  auto const log_likelihood = [&](double variance) {
    Eigen::MatrixXd white = residual;
    double const log_determinant = whiten(white, variance);
    return -0.5 * rows * elementary::log(white.squaredNorm()) - log_determinant;
  };
  auto const value = [&](double share) { return log_likelihood(elementary::exp(share) * ratio); };
  double const none = log_likelihood(0);
  double best = least_share, highest = value(best);
  for (double at = least_share + share_step; at <= most_share; at += share_step)
    if (double const here = value(at); here > highest) best = at, highest = here;
  // Golden section about the best.
  double low = best - share_step, high = best + share_step;
  double a = high - golden * (high - low), b = low + golden * (high - low);
  double at_a = value(a), at_b = value(b);
  while (high - low > share_accuracy) {
    if (at_a > at_b) {
      high = std::exchange(b, a);
      at_b = std::exchange(at_a, value(a = high - golden * (high - low)));
    } else {
      low = std::exchange(a, b);
      at_a = std::exchange(at_b, value(b = low + golden * (high - low)));
    }
  }
  bool const pays = std::max(at_a, at_b) - none > elementary::log(rows) / 2;
  return pays ? std::sqrt(elementary::exp((low + high) / 2) * ratio) : 0;
}

}  // namespace sysid::regression
