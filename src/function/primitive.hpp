// The primitives behind functions and densities, and formulas with them. Users call them through function/table.hpp; digamma, the
// incomplete gamma functions and Student's t serve derivatives and truncated densities and have no name in the language.
#pragma once
#include "expression/function.hpp"
#include "expression/term.hpp"

namespace sysid {

extern Function const exp_function, expm1_function, log1p_function, log10_function;  // log_function: expression/function.hpp
extern Function const sin_function, cos_function, tan_function, asin_function, acos_function, atan_function, atan2_function;
extern Function const sinh_function, cosh_function, tanh_function;
extern Function const erf_function, erfc_function;
extern Function const lgamma_function, digamma_function;
extern Function const gamma_p_function, gamma_q_function, student_t_cdf_function;

inline Term call(Function const& function, Term a) { return {*a.graph, a.graph->call(function, a.id)}; }
inline Term call(Function const& function, Term a, Term b) { return {*a.graph, a.graph->call(function, a.id, b.id)}; }

inline Term exp(Term x) { return call(exp_function, x); }
inline Term expm1(Term x) { return call(expm1_function, x); }
inline Term log(Term x) { return call(log_function, x); }
inline Term log1p(Term x) { return call(log1p_function, x); }
inline Term sin(Term x) { return call(sin_function, x); }
inline Term cos(Term x) { return call(cos_function, x); }
inline Term sinh(Term x) { return call(sinh_function, x); }
inline Term cosh(Term x) { return call(cosh_function, x); }
inline Term atan(Term x) { return call(atan_function, x); }
inline Term erf(Term x) { return call(erf_function, x); }
inline Term erfc(Term x) { return call(erfc_function, x); }
inline Term lgamma(Term x) { return call(lgamma_function, x); }
/// Regularised incomplete gamma functions P(shape, x) and Q = 1 - P.
inline Term gamma_p(Term shape, Term x) { return call(gamma_p_function, shape, x); }
inline Term gamma_q(Term shape, Term x) { return call(gamma_q_function, shape, x); }
/// P(T <= t) of Student's t.
inline Term student_t_cdf(Term t, Term degrees_of_freedom) { return call(student_t_cdf_function, t, degrees_of_freedom); }
/// Regularised incomplete beta function I_x(a, b) and 1 - I_x(a, b), each accurate where it is small; from operations.
struct IncompleteBeta {
  Term lower, upper;
};
IncompleteBeta incomplete_beta(Term a, Term b, Term x);

/// The scalar form over lanes, for primitives without a vector form.
template <double (*scalar)(double)>
void over_lanes(double const* x, double* out, int width) {
  for (int i = 0; i < width; ++i) out[i] = scalar(x[i]);
}
template <double (*scalar)(double, double)>
void over_lanes(double const* x, double const* y, double* out, int width) {
  for (int i = 0; i < width; ++i) out[i] = scalar(x[i], y[i]);
}

/// psi(x) = d/dx lgamma(x).
double digamma(double x);

}  // namespace sysid
