// run, simulate, fit, select, discover, predict: the tasks of a file, or a stage of the compiler instead.
#include <fmt/format.h>
#include <unistd.h>

#include "app/disturbed/fit_disturbed.hpp"
#include "app/run/pipeline.hpp"
#include "cli/command.hpp"
#include "cli/options.hpp"
#include "cli/spread.hpp"
#include "core/numeric/instruction_set.hpp"
#include "core/ranks/ranks.hpp"
#include "core/system/interrupt.hpp"
#include "core/system/progress_terminal.hpp"
#include "core/text/wrapped.hpp"
#include "load/same_on_ranks.hpp"

namespace sysid::cli {
namespace {

struct TaskOptions : ResultOptions {
  std::string dump, instruction_set;
  bool with_disturbance = false;
};

/// Empty where the processor has it.
std::string refuse_instruction_set(std::string const& name) {
  if (narrowest_instruction_set == InstructionSet::neon)
    return name == "neon" ? ""
                          : fmt::format("this processor has no instruction set `{}`; its own, neon, gives identical results", name);
  if (name != "avx2" && name != "avx512") return fmt::format("`{}` is not an instruction set; choose avx2 or avx512", name);
  if (name == "avx512" && supported_instruction_set() != InstructionSet::avx512)
    return "this processor has no AVX-512 instructions; avx2 gives identical results";
  return "";
}

ExecutorKind executor_kind(std::string const& name) {
  for (ExecutorKind const kind : {ExecutorKind::scalar, ExecutorKind::lanes, ExecutorKind::native})
    if (sysid::name(kind) == name) return kind;
  return ExecutorKind::automatic;
}

void add_run_options(CLI::App& verb, TaskOptions& options) {
  add_result_options(verb, options);
  verb.add_flag("--resume", options.run.resume, "continue after an interruption; keep tasks that are complete")
      ->excludes(verb.get_option("--force"));
  verb.add_option("--lanes", options.run.execution.lanes,
                  "number of simulations in one batch, 0: automatic; results do not depend on it")
      ->type_name("N")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  verb.add_option_function<std::string>(
          "--executor", [&options](std::string const& name) { options.run.execution.executor = executor_kind(name); },
          "how simulations are computed: lanes (several at once), scalar (one at a time), native (compiled to machine code), or "
          "auto (native if it saves time); results do not "
          "depend on it")
      ->type_name("NAME")
      ->check(CLI::IsMember({"auto", "scalar", "lanes", "native"}))
      ->default_str("auto");
  verb.add_option("--instruction-set", options.instruction_set,
                  "avx2 or avx512 (default: the best available); results do not depend on it")
      ->type_name("NAME")
      ->check(refuse_instruction_set, "{avx2,avx512}");
  verb.add_option("--checkpoint-interval", options.run.checkpoint_interval, "time between checkpoints")
      ->type_name("SECONDS")
      ->check(refuse_no_duration)
      ->default_str("30");
  verb.add_option("--interrupt-after", options.run.interrupt_after, "interrupt the run at the n-th safe point")->group("");
  verb.add_option("--dump", options.dump,
                  "print the file as the compiler sees it and run nothing: ast (syntax tree), flat (parts and vectors written "
                  "out), model (first-order equations) or program (compiled form)")
      ->type_name("STAGE")
      ->check(CLI::IsMember({"ast", "flat", "model", "program"}));
}

ExitCode dump(Messages const& messages, TaskOptions const& options) {
  Source source = read_source(options.file);
  return guarded(messages, source, [&] {
    Diagnostics diagnostics;
    std::string const text = dump_stage(source, options.dump, diagnostics);
    messages.show(diagnostics, source);
    if (diagnostics.has_errors()) return ExitCode::user_error;
    std::cout << text;
    return ExitCode::success;
  });
}

ExitCode run_in_order(Messages const& messages, TaskOptions const& options, std::vector<std::string> const& kinds) {
  return with_checked_file(messages, options.file, [&](Source const& source, CheckedFile const& file, Diagnostics const&) {
    require_same_text(source);
    std::ostream nowhere(nullptr);
    SilentProgress silent;
    TerminalProgress terminal;
    LineOutput out(std::cout, wrapped_for(STDOUT_FILENO)), notices(std::cerr, wrapped_for(STDERR_FILENO));
    Progress& progress = options.quiet || !ranks::leads() ? static_cast<Progress&>(silent) : terminal;
    std::ostream& said = options.quiet ? nowhere : static_cast<std::ostream&>(notices);
    ExitCode const exit = options.with_disturbance ? fit_with_disturbance(source, file, options.run, progress, out, said)
                                                   : run_tasks(source, file, kinds, options.run, progress, out, said);
    // Nothing else may have said so: before the first draw there is no summary.
    if (options.quiet && exit == ExitCode::interrupted) std::cerr << "sysid: interrupted; --resume continues from there\n";
    return exit;
  });
}

ExitCode run(Messages const& messages, TaskOptions options, std::vector<std::string> const& kinds) {
  install_interrupt_handlers();  // a request that comes while the file is read stops the first task
  return among_ranks(messages, options.run.execution.threads, [&] { return run_in_order(messages, options, kinds); });
}

}  // namespace

Work declare_tasks(CLI::App& verb) {
  auto const options = std::make_shared<TaskOptions>();
  add_run_options(verb, *options);
  if (verb.get_name() == "fit")
    verb.add_flag("--with-disturbance", options->with_disturbance,
                  "also fit each model with a disturbance that was not measured, and compare both by their evidence")
        ->excludes(verb.get_option("--dump"));
  std::vector<std::string> kinds;  // none: all
  if (verb.get_name() != "run") kinds.push_back(verb.get_name());
  return [options, kinds](Messages const& messages) {
    if (!options->instruction_set.empty())
      force_instruction_set(options->instruction_set == "avx512" ? InstructionSet::avx512 : narrowest_instruction_set);
    return options->dump.empty() ? run(messages, *options, kinds) : dump(messages, *options);
  };
}

}  // namespace sysid::cli
