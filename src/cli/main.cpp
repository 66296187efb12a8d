// The command line: a table of verbs in, an exit code out. What they do is in app/, exchange/, repl/ and lsp/.
#include "cli/command.hpp"
#include "cli/help.hpp"
#include "cli/usage.hpp"
#include "core/numeric/instruction_set.hpp"
#include "core/ranks/ranks.hpp"
#include "core/system/kept_memory.hpp"

namespace sysid::cli {
namespace {

constexpr char const *tasks = "Tasks of a file", *files = "Files", *results = "Results", *looking_up = "Reference";

constexpr Command commands[] = {
    {"run", tasks, "run all tasks of a file", &declare_tasks,
     "sysid run duffing.sysid\nsysid run duffing.sysid -o results/second --seed 2\nsysid run duffing.sysid --resume", true},
    {"simulate", tasks, "run the simulate tasks of a file: generate data", &declare_tasks, "sysid simulate duffing.sysid", true},
    {"fit", tasks, "run the fit tasks of a file", &declare_tasks,
     "sysid fit duffing.sysid --force\nsysid fit duffing.sysid --dump model", true},
    {"select", tasks, "run the select tasks of a file: choose among candidate models", &declare_tasks,
     "sysid select bouc_wen.sysid --quiet", true},
    {"discover", tasks, "run the discover tasks of a file: find equations from the terms of a dictionary", &declare_tasks,
     "sysid discover lorenz.sysid", true},
    {"predict", tasks, "run the predict tasks of a file, from stored draws", &declare_tasks, "sysid predict duffing.sysid --force",
     true},
    {"data", files, "describe a record: columns, rate, gaps, possible faults, and a data block that reads it", &declare_data,
     "sysid data bench.csv\nsysid data messung.mat --plot messung.svg"},
    {"check", files, "check a file, and report what its data can determine, before any sampling", &declare_check,
     "sysid check duffing.sysid\nsysid check duffing.sysid --error-format json"},
    {"calibrate", files, "test how often intervals contain the true values, on simulated records", &declare_calibrate,
     "sysid calibrate duffing.sysid\nsysid calibrate duffing.sysid --task posterior --replications 500 --seed 1", true},
    {"crosscheck", files, "fit with two back ends and compare the results", &declare_crosscheck,
     "sysid crosscheck duffing.sysid\nsysid crosscheck duffing.sysid --task posterior --against tempering", true},
    {"fmt", files, "rewrite files in canonical layout", &declare_format,
     "sysid fmt duffing.sysid\nsysid fmt --check models/*.sysid"},
    {"repl", files, "interactive prompt: enter statements, run tasks, compute with results", &declare_repl,
     "sysid repl\nsysid repl duffing.sysid --seed 1"},
    {"lsp", files, "run as a language server (LSP) for an editor, on standard input and output", &declare_lsp, ""},
    {"compare", results, "compare fits and predictions: evidence and errors", &declare_compare,
     "sysid compare results\nsysid compare results/linear results/cubic"},
    {"track", results, "follow the parameters of a fit along new rows, with alarms where one has changed", &declare_track,
     "sysid track beam.sysid results/posterior --rows 501..\nsysid track beam.sysid results/posterior --record today.csv --follow"},
    {"report", results, "write the report page of results again, without a new fit", &declare_report,
     "sysid report results/posterior\nsysid report results -o paper.html --figures pdf"},
    {"export", results, "write results for ArviZ and xarray, a fit as a Stan program, equations as LaTeX", &declare_export,
     "sysid export results --draws 1000\nsysid export duffing.sysid --stan\nsysid export duffing.sysid --latex"},
    {"list", looking_up, "list what the language provides: functions, distributions, backends, ...", &declare_list,
     "sysid list distributions"},
    {"explain", looking_up, "explain the code of a message or a finding, with an example", &declare_explain,
     "sysid explain E2103\nsysid explain chains_disagree"},
    {"document", looking_up, "print a module of the standard library as a page", &declare_document, "sysid document hysteresis"},
    {"manual", looking_up, "print the manual page of a command, or write the pages of all commands", &declare_manual,
     "sysid manual fit | man -l -\nsysid manual -o ~/.local/share/man/man1"},
    {"completion", looking_up, "print a script with which a shell completes commands and options", &declare_completion,
     "source <(sysid completion bash)\nsysid completion fish > ~/.config/fish/completions/sysid.fish"},
    {"version", looking_up, "print version, instruction set and MPI library", &declare_version, ""},
};

void add_verbs(CLI::App& app, Messages const& messages, ExitCode& exit) {
  for (Command const& command : commands) {
    CLI::App* const verb = app.add_subcommand(command.name, command.summary);
    verb->group(command.group)->footer(command.examples);
    verb->callback([work = command.declare(*verb), &messages, &exit, by_ranks = command.by_ranks] {
      if (by_ranks || ranks::launched().rank == 0) exit = guarded(messages, Source("sysid", ""), [&] { return work(messages); });
    });
  }
}

ExitCode main(int argument_count, char** arguments) {
  Messages messages;
  if (!supported_instruction_set()) {
    messages.complain("this processor lacks AVX2 and FMA (x86-64-v3), which sysid needs");
    return ExitCode::io;
  }
  CLI::App app{"sysid: Bayesian identification of nonlinear systems, from equations written as on paper"};
  app.formatter(std::make_shared<HelpPages>());
  app.set_help_flag("-h,--help", "print this page");
  app.set_version_flag("--version", &version_text, "print the version");
  app.require_subcommand(1)->fallthrough()->footer("sysid run models/duffing/duffing.sysid\nsysid report results");
  app.add_option_function<std::string>(
         "--error-format", [&](std::string const& format) { messages.json = format == "json"; }, "format of messages: text or json")
      ->type_name("FORMAT")
      ->check(CLI::IsMember({"text", "json"}))
      ->trigger_on_parse()
      ->default_str("text");
  ExitCode exit = ExitCode::success;
  add_verbs(app, messages, exit);
  try {
    app.parse(argument_count, arguments);
  } catch (CLI::CallForHelp const&) {
    std::cout << app.help();
  } catch (CLI::CallForVersion const&) {
    std::cout << version_text();
  } catch (CLI::ParseError const& error) {
    return ranks::launched().rank == 0 ? misread(messages, app, error) : exit;
  }
  std::cout.flush();
  if (!std::cout && exit != ExitCode::interrupted) {  // a terminal that is gone takes no output
    messages.complain("cannot write to standard output");
    return ExitCode::io;
  }
  return exit;
}

}  // namespace
}  // namespace sysid::cli

int main(int argument_count, char** arguments) {
  sysid::keep_freed_memory();
  return static_cast<int>(sysid::cli::main(argument_count, arguments));
}
