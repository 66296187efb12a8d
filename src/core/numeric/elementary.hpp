// Elementary functions with one answer on every processor: SLEEF's deterministic `finz_` family, scalar and over lanes.
// Nothing in simulation, densities, transforms or random variates may call std:: for these; sqrt, fma, fabs and floor are exact and
// may be used.
#pragma once

namespace sysid::elementary {

double exp(double x);
double expm1(double x);
double log(double x);
double log1p(double x);
double log10(double x);
double pow(double x, double y);
double sin(double x);
double cos(double x);
double tan(double x);
double asin(double x);
double acos(double x);
double atan(double x);
double atan2(double y, double x);
double sinh(double x);
double cosh(double x);
double tanh(double x);
double erf(double x);
double erfc(double x);
double lgamma(double x);

/// Over `width` lanes, bit-equal to the scalar form in each; the widest instruction set in force is used.
using Unary = double (*)(double);
using Binary = double (*)(double, double);
using UnaryLanes = void (*)(double const* x, double* out, int width);
using BinaryLanes = void (*)(double const* x, double const* y, double* out, int width);

/// The vector form behind a lane form: a function of 4 doubles (of 2 on AArch64, of 8: `wide`) in registers, by the C calling
/// convention. Null: none.
void const* vector_form(void const* lanes, bool wide);

void exp_lanes(double const* x, double* out, int width);
void expm1_lanes(double const* x, double* out, int width);
void log_lanes(double const* x, double* out, int width);
void log1p_lanes(double const* x, double* out, int width);
void log10_lanes(double const* x, double* out, int width);
void pow_lanes(double const* x, double const* y, double* out, int width);
void sin_lanes(double const* x, double* out, int width);
void cos_lanes(double const* x, double* out, int width);
void tan_lanes(double const* x, double* out, int width);
void asin_lanes(double const* x, double* out, int width);
void acos_lanes(double const* x, double* out, int width);
void atan_lanes(double const* x, double* out, int width);
void atan2_lanes(double const* y, double const* x, double* out, int width);
void sinh_lanes(double const* x, double* out, int width);
void cosh_lanes(double const* x, double* out, int width);
void tanh_lanes(double const* x, double* out, int width);
void erf_lanes(double const* x, double* out, int width);
void erfc_lanes(double const* x, double* out, int width);
void lgamma_lanes(double const* x, double* out, int width);

}  // namespace sysid::elementary
