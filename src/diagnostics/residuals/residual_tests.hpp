// Tests of residuals: whether they are noise of the stated size, and whether they are correlated with the input.
// Pure functions on plain vectors; NaN is a missing sample and breaks the record there.
#pragma once
#include <span>
#include <vector>

namespace sysid {

/// A p value below this is no chance.
inline constexpr double rare = 1e-3;

/// The p value below which series of a run are found wrong, so that chance finds one in two runs of a thousand at most, however
/// many series it has. p_values: of all series that are tested, n of them. `rare` where so many lie below it that chance has as
/// many in fewer than one run of a thousand,
///
///   P(K >= k) < rare,   K ~ binomial(n, rare),   k = number of p_values < rare
///
/// since what is a little wrong everywhere shows in many series rather than in one; else rare / n.
double limit_together(std::span<double const> p_values);

/// Correlations lag by lag, and one answer over all of them.
struct CorrelationTest {
  int first_lag = 0;
  std::vector<double> correlation;  // of lag first_lag + i
  std::vector<double> bound;        // 99 % of noise has |correlation| below this, lag by lag
  int outside = 0;                  // lags beyond their bound; 1 % of them is expected
  double p_value = 1;               // of what is seen, or worse, were the residuals noise; 1 when there are too few samples
  double tail_p_value = 1;          // the same by a tail that holds for short records too: what decides
  bool fires(double limit = rare) const { return tail_p_value < limit; }
};

/// Whether residuals are uncorrelated in time, lags 1 .. lags (at most a quarter of the samples). The mean is not removed: an
/// offset is a misfit too.
///
///   r_k = sum e_t e_(t+k) / sum e_t^2,   Q = n (n + 2) sum r_k^2 / n_k ~ chi^2(lags),   n_k the pairs at lag k          Ljung and
///   Box 1978
///
/// The tail of Q is heavier than that of chi^2 in short records: eight white ones of 100 samples in a thousand have p < 1e-3. So
/// below a hundredth `tail_p_value` is of a gamma distribution with the mean of Q, L for L lags, its variance 2 L (1 + 2 L/n) and
/// its skewness sqrt(8/L) (1 + 8 L/n); the two terms in L/n are fitted to simulations of 8 to 1000 samples.
CorrelationTest whiteness(std::span<double const> residuals, int lags = 25);

/// The chance that as many pairs of independent residuals rise, or fall, with time as these do: Kendall's rank correlation. It sees
/// a trend of few samples, where the lags of `whiteness` are few.
///
///   S = sum sign(e_j - e_i), i < j;   z = (|S| - 1) / sqrt(n (n - 1) (2 n + 5) / 18) ~ N(0, 1)                    Kendall 1975
///
/// Two-sided; 1 for fewer than 5 samples and for more than 200, where `whiteness` sees a trend.
double trend_p_value(std::span<double const> residuals);

/// Whether past input (lags 0 .. lags) still shows in the residuals; both without their means.
///
///   z_k = sum (e_(t+k) - e)(u_t - u) / sqrt(n_k P) / (sd e sd u) ~ N(0, 1),   P = 1 + 2 sum r_e(k) r_u(k)          Ljung 1999,
///   eq. 16.63
///
/// P widens the bounds when residuals and input are both coloured. p: the largest |z| among lags + 1 (Sidak), conservative when the
/// input is coloured, as neighbouring lags then say the same.
CorrelationTest input_correlation(std::span<double const> residuals, std::span<double const> input, int lags = 25);

/// (8.18): 100 / (N var y) sum (y - y*)^2, var with divisor N and of the *observed* record, mean removed. Below 5 good, below 1
/// excellent; the true model reaches 100 r^2 for noise of a fraction r. NaN when the observed record is constant (all its samples
/// are equal) or empty.
double nmse(std::span<double const> observed, std::span<double const> predicted);
/// The same of logarithms, where the noise multiplies what is predicted; samples and predictions without one are left out.
double nmse_of_logarithms(std::span<double const> observed, std::span<double const> predicted);

/// sqrt(1/N sum (y - y*)^2), in the unit of y; missing samples are left out. NaN when there are none.
double rmse(std::span<double const> observed, std::span<double const> predicted);

/// Mean square of standardised residuals, 1 for noise of the stated size.
struct ChiSquaredTest {
  double per_sample = 0;
  double low = 0, high = 0;  // noise lies between, but for one in a thousand runs
  bool fires() const { return per_sample < low || per_sample > high; }
};

/// standardised: (y - location) / sd, independent under the model. n * per_sample ~ chi^2(n) for normal ones. Where they have an
/// excess kurtosis k the variance of the sum is n (2 + k), that of chi^2 with 2 n/(2 + k) degrees of freedom in place of n.
/// together: how many series of a run are tested, each on its part of the thousandth. fitted: how many parameters the residuals
/// come from. They take up to so many degrees of freedom, fewer where priors hold them: only the lower bound allows for all.
ChiSquaredTest chi_squared(std::span<double const> standardised, double excess_kurtosis = 0, int together = 1, int fitted = 0);

/// The same of counts, whose excess kurtosis k_i is another one at each sample (1/mean for Poisson's) and without bound where the
/// mean is small. Such a sample says less of the size, and weighs by the degrees of freedom d_i = 2/(2 + k_i) that it is worth,
///
///   per_sample = sum d_i z_i^2 / sum d_i,   of mean 1 and variance 2 / sum d_i:   that of chi^2(n)/n, n = sum d_i
///
/// which of all weights give the smallest variance. Sums of a few rare events are lumps: there the lower bound is that of so many
/// events, and a single event is never too much.
ChiSquaredTest chi_squared_of_counts(std::span<double const> standardised, std::span<double const> degrees, int together = 1,
                                     int fitted = 0);

}  // namespace sysid
