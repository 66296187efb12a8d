// The distributions of the language, once, in the order that `sysid list distributions` prints: F(name), whose row
// NAME_distribution() stands in the distribution's own file. The declarations (rows.hpp) and the table (table.cpp) expand this
// list.
#pragma once

#define SYSID_DISTRIBUTIONS(F) \
  F(uniform)                   \
  F(log_uniform)               \
  F(normal)                    \
  F(log_normal)                \
  F(half_normal)               \
  F(student_t)                 \
  F(half_cauchy)               \
  F(exponential)               \
  F(gamma)                     \
  F(inverse_gamma)             \
  F(beta)                      \
  F(flat)                      \
  F(log_flat)                  \
  F(poisson)                   \
  F(negative_binomial)
