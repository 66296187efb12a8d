// Draws as arrays with the dimensions chain and draw: elements of a vector and values per experiment become one array with
// further dimensions, as ArviZ has them.
#pragma once
#include "exchange/netcdf.hpp"
#include "result/draws.hpp"

namespace sysid {

/// `units` as readers of NetCDF may take it: xarray turns numbers in "days" or "seconds" into time spans, which `day` and `second`
/// spare them.
std::string netcdf_unit(std::string const& unit);

/// {"units", ...}; nothing where there is none.
Attributes unit_attribute(std::string const& unit);

/// The dimensions chain and draw, counted from 0. All chains are of one length.
void add_chain_dimensions(NetcdfGroup& group, std::size_t chains, std::size_t draws);

/// All names of the draws, with their units: `k[1]`, `k[2]`, ... as `k` over `k_dim_0` (1, 2, ...), `k[bench]`, `k[hall]` as `k`
/// over `experiment`, `M[1,2]` over `M_dim_0` and `M_dim_1`; what is no full grid of one unit stays as it is named.
void add_draws(NetcdfGroup& group, Draws const& draws);

}  // namespace sysid
