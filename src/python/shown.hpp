// Texts for people as Python has them.
#pragma once
#include <pybind11/pybind11.h>

#include <string_view>

namespace sysid::python {

/// A str whatever the bytes are: those that are no UTF-8, which comments and a file that is refused may hold, become U+FFFD.
inline pybind11::str shown(std::string_view text) {
  PyObject* const made = PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "replace");
  if (made == nullptr) throw pybind11::error_already_set();
  return pybind11::reinterpret_steal<pybind11::str>(made);
}

}  // namespace sysid::python
