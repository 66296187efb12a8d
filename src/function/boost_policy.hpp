// How sysid calls Boost.Math: a failure is a NaN or an infinity, never an exception; no long double, whose width varies.
#pragma once
#include <boost/math/policies/policy.hpp>

namespace sysid {

namespace boost_policies = boost::math::policies;
using BoostPolicy = boost_policies::policy<
    boost_policies::domain_error<boost_policies::ignore_error>, boost_policies::pole_error<boost_policies::ignore_error>,
    boost_policies::overflow_error<boost_policies::ignore_error>, boost_policies::underflow_error<boost_policies::ignore_error>,
    boost_policies::evaluation_error<boost_policies::ignore_error>, boost_policies::promote_double<false>>;

}  // namespace sysid
