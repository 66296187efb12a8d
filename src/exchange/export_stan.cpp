// All programs are made before the first is written.
#include "exchange/export_stan.hpp"

#include <fmt/format.h>

#include "app/session/stored_draws.hpp"
#include "core/system/files.hpp"
#include "exchange/refused.hpp"
#include "exchange/stan_program.hpp"
#include "experiment/experiments.hpp"
#include "report/file/result_files.hpp"

namespace sysid {
namespace {

struct ProgramFile {
  std::filesystem::path path;
  std::string text;
};

class StanExport {
 public:
  explicit StanExport(Session& session) : session_(session) {}

  /// With the solver that the task states.
  void add(Task const& task, FitTask const& fit) {
    attempt(task, [&] { return fit.solver; });
  }
  /// With the one that was chosen for it.
  void add(StoredResult const& stored) {
    int const index = find_task(session_, stored);
    attempt(session_.file.tasks[static_cast<std::size_t>(index)], [&] { return fitted_model(session_, index).solver; });
  }

  void require_writable(bool force) const {
    if (files_.empty() && excluded_.all().empty())
      throw refused("there is no fit to write as a Stan program", "name a file with a fit task, or results of one");
    for (ProgramFile const& file : files_)
      if (!force && std::filesystem::exists(file.path))
        throw refused(fmt::format("`{}` exists already", file.path.string()), "add --force to replace it");
  }

  Diagnostics write(std::ostream& out) const {
    for (ProgramFile const& file : files_) {
      make_folder(file.path.parent_path());
      write_file(file.path, file.text);
      out << file.path.string() << '\n';
    }
    return excluded_;
  }

 private:
  template <class Solver>
  void attempt(Task const& task, Solver const& solver) {
    try {
      StanProgram written = stan_program(session_, task, solver());
      std::filesystem::path const folder = session_.result_folder(task);
      files_.push_back({folder / exported_file(task.name, ".stan"), std::move(written.program)});
      files_.push_back({folder / exported_file(task.name, ".data.json"), std::move(written.data)});
    } catch (UnusableData const& error) {
      for (Diagnostic const& each : error.diagnostics().all()) excluded_.add(each);
    } catch (UserError const& error) {
      excluded_.add(error.diagnostic());
    }
  }

  Session& session_;
  std::vector<ProgramFile> files_;
  Diagnostics excluded_;
};

}  // namespace

Diagnostics export_stan(Session& session, ResultsFolder const* results, bool force, std::ostream& out) {
  StanExport all(session);
  if (results == nullptr) {
    for (Task const& task : session.file.tasks)
      if (auto const* fit = std::get_if<FitTask>(&task.what)) all.add(task, *fit);
  } else {
    for (StoredResult const& stored : results->results)
      if (stored.is("fit")) all.add(stored);
  }
  all.require_writable(force);
  return all.write(out);
}

}  // namespace sysid
