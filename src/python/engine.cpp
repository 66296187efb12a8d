// The compiled part of `import sysid`: opens files, raises errors. What users call is written in Python (src/python/sysid).
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "check/checked/task_kinds.hpp"
#include "core/numeric/instruction_set.hpp"
#include "core/system/interrupt.hpp"
#include "embed/open_file.hpp"
#include "python/density.hpp"
#include "python/interrupts.hpp"
#include "python/language.hpp"
#include "python/shown.hpp"
#include "python/tasks.hpp"

namespace sysid::python {
namespace {

namespace py = pybind11;
using embed::OpenFile;
using embed::Raised;

/// Ctrl-C before it is open stops it.
std::shared_ptr<OpenFile> open(std::string const& path, std::optional<std::string> const& text,
                               std::map<std::string, std::string> const& records, bool awaits_records) {
  Interrupts interrupts;
  interrupts.stop_if_requested();
  auto file = std::make_shared<OpenFile>(path, text, records, awaits_records);
  interrupts.stop_if_requested();
  return file;
}

/// Names and verbs, in the order of the file.
py::list tasks(OpenFile const& file) {
  py::list all;
  for (Task const& task : file.file().tasks) all.append(py::make_tuple(task.name, verb_of(task)));
  return all;
}

/// Of each data block its name, its table and the columns that it reads.
py::list data(OpenFile const& file) {
  py::list all;
  for (DataBlock const& block : file.file().data) {
    py::list columns;
    if (block.time) columns.append(block.time->column);
    for (auto const& input : block.inputs) columns.append(input.column);
    for (auto const& measured : block.measured) columns.append(measured.column);
    all.append(py::make_tuple(block.name, block.path, columns));
  }
  return all;
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (Raised const& raised) {
    py::object const error = py::module_::import("sysid._error").attr("Error");
    PyErr_SetObject(error.ptr(), error(shown(raised.what()), shown(raised.json())).ptr());
  } catch (Interrupted const&) {
    PyErr_SetNone(PyExc_KeyboardInterrupt);
  }
}

}  // namespace

PYBIND11_MODULE(_engine, module) {
  if (!supported_instruction_set()) throw py::import_error("this processor lacks AVX2 and FMA (x86-64-v3), which sysid needs");
  py::register_exception_translator(&translate);
  module.attr("version") = SYSID_VERSION;
  module.def("instruction_set", [] { return std::string(name(instruction_set())); });
  py::class_<OpenFile, std::shared_ptr<OpenFile>>(module, "File")
      .def(py::init(&open), py::arg("path"), py::arg("text"), py::arg("records"), py::arg("awaits_records") = false,
           py::call_guard<py::gil_scoped_release>())
      .def_property_readonly("warnings", [](OpenFile const& file) { return shown(file.warnings()); })
      .def_property_readonly("path", [](OpenFile const& file) { return file.source().name(0); })
      .def_property_readonly("text", [](OpenFile const& file) { return shown(file.source().text(0)); })
      .def_property_readonly("content", [](OpenFile const& file) { return py::bytes(file.source().text(0)); })
      .def_property_readonly("tasks", &tasks)
      .def_property_readonly("data", &data)
      .def_property_readonly("models", &typeset_models);
  bind_density(module);
  bind_language(module);
  bind_tasks(module);
}

}  // namespace sysid::python
