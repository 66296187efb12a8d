// What `sysid fit`, `check`, `export` and `compare` do, without a terminal.
#include "python/tasks.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <sstream>

#include "app/comparison/compare.hpp"
#include "app/preflight/check_file.hpp"
#include "app/run/pipeline.hpp"
#include "app/run/report_results.hpp"
#include "embed/open_file.hpp"
#include "exchange/export_netcdf.hpp"
#include "python/arrays.hpp"
#include "python/interrupts.hpp"
#include "python/shown.hpp"
#include "report/page/check_page.hpp"
#include "report/page/comparison.hpp"

namespace sysid::python {
namespace {

using embed::guarded;
using embed::OpenFile;
using embed::Raised;

/// Tells an object of Python, which has the methods begin(what, total), advance(done, note) and end(finished).
class TellsPython final : public Progress {
 public:
  explicit TellsPython(py::object told) : told_(std::move(told)) {}
  ~TellsPython() override {
    py::gil_scoped_acquire const locked;
    told_ = py::object();
  }
  void begin(std::string_view what, std::uint64_t total) override { tell("begin", what, total); }
  void expect(std::uint64_t total) override { tell("expect", total); }
  void advance(std::uint64_t done, std::string_view note) override { tell("advance", done, note); }
  void end(bool finished) override { tell("end", finished); }

 private:
  /// What goes wrong in a display is no reason to lose draws.
  template <class... Arguments>
  void tell(char const* method, Arguments... arguments) {
    py::gil_scoped_acquire const locked;
    try {
      told_.attr(method)(arguments...);
    } catch (py::error_already_set& error) {
      error.discard_as_unraisable(method);
    }
  }
  py::object told_;
};

struct Asked {
  std::string output;
  std::optional<std::uint64_t> seed;
  int threads = 0;
  bool temporary = false, force = false, resume = false, figures = true;
  double checkpoint_interval = 30;

  RunOptions options() const {
    RunOptions run;
    run.output = output;
    run.temporary_output = temporary;
    run.seed = seed;
    run.force = force;
    run.resume = resume;
    run.figures = figures;
    run.execution.threads = threads;
    run.checkpoint_interval = checkpoint_interval;
    return run;
  }
};

/// The exit code of the command line, what it printed, its notices, and whether Ctrl-C has come.
py::tuple run(OpenFile const& file, std::vector<std::string> const& names, Asked const& asked, py::object const& progress) {
  std::ostringstream out, notices;
  ExitCode exit = ExitCode::success;
  bool requested = false;
  {
    SilentProgress silent;
    std::optional<TellsPython> telling;
    if (!progress.is_none()) telling.emplace(progress);
    Progress& told = telling ? static_cast<Progress&>(*telling) : silent;
    py::gil_scoped_release const released;
    Interrupts interrupts;
    interrupts.stop_if_requested();
    RunOptions const options = asked.options();
    exit = guarded(file.source(), [&] {
      Session session(file.source(), file.file(), options, told, out, notices);
      return run_tasks(session, [&](Task const& task) { return std::find(names.begin(), names.end(), task.name) != names.end(); });
    });
    requested = interrupts.requested();
  }
  return py::make_tuple(static_cast<int>(exit), shown(out.str()), shown(notices.str()), requested);
}

/// The page as text, and as JSON with the messages about the text.
py::tuple check(OpenFile const& file, Asked const& asked) {
  py::gil_scoped_release const released;
  RunOptions const options = asked.options();
  auto const [text, json] = interruptible(file.source(), [&] {
    SilentProgress silent;
    std::ostringstream out, notices;
    Session session(file.source(), file.file(), options, silent, out, notices);
    CheckResult result = check_file(session);
    result.page.file = file.source().name();
    if (result.diagnostics.has_errors()) throw Raised(result.diagnostics, file.source());
    return std::pair(check_text(result.page), check_json(result.page, render_json(result.diagnostics, file.source())));
  });
  py::gil_scoped_acquire const locked;
  return py::make_tuple(shown(text), shown(json));
}

py::dict attributes_of(Attributes const& attributes) {
  py::dict made;
  for (auto const& [name, value] : attributes) made[py::str(name)] = value;
  return made;
}

py::object values_of(NetcdfVariable const& variable) {
  if (auto const* numbers = std::get_if<std::vector<double>>(&variable.values)) return array_of(*numbers);
  return std::visit([](auto const& values) -> py::object { return py::cast(values); }, variable.values);
}

/// Of each group its name, attributes, dimensions (name, size) and variables (name, dimensions, values by rows, attributes).
py::list groups_of(InferenceData const& data) {
  py::list groups;
  for (NetcdfGroup const& group : data.groups) {
    py::list variables;
    for (NetcdfVariable const& each : group.variables())
      variables.append(py::make_tuple(each.name, each.dimensions, values_of(each), attributes_of(each.attributes)));
    groups.append(py::make_tuple(group.name(), attributes_of(group.attributes()), group.dimensions(), variables));
  }
  return groups;
}

/// draws: as `sysid export --draws` has it. The groups of a fit's results in `folder`, the attributes of all, and the bytes of the
/// file that `sysid export` writes.
py::tuple inference_data(OpenFile const& file, std::string const& folder, Asked const& asked, int draws) {
  RunOptions options = asked.options();
  InferenceData const data = [&] {
    py::gil_scoped_release const released;
    return interruptible(file.source(), [&] {
      SilentProgress silent;
      std::ostringstream out, notices;
      ResultsFolder const found = find_results(folder);
      options.output = found.run;
      Session session(file.source(), file.file(), options, silent, out, notices);
      return fit_data(found.results.front(), draws > 0 ? &session : nullptr, draws);
    });
  }();
  return py::make_tuple(groups_of(data), attributes_of(data.attributes), py::bytes(data.bytes()));
}

/// Text and JSON.
py::tuple compare_folders(std::vector<std::string> const& folders) {
  auto const [text, json] = [&] {
    py::gil_scoped_release const released;
    return interruptible(Source("sysid", ""), [&] {
      auto const comparison = sysid::compare(std::vector<std::filesystem::path>(folders.begin(), folders.end()));
      return std::pair(comparison_text(comparison), comparison_json(comparison));
    });
  }();
  return py::make_tuple(text, json);
}

/// Draws the figures of a task's folder, as SVG.
void draw_figures(std::string const& folder) {
  py::gil_scoped_release const released;
  interruptible(Source("sysid", ""), [&] {
    redraw_figures(folder, {FigureFormat::svg});
    return true;
  });
}

}  // namespace

void bind_tasks(py::module_& module) {
  py::class_<Asked>(module, "Asked")
      .def(py::init([](std::string output, bool temporary, std::optional<std::uint64_t> seed, int threads, bool force, bool resume,
                       bool figures, double checkpoint_interval) {
             return Asked{std::move(output), seed, threads, temporary, force, resume, figures, checkpoint_interval};
           }),
           py::arg("output"), py::arg("temporary") = false, py::arg("seed") = py::none(), py::arg("threads") = 0,
           py::arg("force") = false, py::arg("resume") = false, py::arg("figures") = true, py::arg("checkpoint_interval") = 30);
  module.def("run", &run, py::arg("file"), py::arg("names"), py::arg("asked"), py::arg("progress"));
  module.def("check", &check, py::arg("file"), py::arg("asked"));
  module.def("inference_data", &inference_data, py::arg("file"), py::arg("folder"), py::arg("asked"), py::arg("draws"));
  module.def("compare", &compare_folders, py::arg("folders"));
  module.def("draw_figures", &draw_figures, py::arg("folder"));
}

}  // namespace sysid::python
