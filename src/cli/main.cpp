// The command line: verbs and options in, exit codes out; everything else is app/.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <iostream>

#include "app/check_file.hpp"
#include "app/compare.hpp"
#include "app/experiments.hpp"
#include "app/explain.hpp"
#include "app/lists.hpp"
#include "app/module_page.hpp"
#include "app/pipeline.hpp"
#include "app/report_results.hpp"
#include "core/files.hpp"
#include "core/instruction_set.hpp"
#include "core/interrupt.hpp"
#include "core/progress_terminal.hpp"
#include "exchange/export.hpp"
#include "lsp/server.hpp"
#include "repl/prompt.hpp"
#include "syntax/format.hpp"
#include "syntax/parse.hpp"

namespace sysid {
namespace {

struct CommandLine {
  std::string file, dump, error_format = "text", instruction_set, topic, code;
  std::vector<std::string> files, figures;
  int draws = 200;
  bool stan = false, latex = false;
  RunOptions run;
  bool quiet = false, only_check = false;
  std::filesystem::path page;       // where `report` writes; empty: beside the results
  std::string* messages = nullptr;  // where JSON messages go that a verb prints as part of its answer; else standard error
};

int code(ExitCode exit) { return static_cast<int>(exit); }

bool colour() {
  auto const variable = [](char const* name) {
    char const* value = std::getenv(name);
    return std::string_view(value == nullptr ? "" : value);
  };
  return variable("NO_COLOR").empty() && variable("TERM") != "dumb" && isatty(STDERR_FILENO) != 0;
}

void show_json(std::string const& lines, CommandLine const& line) {
  if (line.messages != nullptr)
    *line.messages += lines;
  else
    std::cerr << lines;
}

void show(Diagnostics const& diagnostics, Source const& source, CommandLine const& line) {
  if (line.error_format == "json")
    show_json(render_json(diagnostics, source), line);
  else
    std::cerr << render(diagnostics, source, colour());
}

Source read_source(std::string const& path) { return Source(path, read_file(path, most_text_bytes + 1)); }

/// What concerns no place in a text: "sysid: cannot read ...", or the same as JSON with `severity` error and no code.
void complain(CommandLine const& line, std::string const& message, std::string const& help = "") {
  if (line.error_format == "json") {
    Diagnostic diagnostic;
    diagnostic.message = message;
    diagnostic.help = help;
    show_json(render_json(diagnostic, Source(line.file, "")), line);
  } else {
    std::cerr << "sysid: " << message << '\n' << help << (help.empty() ? "" : "\n");
  }
}

// Runs a verb; every way out of it has its exit code here.
template <class Verb>
int guarded(CommandLine const& line, Source const& source, Verb const& verb) {
  try {
    return verb();
  } catch (UnusableData const& error) {
    show(error.diagnostics(), source, line);
    return code(ExitCode::user_error);
  } catch (UserError const& error) {
    Diagnostics diagnostics;
    diagnostics.add(error.diagnostic());
    show(diagnostics, source, line);
    return code(ExitCode::user_error);
  } catch (UnreadableData const& error) {
    show(error.diagnostics(), source, line);
    return code(ExitCode::io);
  } catch (IoError const& error) {
    complain(line, error.what(), error.help());
    return code(ExitCode::io);
  } catch (std::bad_alloc const&) {
    complain(line, "out of memory");
    return code(ExitCode::internal);
  } catch (std::exception const& error) {
    complain(line, fmt::format("this is our fault, not yours: {}", error.what()), "please send the file that shows it");
    return code(ExitCode::internal);
  }
}

int run(CommandLine& line, std::vector<std::string> const& verbs) {
  std::optional<Source> source;
  return guarded(line, Source("", ""), [&] {
    source.emplace(read_source(line.file));
    return guarded(line, *source, [&] {
      Diagnostics diagnostics;
      if (!line.dump.empty()) {
        std::string const text = dump_stage(*source, line.dump, diagnostics);
        show(diagnostics, *source, line);
        if (diagnostics.has_errors()) return code(ExitCode::user_error);
        std::cout << text;
        return code(ExitCode::success);
      }
      auto const file = load(*source, diagnostics);
      show(diagnostics, *source, line);
      if (!file) return code(ExitCode::user_error);
      install_interrupt_handlers();
      std::ostream nowhere(nullptr);
      SilentProgress silent;
      TerminalProgress terminal;
      return code(run_tasks(*source, *file, verbs, line.run, line.quiet ? static_cast<Progress&>(silent) : terminal, std::cout,
                            line.quiet ? nowhere : std::cerr));
    });
  });
}

int check(CommandLine line) {
  bool const json = line.error_format == "json";
  std::string messages;
  if (json) line.messages = &messages;
  CheckPage page;
  page.file = line.file;
  int const exit = guarded(line, Source("", ""), [&] {
    Source source = read_source(line.file);
    Diagnostics diagnostics;
    auto const file = load(source, diagnostics);
    show(diagnostics, source, line);
    if (!file) return code(ExitCode::user_error);
    return guarded(line, source, [&] {
      SilentProgress silent;
      std::ostream nowhere(nullptr);
      Session session(source, *file, line.run, silent, nowhere, nowhere);
      CheckResult result = check_file(session);
      show(result.diagnostics, source, line);
      for (Diagnostics const* said : {&diagnostics, &result.diagnostics})
        for (Diagnostic const& each : said->all()) ++(each.severity == Severity::error ? result.page.errors : result.page.warnings);
      page = std::move(result.page);
      if (!json) std::cout << check_text(page);
      if (result.diagnostics.has_errors()) return code(result.unreadable ? ExitCode::io : ExitCode::user_error);
      return code(grade(page) == Severity::error ? ExitCode::doubtful : ExitCode::success);
    });
  });
  if (json) std::cout << check_json(page, messages);
  return exit;
}

int compare(CommandLine const& line) {
  return guarded(line, Source("sysid", ""), [&] {
    Comparison const comparison = sysid::compare({line.files.begin(), line.files.end()});
    std::cout << (line.error_format == "json" ? comparison_json(comparison) : comparison_text(comparison));
    return code(ExitCode::success);
  });
}

/// Each once, in the order asked for; nothing asked for: SVG.
std::vector<FigureFormat> figure_formats(std::vector<std::string> const& names) {
  std::vector<FigureFormat> formats;
  for (std::string const& name : names) {
    FigureFormat const format = *find_figure_format(name);
    if (std::find(formats.begin(), formats.end(), format) == formats.end()) formats.push_back(format);
  }
  return formats.empty() ? std::vector{FigureFormat::svg} : formats;
}

int report(CommandLine const& line) {
  return guarded(line, Source("sysid", ""), [&] {
    if (!line.figures.empty()) redraw_figures(line.file, figure_formats(line.figures));
    std::optional<std::filesystem::path> page;
    if (!line.page.empty()) page = line.page;
    std::cout << report_results(line.file, page, line.run.figures).string() << '\n';
    return code(ExitCode::success);
  });
}

// Loads the .sysid file that an export needs and does the work in a session of it.
int with_session(CommandLine const& line, std::filesystem::path const& output, std::function<void(Session&)> const& work) {
  std::optional<Source> source = read_source(line.file);
  return guarded(line, *source, [&] {
    Diagnostics diagnostics;
    auto const file = load(*source, diagnostics);
    if (diagnostics.has_errors()) show(diagnostics, *source, line);
    if (!file) return code(ExitCode::user_error);
    SilentProgress silent;
    std::ostream nowhere(nullptr);
    RunOptions options = line.run;
    options.output = output;
    Session session(*source, *file, options, silent, nowhere, nowhere);
    work(session);
    return code(ExitCode::success);
  });
}

int export_results(CommandLine line) {
  return guarded(line, Source("sysid", ""), [&] {
    if (line.stan && !std::filesystem::is_directory(line.topic)) {
      line.file = line.topic;
      return with_session(line, line.run.output,
                          [&](Session& session) { export_stan(session, nullptr, line.run.force, std::cout); });
    }
    if (line.latex) {
      Source const source = read_source(line.topic);
      return guarded(line, source, [&] {
        Diagnostics diagnostics;
        auto const tree = parse(source, diagnostics);
        show(diagnostics, source, line);
        if (!tree) return code(ExitCode::user_error);
        std::cout << equations_latex(*tree);
        return code(ExitCode::success);
      });
    }
    ExportedResults const results = find_results(line.topic);
    if (!line.stan) require_exportable(results, line.run.force);
    if (!line.stan && line.draws == 0) {
      export_netcdf(results, nullptr, 0, std::cout);
      return code(ExitCode::success);
    }
    if (line.file.empty()) line.file = results.file.string();
    if (line.file.empty() || !std::filesystem::exists(line.file)) {
      complain(line,
               line.file.empty() ? fmt::format("`{}` does not say of which file its results are", line.topic)
                                 : fmt::format("`{}`, of which the results are, is not there", line.file),
               "name it with --model FILE, or export what the results hold themselves with --draws 0");
      return code(line.file.empty() ? ExitCode::user_error : ExitCode::io);
    }
    return with_session(line, results.run, [&](Session& session) {
      if (line.stan)
        export_stan(session, &results, line.run.force, std::cout);
      else
        export_netcdf(results, &session, line.draws, std::cout);
    });
  });
}

std::string read_standard_input() { return {std::istreambuf_iterator<char>(std::cin), std::istreambuf_iterator<char>()}; }

int format_one(CommandLine const& line, std::string const& path) {
  bool const stream = path == "-";
  return guarded(line, Source(path, ""), [&] {
    Source const source = stream ? Source("standard input", read_standard_input()) : read_source(path);
    return guarded(line, source, [&] {
      Diagnostics diagnostics;
      auto const text = formatted(source, diagnostics);
      show(diagnostics, source, line);
      if (!text) return code(ExitCode::user_error);
      bool const same = *text == source.text();
      if (line.only_check) {
        if (!same) std::cout << source.name() << ": not in canonical layout\n";
        return code(same ? ExitCode::success : ExitCode::doubtful);
      }
      if (stream) {
        std::cout << *text;
      } else if (!same) {
        write_file(path, *text);
        std::cout << path << ": rewritten\n";
      }
      return code(ExitCode::success);
    });
  });
}

/// Every file is looked at; the exit code is of the worst.
int format(CommandLine const& line) {
  int exit = code(ExitCode::success);
  for (std::string const& path : line.files) exit = std::max(exit, format_one(line, path));
  return exit;
}

int explain(CommandLine const& line) {
  if (line.code.empty()) {
    std::cout << list_codes();
    return code(ExitCode::success);
  }
  auto const text = sysid::explain(line.code);
  if (!text) {
    std::cerr << fmt::format("sysid: there is no message {}; `sysid explain` lists all\n", line.code);
    return code(ExitCode::usage);
  }
  std::cout << *text;
  return code(ExitCode::success);
}

int document(CommandLine const& line) {
  auto const page = module_page(line.topic);
  if (!page) {
    std::cerr << fmt::format("sysid: there is no module {}; `sysid list modules` lists all\n", line.topic);
    return code(ExitCode::usage);
  }
  std::cout << *page;
  return code(ExitCode::success);
}

/// Why figures cannot be drawn as this, before hours of sampling and not after; empty when they can.
std::string refuse_figure_format(std::string const& name) {
  auto const format = find_figure_format(name);
  if (!format) return fmt::format("`{}` is no format of figures; there are svg, png, pdf and text", name);
  // Without gnuplot there are scripts, which the page says: nobody has asked for more.
  if (*format != FigureFormat::svg && !can_draw(*format))
    return fmt::format("gnuplot cannot draw {} here; the Debian package gnuplot-nox can", name);
  return "";
}

void add_figures_option(CLI::App& verb, CommandLine& line) {
  verb.add_option("--figures", line.figures,
                  "what figures are drawn as: svg, png, pdf or text, several with commas between (default: svg)")
      ->delimiter(',')
      ->type_name("FORMAT,...")
      ->check(refuse_figure_format);
}

void add_run_options(CLI::App& verb, CommandLine& line) {
  verb.add_option("file", line.file, "the .sysid file")->required();
  verb.add_option("-o,--output", line.run.output, "folder for results (default: results)");
  verb.add_flag("--force", line.run.force, "overwrite results of the same name");
  verb.add_flag("--resume", line.run.resume, "go on from checkpoints; keep tasks that are complete");
  verb.add_option("--seed", line.run.seed, "seed of all random numbers, in place of the file's");
  verb.add_option("--threads", line.run.execution.threads, "threads (0: one per processor); results do not depend on it")
      ->check(CLI::Range(0, 1024));
  verb.add_option("--lanes", line.run.execution.lanes, "simulations side by side (0: chosen); results do not depend on it")
      ->check(CLI::Range(0, 4096));
  verb.add_option("--instruction-set", line.instruction_set,
                  "avx2 or avx512 (default: the best there is); results do not depend on it")
      ->check(CLI::IsMember({"avx2", "avx512"}));
  verb.add_option("--dump", line.dump, "print a stage instead of running: ast, flat, model or program")
      ->check(CLI::IsMember({"ast", "flat", "model", "program"}));
  verb.add_option("--checkpoint-interval", line.run.checkpoint_interval, "seconds between checkpoints")->check(CLI::PositiveNumber);
  verb.add_option("--interrupt-after", line.run.interrupt_after, "ask for an interruption at the n-th safe point")->group("");
  verb.add_flag("!--no-figures", line.run.figures, "leave figures as scripts");
  add_figures_option(verb, line);
  verb.add_flag("-q,--quiet", line.quiet, "no progress, no notices");
}

int main(int argument_count, char** arguments) {
  if (!supported_instruction_set()) {
    std::cerr << "sysid: this processor lacks AVX2 and FMA (x86-64-v3), which sysid needs\n";
    return code(ExitCode::internal);
  }
  CommandLine line;
  line.run.execution.threads = 0;
  CLI::App app{"sysid: Bayesian identification of nonlinear systems, from the equation as printed"};
  app.require_subcommand(1);
  app.fallthrough();
  app.add_option("--error-format", line.error_format, "text or json")->check(CLI::IsMember({"text", "json"}));
  int exit = 0;
  auto const runs = [&](char const* name, char const* summary, std::vector<std::string> verbs) {
    CLI::App* verb = app.add_subcommand(name, summary);
    add_run_options(*verb, line);
    verb->callback([&, verbs] {
      if (!line.instruction_set.empty())
        force_instruction_set(line.instruction_set == "avx2" ? InstructionSet::avx2 : InstructionSet::avx512);
      line.run.figure_formats = figure_formats(line.figures);
      exit = run(line, verbs);
    });
  };
  runs("run", "do all tasks of a file", {});
  runs("simulate", "do its simulate tasks: make data", {"simulate"});
  runs("fit", "do its fit tasks", {"fit"});
  runs("select", "do its select tasks: which candidate model, with which parameters", {"select"});
  runs("discover", "do its discover tasks: which equation, from the terms of a dictionary", {"discover"});
  runs("predict", "do its predict tasks, from stored draws", {"predict"});
  CLI::App* prompting =
      app.add_subcommand("repl", "a prompt for exploring: statements of the language, tasks, expressions over results");
  prompting->add_option("file", line.file, "a .sysid file to begin with");
  prompting->add_option("-o,--output", line.run.output, "folder for results (default: results)");
  prompting->add_flag("--force", line.run.force, "overwrite results of the same name that are there already");
  prompting->add_option("--seed", line.run.seed, "seed of tasks that state none (default: drawn, and written into them)");
  prompting->add_option("--threads", line.run.execution.threads, "threads (0: one per processor); results do not depend on it")
      ->check(CLI::Range(0, 1024));
  prompting->callback([&] { exit = repl::run_prompt(line.run, line.file); });
  CLI::App* checking = app.add_subcommand("check", "say what is wrong with a file and what its data can tell, before any sampling");
  checking->add_option("file", line.file, "the .sysid file")->required();
  checking->add_option("-o,--output", line.run.output, "folder for results, where simulate tasks leave data (default: results)");
  checking->add_option("--seed", line.run.seed, "seed of the prior draws, in place of the file's");
  checking->callback([&] { exit = check(line); });
  CLI::App* comparing = app.add_subcommand("compare", "set results of fits and predictions side by side: evidence and errors");
  comparing->add_option("results", line.files, "folders of tasks, or of whole runs")->required();
  comparing->callback([&] { exit = compare(line); });
  CLI::App* reporting = app.add_subcommand("report", "make the page of results anew, without fitting again");
  reporting->add_option("results", line.file, "the folder of a task, or of a whole run")->required();
  reporting->add_option("-o,--output", line.page, "the file to write (default: report.html in the folder)");
  reporting->add_flag("!--no-figures", line.run.figures, "leave figures out");
  add_figures_option(*reporting, line);
  reporting->callback([&] { exit = report(line); });
  CLI::App* exporting =
      app.add_subcommand("export", "write results for ArviZ and xarray (InferenceData in NetCDF-4), or a model as a Stan program");
  exporting
      ->add_option("results", line.topic, "folder of a fit or selection, or of a whole run; with --stan or --latex a .sysid file")
      ->required();
  CLI::Option* const stan = exporting->add_flag("--stan", line.stan, "write fits as Stan programs with their data");
  exporting->add_flag("--latex", line.latex, "print the models of a .sysid file as LaTeX for amsmath")->excludes(stan);
  exporting->add_option("-o,--output", line.run.output, "of a .sysid file: folder for results (default: results)");
  exporting->add_option("--model", line.file, "the .sysid file that the results are of (default: the one they were made from)");
  exporting->add_option("--draws", line.draws, "draws to simulate for likelihoods and predictions (0: only what is stored)")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  exporting->add_flag("--force", line.run.force, "replace files that are there");
  exporting->callback([&] { exit = export_results(line); });
  CLI::App* formatting = app.add_subcommand("fmt", "rewrite files in canonical layout");
  formatting->add_option("files", line.files, "the .sysid files; - reads standard input and writes standard output")->required();
  formatting->add_flag("--check", line.only_check, "change nothing; name the files that would change and exit with 1");
  formatting->callback([&] { exit = format(line); });
  CLI::App* listing = app.add_subcommand("list", "list functions, distributions, backends, discovery, solvers or modules");
  listing->add_option("what", line.topic, "functions, distributions, backends, discovery, solvers or modules")
      ->required()
      ->check(CLI::IsMember({"functions", "distributions", "kernels", "backends", "discovery", "solvers", "modules"}));
  listing->callback([&] { std::cout << list(line.topic); });
  CLI::App* explaining =
      app.add_subcommand("explain", "what the code of a message or a finding means, with an example and its mended twin");
  explaining->add_option("code", line.code, "a code such as E2001 or chains_disagree; none: list all");
  explaining->callback([&] { exit = explain(line); });
  CLI::App* documenting = app.add_subcommand("document", "print a module of the standard library as a page");
  documenting->add_option("module", line.topic, "a name of `sysid list modules`")->required();
  documenting->callback([&] { exit = document(line); });
  CLI::App* serving = app.add_subcommand("lsp", "serve an editor on standard input and output: the language server protocol");
  bool stdio = true;
  serving->add_flag("--stdio", stdio, "standard input and output; there is no other way");
  serving->callback([&] {
    std::ios::sync_with_stdio(false);  // so that what has come already can be told
    exit = lsp::serve(std::cin, std::cout);
  });
  CLI::App* version = app.add_subcommand("version", "print the version and the instruction set in use");
  version->callback([] { std::cout << fmt::format("sysid {} ({})\n", SYSID_VERSION, name(instruction_set())); });
  if (argument_count > 1 && arguments[1][0] != '-') {
    std::vector<std::string> verbs;
    for (CLI::App const* verb : app.get_subcommands({})) verbs.push_back(verb->get_name());
    if (std::find(verbs.begin(), verbs.end(), arguments[1]) == verbs.end()) {
      std::string const guess = did_you_mean(arguments[1], verbs);
      std::cerr << fmt::format("sysid: there is no verb `{}`; {}\n", arguments[1],
                               guess.empty() ? fmt::format("verbs: {}", fmt::join(verbs, ", ")) : guess);
      return code(ExitCode::usage);
    }
  }
  try {
    app.parse(argument_count, arguments);
  } catch (CLI::ParseError const& error) {
    return app.exit(error) == 0 ? 0 : code(ExitCode::usage);
  } catch (UserError const& error) {
    std::cerr << "sysid: " << error.what() << '\n';
    return code(ExitCode::usage);
  }
  std::cout.flush();
  if (!std::cout) {
    std::cerr << "sysid: cannot write to standard output\n";
    return code(ExitCode::io);
  }
  return exit;
}

}  // namespace
}  // namespace sysid

int main(int argument_count, char** arguments) { return sysid::main(argument_count, arguments); }
