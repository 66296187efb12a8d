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

struct ExporterRow;

struct ExportOptions {
  std::string what, model;
  ExporterRow const* exporter = nullptr;
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

/// The session of the model that results were made from.
ExitCode with_model_of(Messages const& messages, ExportOptions const& options, ResultsFolder const& results,
                       std::function<ExitCode(Session&)> const& work) {
  std::string const model = options.model.empty() ? results.file.string() : options.model;
  if (model.empty() || !std::filesystem::exists(model)) {
    messages.complain(model.empty() ? fmt::format("`{}` does not state from which .sysid file it was made", options.what)
                                    : fmt::format("`{}`, the file of these results, does not exist", model),
                      "name the .sysid file with --model FILE, or use --draws 0 to export only what the results contain");
    return model.empty() ? ExitCode::user_error : ExitCode::io;
  }
  return with_session(messages, options, model, results.run, work);
}

ExitCode refuse_output(Messages const& messages) {
  messages.complain("results are always exported into their own folders", "remove -o");
  return ExitCode::usage;
}

ExitCode netcdf(Messages const& messages, ExportOptions const& options) {
  if (options.output) return refuse_output(messages);
  ResultsFolder const found = find_results(options.what);
  require_exportable(found, options.run.force);
  if (options.draws == 0) {
    export_netcdf(found, nullptr, 0, std::cout);
    return ExitCode::success;
  }
  return with_model_of(messages, options, found, [&](Session& session) {
    export_netcdf(found, &session, options.draws, std::cout);
    return ExitCode::success;
  });
}

ExitCode latex(Messages const& messages, ExportOptions const& options) {
  Source const source = read_source(options.what);
  Diagnostics diagnostics;
  auto const tree = parse(source, diagnostics);
  messages.show(diagnostics, source);
  if (!tree) return ExitCode::user_error;
  std::cout << sysid::latex(*tree);
  return ExitCode::success;
}

/// Fits that cannot be written leave doubt where others were, and are the user's error where none was.
ExitCode stan_of(Messages const& messages, Session& session, ResultsFolder const* results, bool force) {
  std::ostringstream written;
  Diagnostics const omitted = export_stan(session, results, force, written);
  std::cout << written.str();
  messages.show(omitted, session.source);
  if (omitted.all().empty()) return ExitCode::success;
  return written.str().empty() ? ExitCode::user_error : ExitCode::doubtful;
}

/// Of the fits in results, with their draws, or of those in a .sysid file.
ExitCode stan(Messages const& messages, ExportOptions const& options) {
  if (!std::filesystem::is_directory(options.what)) {
    if (options.model.empty())
      return with_session(messages, options, options.what, options.output.value_or(options.run.output),
                          [&](Session& session) { return stan_of(messages, session, nullptr, options.run.force); });
    messages.complain("--model names the .sysid file of a folder of results",
                      "remove --model: the file to export is named already");
    return ExitCode::usage;
  }
  if (options.output) return refuse_output(messages);
  ResultsFolder const found = find_results(options.what);
  return with_model_of(messages, options, found,
                       [&](Session& session) { return stan_of(messages, session, &found, options.run.force); });
}

/// A form to export to.
struct ExporterRow {
  char const* flag;  // null: the one without a flag
  char const* help;
  bool simulates;      // likelihoods and predictions at `--draws` draws
  bool into_a_folder;  // of the user's choice, `-o`
  bool writes_files;   // of a model that may be another one, `--model`, in the place of others, `--force`
  ExitCode (*work)(Messages const&, ExportOptions const&);
};

constexpr ExporterRow exporters[] = {
    {nullptr, "", true, false, true, &netcdf},
    {"--stan", "write fits as Stan programs with their data", false, true, true, &stan},
    {"--latex", "print the models of a .sysid file as LaTeX for amsmath", false, false, false, &latex},
};

}  // namespace

Work declare_export(CLI::App& verb) {
  auto const options = std::make_shared<ExportOptions>();
  options->run.execution.threads = 0;
  verb.add_option(
          "WHAT", options->what,
          "folder of a fit, of a selection or of a whole run; --stan also takes a .sysid file, --latex takes only a .sysid file")
      ->required();
  options->exporter = &exporters[0];
  std::vector<std::pair<CLI::Option*, ExporterRow const*>> flags;
  for (ExporterRow const& row : exporters) {
    if (row.flag == nullptr) continue;
    CLI::Option* const flag = verb.add_flag_callback(
        row.flag, [options, &row] { options->exporter = &row; }, row.help);
    for (auto const& [other, of_other] : flags) flag->excludes(other);
    flags.emplace_back(flag, &row);
  }
  CLI::Option* const output =
      verb.add_option("-o,--output", options->output,
                      "with --stan and a .sysid file: folder for the Stan programs, with one subfolder for each task")
          ->type_name("FOLDER")
          ->check(refuse_no_path)
          ->default_str(options->run.output.string());
  CLI::Option* const model =
      verb.add_option("--model", options->model, "the .sysid file of the results (default: the file that they were made from)")
          ->type_name("FILE");
  CLI::Option* const draws =
      verb.add_option("--draws", options->draws,
                      "number of draws for which likelihoods and predictions are simulated; 0: export only stored results")
          ->type_name("N")
          ->check(CLI::Range(0, 1000000))
          ->capture_default_str();
  CLI::Option* const force = verb.add_flag("--force", options->run.force, "replace existing files");
  for (auto const& [flag, row] : flags) {
    if (!row->simulates) draws->excludes(flag);
    if (!row->writes_files) model->excludes(flag), force->excludes(flag);
    if (row->into_a_folder) output->needs(flag);
  }
  return [options](Messages const& messages) { return options->exporter->work(messages, *options); };
}

}  // namespace sysid::cli
