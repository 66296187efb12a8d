// The language server's completions and hovers, formulas and pages of messages, as Python's own types.
#include "python/language.hpp"

#include <pybind11/stl.h>

#include "app/catalogue/explain.hpp"
#include "assist/completion.hpp"
#include "assist/hover.hpp"
#include "syntax/parse.hpp"
#include "typeset/typeset.hpp"

namespace sysid::python {
namespace {

namespace py = pybind11;

/// The heading under which a statement is shown.
struct Heading {
  char const* operator()(ast::Equation const&) const { return "equations"; }
  char const* operator()(ast::InitialDeclaration const&) const { return "equations"; }
  char const* operator()(ast::Observation const&) const { return "observed"; }
  char const* operator()(ast::ParameterDeclaration const&) const { return "parameters"; }
  template <class Other>
  char const* operator()(Other const&) const {
    return "definitions";
  }
};

/// A text of `path` at an offset in bytes: what is replaced, as (begin, end), and of each completion its label, kind, detail and
/// summary.
py::tuple complete(std::string const& path, std::string const& text, std::uint32_t offset) {
  auto const found = [&] {
    py::gil_scoped_release const released;
    return assist::complete(path, text, offset);
  }();
  py::list items;
  for (assist::Completion const& each : found.items) items.append(py::make_tuple(each.label, each.detail, each.summary));
  return py::make_tuple(found.replaces.begin, found.replaces.end, items);
}

/// Markdown about the name there; None where no name stands.
std::optional<std::string> hover(std::string const& path, std::string const& text, std::uint32_t offset) {
  py::gil_scoped_release const released;
  auto const reading = assist::read(path, text);
  auto const found = reading ? assist::hover(*reading, offset) : std::nullopt;
  return found ? std::optional(found->markdown) : std::nullopt;
}

}  // namespace

py::list typeset_models(embed::OpenFile const& file) {
  Diagnostics ignored;
  Source const own(file.source().name(), std::string(file.source().text(0)));
  std::optional<ast::File> const tree = parse(own, ignored);
  py::list all;
  if (!tree) return all;
  for (ast::Item const& item : tree->items) {
    auto const* model = std::get_if<ast::Model>(&item);
    if (model == nullptr) continue;
    std::vector<std::optional<std::string>> const formulas = mathml(model->statements);
    py::list statements;
    for (std::size_t i = 0; i < formulas.size(); ++i)
      if (formulas[i]) statements.append(py::make_tuple(std::visit(Heading(), model->statements[i]), *formulas[i]));
    all.append(py::make_tuple(model->name.text, model->title ? model->title->value : std::string(), statements, latex(*model)));
  }
  return all;
}

void bind_language(py::module_& module) {
  module.def("complete", &complete, py::arg("path"), py::arg("text"), py::arg("offset"));
  module.def("hover", &hover, py::arg("path"), py::arg("text"), py::arg("offset"));
  module.def("explain", &explain, py::arg("code"));
}

}  // namespace sysid::python
