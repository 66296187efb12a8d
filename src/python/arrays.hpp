// NumPy's arrays [W x P], a parameter vector a row, and the engine's lanes [P x W], a parameter vector a column.
#pragma once
#include <pybind11/numpy.h>

#include <algorithm>
#include <span>
#include <vector>

#include "core/numeric/lanes.hpp"

namespace sysid::python {

namespace py = pybind11;
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// ValueError where it is not [W x rows], W > 0.
inline LaneArray lanes_of(Array const& array, int rows) {
  if (array.ndim() != 2 || array.shape(1) != rows)
    throw py::value_error("expected an array of shape (W, " + std::to_string(rows) + "), one parameter vector in each row");
  if (array.shape(0) == 0) throw py::value_error("expected at least one parameter vector");
  int const width = static_cast<int>(array.shape(0));
  LaneArray lanes(rows, width);
  double const* const data = array.data();
  for (int w = 0; w < width; ++w)
    for (int p = 0; p < rows; ++p) lanes(p, w) = data[static_cast<std::ptrdiff_t>(w) * rows + p];
  return lanes;
}

inline Array array_of(ConstLanes lanes) {
  Array array({lanes.width(), lanes.rows()});
  double* const data = array.mutable_data();
  for (int w = 0; w < lanes.width(); ++w)
    for (int p = 0; p < lanes.rows(); ++p) data[static_cast<std::ptrdiff_t>(w) * lanes.rows() + p] = lanes(p, w);
  return array;
}

inline Array array_of(std::span<double const> values) {
  Array array(static_cast<py::ssize_t>(values.size()));
  std::copy(values.begin(), values.end(), array.mutable_data());
  return array;
}

/// [rows x columns] of equally long series.
inline Array array_of(std::vector<std::vector<double>> const& series, std::size_t columns) {
  Array array({static_cast<py::ssize_t>(series.size()), static_cast<py::ssize_t>(columns)});
  double* place = array.mutable_data();
  for (auto const& each : series) place = std::copy(each.begin(), each.end(), place);
  return array;
}

}  // namespace sysid::python
