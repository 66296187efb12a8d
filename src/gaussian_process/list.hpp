// The kernels of the language, once, in the order in which they are listed: F(name), whose row NAME_kernel() stands in the kernel's
// own file. The declarations (rows.hpp) and the table (table.cpp) expand this list.
#pragma once

#define SYSID_KERNELS(F) \
  F(squared_exponential) \
  F(matern12)            \
  F(matern32)            \
  F(matern52)            \
  F(periodic)            \
  F(linear)              \
  F(constant)            \
  F(oscillator)
