// The filter for each number of states, forwards, backwards, and its reverse for derivatives.
#include "gaussian_process/kalman.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "core/numeric/elementary.hpp"

namespace sysid::gaussian_process {
namespace {

/// Small matrices, by columns, of sizes known to the compiler.
template <int D>
using Square = std::array<double, static_cast<std::size_t>(D) * D>;
template <int D>
using Vector = std::array<double, static_cast<std::size_t>(D)>;

template <int D, class A>
double element(A const& a, int i, int j) {
  return a[static_cast<std::size_t>(i + D * j)];
}

/// left * right; `Left` and `Right` say whether to transpose.
template <int D, bool Left, bool Right, class A, class B>
Square<D> product(A const& left, B const& right) {
  Square<D> result;
  for (int j = 0; j < D; ++j)
    for (int i = 0; i < D; ++i) {
      double sum = 0;
      for (int k = 0; k < D; ++k)
        sum +=
            (Left ? element<D>(left, k, i) : element<D>(left, i, k)) * (Right ? element<D>(right, j, k) : element<D>(right, k, j));
      result[static_cast<std::size_t>(i + D * j)] = sum;
    }
  return result;
}

/// (a + a^T)/2: exactly symmetric, as rounding left it nearly. Not by copying a triangle: g++ 12.2 at -O1 compiles such loops over
/// 64 elements wrongly (its ivopts pass).
template <int D>
Square<D> symmetric(Square<D> const& a) {
  Square<D> result;
  for (int j = 0; j < D; ++j)
    for (int i = 0; i < D; ++i) result[static_cast<std::size_t>(i + D * j)] = 0.5 * (element<D>(a, i, j) + element<D>(a, j, i));
  return result;
}

/// covariance * measured, and the product of that with measured again.
template <int D>
double gain(Square<D> const& covariance, double const* measured, Vector<D>& out) {
  double variance = 0;
  for (int i = 0; i < D; ++i) {
    double sum = 0;
    for (int k = 0; k < D; ++k) sum += element<D>(covariance, i, k) * measured[k];
    out[static_cast<std::size_t>(i)] = sum;
    variance += sum * measured[i];
  }
  return variance;
}

/// A (before - P) A^T + P: the covariance predicted from that after the instant before.
template <int D>
Square<D> predicted(double const* transition, double const* before, double const* stationary) {
  Square<D> difference;
  for (std::size_t i = 0; i < difference.size(); ++i) difference[i] = before[i] - stationary[i];
  Square<D> result = product<D, false, true>(product<D, false, false>(transition, difference), transition);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] += stationary[i];
  return symmetric<D>(result);
}

/// transition * vector or its transpose * vector.
template <int D, bool Transposed>
void turn(double const* transition, double const* from, double* to) {
  for (int i = 0; i < D; ++i) {
    double sum = 0;
    for (int k = 0; k < D; ++k) sum += (Transposed ? transition[k + D * i] : transition[i + D * k]) * from[k];
    to[i] = sum;
  }
}

template <int D>
double dot(double const* a, double const* b) {
  double sum = 0;
  for (int i = 0; i < D; ++i) sum += a[i] * b[i];
  return sum;
}

/// Where means and covariances after instant i stand; -1 is the start, where nothing is known.
template <int D>
struct Before {
  std::vector<double> start_means, start_covariance;
  Filtered const& filtered;
  std::size_t columns;
  Before(StateSpaceModel const& model, Filtered const& of, Eigen::Index q)
      : start_means(static_cast<std::size_t>(D * q), 0),
        start_covariance(model.stationary(), model.stationary() + D * D),
        filtered(of),
        columns(static_cast<std::size_t>(q)) {}
  double const* means(std::size_t i) const { return i == 0 ? start_means.data() : &filtered.means[(i - 1) * D * columns]; }
  double const* covariance(std::size_t i) const {
    return i == 0 ? start_covariance.data() : &filtered.covariances[(i - 1) * D * D];
  }
};

template <int D>
Filtered filter_of(StateSpaceModel& model, Instants const& instants, double noise_variance) {
  Eigen::Index const q = instants.observations.rows();
  std::size_t const count = instants.steps.size(), columns = static_cast<std::size_t>(q);
  double const* const measured = model.measured();
  Filtered result;
  result.whitened = Eigen::MatrixXd::Zero(q, static_cast<Eigen::Index>(count));
  result.means.resize(count * D * columns);
  result.covariances.resize(count * D * D);
  result.variances.assign(count, 0);
  Before<D> const before(model, result, q);
  for (std::size_t i = 0; i < count; ++i) {
    double const* const a = model.transition(instants.steps[i], false);
    Square<D> covariance = predicted<D>(a, before.covariance(i), model.stationary());
    double* const means = &result.means[i * D * columns];
    for (std::size_t c = 0; c < columns; ++c) turn<D, false>(a, before.means(i) + D * c, means + D * c);
    if (instants.observed[i]) {
      Vector<D> reach;
      double const variance = gain<D>(covariance, measured, reach) + noise_variance;
      if (!(variance > 0) || !std::isfinite(variance)) {
        result.fine = false;
        return result;
      }
      double const scale = 1 / std::sqrt(variance);
      auto const instant = static_cast<Eigen::Index>(i);
      for (std::size_t c = 0; c < columns; ++c) {
        double* const mean = means + D * c;
        double const innovation = instants.observations(static_cast<Eigen::Index>(c), instant) - dot<D>(measured, mean);
        result.whitened(static_cast<Eigen::Index>(c), instant) = innovation * scale;
        for (int k = 0; k < D; ++k) mean[k] += reach[static_cast<std::size_t>(k)] * (innovation / variance);
      }
      for (int j = 0; j < D; ++j)
        for (int k = 0; k < D; ++k)
          covariance[static_cast<std::size_t>(k + D * j)] -=
              reach[static_cast<std::size_t>(k)] * reach[static_cast<std::size_t>(j)] / variance;
      result.variances[i] = variance;
      result.log_determinant += elementary::log(variance);
    }
    std::copy(covariance.begin(), covariance.end(), &result.covariances[i * D * D]);
  }
  return result;
}

template <int D>
FilterGradient gradient_of(StateSpaceModel& model, Instants const& instants, Filtered const& filtered, int parameters,
                           Eigen::MatrixXd const& weights) {
  Eigen::Index const q = weights.rows();
  std::size_t const columns = static_cast<std::size_t>(q);
  double const* const measured = model.measured();
  Before<D> const before(model, filtered, q);
  FilterGradient result{std::vector<double>(static_cast<std::size_t>(parameters), 0), 0,
                        Eigen::MatrixXd::Zero(q, static_cast<Eigen::Index>(instants.steps.size()))};
  // Derivatives in what stands after the instant (then before its update, then after the one before), and in P.
  std::vector<double> by_means(D * columns, 0), predicted_means(D * columns), turned(D);
  Square<D> by_covariance{}, by_stationary{};
  for (std::size_t i = instants.steps.size(); i-- > 0;) {
    double const* const a = model.transition(instants.steps[i], true);
    if (instants.observed[i]) {
      auto const instant = static_cast<Eigen::Index>(i);
      Square<D> const covariance = predicted<D>(a, before.covariance(i), model.stationary());
      Vector<D> reach, by_reach{};
      gain<D>(covariance, measured, reach);
      double const variance = filtered.variances[i], root = std::sqrt(variance);
      double by_variance = -0.5 / variance;
      for (std::size_t c = 0; c < columns; ++c) {
        double const whitened = filtered.whitened(static_cast<Eigen::Index>(c), instant), innovation = whitened * root;
        double const weight = weights(static_cast<Eigen::Index>(c), instant);
        double* const by_mean = &by_means[D * c];
        double const along = dot<D>(by_mean, reach.data());
        double const by_innovation = weight / root + along / variance;
        by_variance -= 0.5 * weight * whitened / variance + along * innovation / (variance * variance);
        for (int k = 0; k < D; ++k) {
          by_reach[static_cast<std::size_t>(k)] += by_mean[k] * innovation / variance;
          by_mean[k] -= measured[k] * by_innovation;
        }
        result.observations(static_cast<Eigen::Index>(c), instant) = by_innovation;
      }
      Vector<D> pulled;
      for (int k = 0; k < D; ++k) {
        double sum = 0;
        for (int j = 0; j < D; ++j) sum += element<D>(by_covariance, k, j) * reach[static_cast<std::size_t>(j)];
        pulled[static_cast<std::size_t>(k)] = sum;
      }
      by_variance += dot<D>(pulled.data(), reach.data()) / (variance * variance);
      result.noise_variance += by_variance;
      for (int k = 0; k < D; ++k)
        by_reach[static_cast<std::size_t>(k)] += measured[k] * by_variance - 2 * pulled[static_cast<std::size_t>(k)] / variance;
      for (int j = 0; j < D; ++j)
        for (int k = 0; k < D; ++k)
          by_covariance[static_cast<std::size_t>(k + D * j)] +=
              0.5 * (by_reach[static_cast<std::size_t>(k)] * measured[j] + measured[k] * by_reach[static_cast<std::size_t>(j)]);
    }
    // Through the prediction. 2 by_covariance A (before - P) and the products with means are the derivatives in A.
    Square<D> difference;
    for (std::size_t k = 0; k < difference.size(); ++k) difference[k] = before.covariance(i)[k] - model.stationary()[k];
    Square<D> by_transition = product<D, false, false>(product<D, false, false>(by_covariance, a), difference);
    for (double& one : by_transition) one *= 2;
    for (std::size_t c = 0; c < columns; ++c) {
      double* const by_mean = &by_means[D * c];
      double const* const mean = before.means(i) + D * c;
      for (int j = 0; j < D; ++j)
        for (int k = 0; k < D; ++k) by_transition[static_cast<std::size_t>(k + D * j)] += by_mean[k] * mean[j];
      turn<D, true>(a, by_mean, turned.data());
      std::copy(turned.begin(), turned.end(), by_mean);
    }
    model.add_transition_gradient(by_transition.data(), result.parameters.data());
    Square<D> const through = product<D, true, false>(a, product<D, false, false>(by_covariance, a));
    for (std::size_t k = 0; k < through.size(); ++k) by_stationary[k] += by_covariance[k] - through[k];
    by_covariance = through;
  }
  for (std::size_t k = 0; k < by_stationary.size(); ++k) by_stationary[k] += by_covariance[k];  // the start is P
  model.add_stationary_gradient(by_stationary.data(), result.parameters.data());
  return result;
}

template <int D>
Smoothed smooth_of(StateSpaceModel& model, Instants const& instants, Filtered const& filtered) {
  Eigen::Index const q = instants.observations.rows();
  std::size_t const columns = static_cast<std::size_t>(q), count = instants.steps.size();
  double const* const measured = model.measured();
  Before<D> const before(model, filtered, q);
  Smoothed result{Eigen::MatrixXd(q, static_cast<Eigen::Index>(count)), Eigen::VectorXd(static_cast<Eigen::Index>(count))};
  // r [d q] and N [d d]: what later observations say of the state, such that mean + P r and P - P N P are smoothed.
  std::vector<double> later(D * columns, 0), turned(D);
  Square<D> information{};
  for (std::size_t i = count; i-- > 0;) {
    auto const instant = static_cast<Eigen::Index>(i);
    double const* const a = model.transition(instants.steps[i], false);
    Square<D> const covariance = predicted<D>(a, before.covariance(i), model.stationary());
    Vector<D> reach;
    gain<D>(covariance, measured, reach);
    if (instants.observed[i]) {
      double const variance = filtered.variances[i], root = std::sqrt(variance);
      // L^T N L with L = I - reach measured^T/variance: rows and columns of `measured` change.
      Vector<D> pulled;
      for (int k = 0; k < D; ++k) {
        double sum = 0;
        for (int j = 0; j < D; ++j) sum += element<D>(information, k, j) * reach[static_cast<std::size_t>(j)];
        pulled[static_cast<std::size_t>(k)] = sum / variance;
      }
      double const twice = dot<D>(pulled.data(), reach.data()) / variance;
      for (int j = 0; j < D; ++j)
        for (int k = 0; k < D; ++k)
          information[static_cast<std::size_t>(k + D * j)] += measured[k] * measured[j] * (1 / variance + twice) -
                                                              measured[k] * pulled[static_cast<std::size_t>(j)] -
                                                              pulled[static_cast<std::size_t>(k)] * measured[j];
      for (std::size_t c = 0; c < columns; ++c) {
        double* const r = &later[D * c];
        double const innovation = filtered.whitened(static_cast<Eigen::Index>(c), instant) * root;
        double const change = (innovation - dot<D>(reach.data(), r)) / variance;
        for (int k = 0; k < D; ++k) r[k] += measured[k] * change;
      }
    }
    double variance = dot<D>(measured, reach.data());
    for (int j = 0; j < D; ++j)
      for (int k = 0; k < D; ++k)
        variance -= reach[static_cast<std::size_t>(k)] * element<D>(information, k, j) * reach[static_cast<std::size_t>(j)];
    result.variances[instant] = variance;
    for (std::size_t c = 0; c < columns; ++c) {
      turn<D, false>(a, before.means(i) + D * c, turned.data());
      result.means(static_cast<Eigen::Index>(c), instant) = dot<D>(measured, turned.data()) + dot<D>(reach.data(), &later[D * c]);
      turn<D, true>(a, &later[D * c], turned.data());
      std::copy(turned.begin(), turned.end(), &later[D * c]);
    }
    information = product<D, true, false>(a, product<D, false, false>(information, a));
  }
  return result;
}

/// Calls `work` with the model's dimension as a constant.
template <class Work>
auto with_dimension(int dimension, Work const& work) {
  using Result = decltype(work(std::integral_constant<int, 1>()));
  Result result;
  auto const choose = [&]<int... Less>(std::integer_sequence<int, Less...>) {
    ((dimension == Less + 1 ? void(result = work(std::integral_constant<int, Less + 1>())) : void()), ...);
  };
  choose(std::make_integer_sequence<int, most_states>());
  return result;
}

}  // namespace

Filtered filter(StateSpaceModel& model, Instants const& instants, double noise_variance) {
  return with_dimension(model.dimension(), [&](auto d) { return filter_of<decltype(d)::value>(model, instants, noise_variance); });
}

FilterGradient filter_gradient(StateSpaceModel& model, Instants const& instants, Filtered const& filtered,
                               Eigen::MatrixXd const& weights) {
  return with_dimension(model.dimension(), [&](auto d) {
    return gradient_of<decltype(d)::value>(model, instants, filtered, model.parameter_count(), weights);
  });
}

Smoothed smooth(StateSpaceModel& model, Instants const& instants, Filtered const& filtered) {
  return with_dimension(model.dimension(), [&](auto d) { return smooth_of<decltype(d)::value>(model, instants, filtered); });
}

}  // namespace sysid::gaussian_process
