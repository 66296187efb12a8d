// The functions of core/numeric/elementary, once: F(name, SLEEF's accuracy class). Every file that needs one line per function
// expands this list.
#pragma once

#define SYSID_ELEMENTARY_UNARY(F) \
  F(exp, u10)                     \
  F(expm1, u10)                   \
  F(log, u10)                     \
  F(log1p, u10)                   \
  F(log10, u10)                   \
  F(sin, u10)                     \
  F(cos, u10)                     \
  F(tan, u10)                     \
  F(asin, u10)                    \
  F(acos, u10)                    \
  F(atan, u10)                    \
  F(sinh, u10)                    \
  F(cosh, u10)                    \
  F(tanh, u10)                    \
  F(erf, u10)                     \
  F(erfc, u15)                    \
  F(lgamma, u10)

#define SYSID_ELEMENTARY_BINARY(F) \
  F(pow, u10)                      \
  F(atan2, u10)
