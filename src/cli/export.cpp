// export: results and models in the forms of other programs.
#include <fmt/format.h>

#include "cli/command.hpp"
#include "cli/options.hpp"
#include "core/system/files.hpp"
#include "exchange/export_netcdf.hpp"
#include "exchange/export_stan.hpp"
#include "syntax/parse.hpp"
#include "typeset/typeset.hpp"

namespace sysid::cli {
namespace {

struct ExportOptions {
  std::string what, model;
  bool stan = false, latex = false;
  int draws = 200;
  std::optional<std::filesystem::path> output;
  RunOptions run;
};

/// Does `work` in a session of a .sysid file, whose results are below `results`.
ExitCode with_session(Messages const& messages, ExportOptions const& options, std::string const& path,
                      std::filesystem::path const& results, std::function<ExitCode(Session&)> const& work) {
  return with_checked_file(messages, path, [&](Source const& source, CheckedFile const& file, Diagnostics const&) {
    SilentProgress silent;
    std::ostream nowhere(nullptr);
    RunOptions run = options.run;
    run.output = results;
    Session session(source, file, run, silent, nowhere, nowhere);
    return work(session);
  });
}

ExitCode latex(Messages const& messages, std::string const& path) {
  Source const source = read_source(path);
  Diagnostics diagnostics;
  auto const tree = parse(source, diagnostics);
  messages.show(diagnostics, source);
  if (!tree) return ExitCode::user_error;
  std::cout << sysid::latex(*tree);
  return ExitCode::success;
}

/// Fits that cannot be written leave doubt where others were, and are the user's error where none was.
ExitCode stan(Messages const& messages, Session& session, ResultsFolder const* results, bool force) {
  std::ostringstream written;
  Diagnostics const omitted = export_stan(session, results, force, written);
  std::cout << written.str();
  messages.show(omitted, session.source);
  if (omitted.all().empty()) return ExitCode::success;
  return written.str().empty() ? ExitCode::user_error : ExitCode::doubtful;
}

/// Of results, with the model that they were made from where it is needed.
ExitCode export_results(Messages const& messages, ExportOptions const& options) {
  ResultsFolder const found = find_results(options.what);
  if (!options.stan) require_exportable(found, options.run.force);
  if (!options.stan && options.draws == 0) {
    export_netcdf(found, nullptr, 0, std::cout);
    return ExitCode::success;
  }
  std::string const model = options.model.empty() ? found.file.string() : options.model;
  if (model.empty() || !std::filesystem::exists(model)) {
    messages.complain(model.empty() ? fmt::format("`{}` does not record the file of its results", options.what)
                                    : fmt::format("`{}`, the file of these results, does not exist", model),
                      "give it with --model FILE, or export only what the results contain with --draws 0");
    return model.empty() ? ExitCode::user_error : ExitCode::io;
  }
  return with_session(messages, options, model, found.run, [&](Session& session) {
    if (options.stan) return stan(messages, session, &found, options.run.force);
    export_netcdf(found, &session, options.draws, std::cout);
    return ExitCode::success;
  });
}

ExitCode work(Messages const& messages, ExportOptions const& options) {
  if (options.latex) return latex(messages, options.what);
  if (!options.stan || std::filesystem::is_directory(options.what)) {
    if (!options.output) return export_results(messages, options);
    messages.complain("the exports of results are written into their folders", "remove -o");
    return ExitCode::usage;
  }
  return with_session(messages, options, options.what, options.output.value_or(options.run.output),
                      [&](Session& session) { return stan(messages, session, nullptr, options.run.force); });
}

}  // namespace

Work declare_export(CLI::App& verb) {
  auto const options = std::make_shared<ExportOptions>();
  options->run.execution.threads = 0;
  verb.add_option("WHAT", options->what, "folder of a fit or selection, or of a whole run; with --stan or --latex a .sysid file")
      ->required();
  CLI::Option* const stan = verb.add_flag("--stan", options->stan, "write fits as Stan programs with their data");
  CLI::Option* const latex = verb.add_flag("--latex", options->latex, "print the models of a .sysid file as LaTeX for amsmath");
  latex->excludes(stan);
  verb.add_option("-o,--output", options->output, "folder for the programs of a .sysid file, each in its task's folder")
      ->type_name("FOLDER")
      ->default_str(options->run.output.string())
      ->needs(stan);
  verb.add_option("--model", options->model, "the .sysid file of the results (default: the one they were made from)")
      ->type_name("FILE");
  verb.add_option("--draws", options->draws, "number of draws to simulate for likelihoods and predictions; 0: only what is stored")
      ->type_name("N")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str()
      ->excludes(stan, latex);
  verb.add_flag("--force", options->run.force, "replace existing files");
  return [options](Messages const& messages) { return work(messages, *options); };
}

}  // namespace sysid::cli
