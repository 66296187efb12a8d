// Squared deviance residuals under the noise itself, against closed forms.
#include "distribution/deviance.hpp"

#include <doctest/doctest.h>

#include <boost/math/special_functions/digamma.hpp>
#include <boost/math/special_functions/trigamma.hpp>

using namespace sysid;

TEST_CASE("squared deviance residuals of normal and log-normal noise are chi-squared of one degree of freedom") {
  for (char const* name : {"normal", "log_normal"}) {
    CAPTURE(name);
    double const arguments[] = {2.5, 0.3};
    DevianceMoments const moments = deviance_moments(*find_distribution(name), arguments);
    CHECK(moments.mean == doctest::Approx(1).epsilon(1e-5));
    CHECK(moments.variance == doctest::Approx(2).epsilon(1e-4));
    CHECK(std::fabs(moments.excess_kurtosis()) < 1e-3);
  }
}

TEST_CASE("those of Student's t are larger, the more so the heavier its tails") {
  // 1/(1 + t^2/n) has the beta distribution with n/2 and 1/2; the moments of its logarithm are differences of polygamma functions.
  for (double const n : {1.0, 2.5, 4.0, 30.0}) {
    CAPTURE(n);
    double const arguments[] = {-1, n, 0.7};
    DevianceMoments const moments = deviance_moments(*find_distribution("student_t"), arguments);
    double const mean = (n + 1) * (boost::math::digamma((n + 1) / 2) - boost::math::digamma(n / 2));
    double const variance = (n + 1) * (n + 1) * (boost::math::trigamma(n / 2) - boost::math::trigamma((n + 1) / 2));
    CHECK(moments.mean == doctest::Approx(mean).epsilon(1e-5));
    CHECK(moments.variance == doctest::Approx(variance).epsilon(1e-3));
  }
}
