// calibrate, crosscheck: whether the posteriors of a file's fits are right for records that its model makes.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "app/calibration/calibrate.hpp"
#include "app/calibration/crosscheck.hpp"
#include "cli/command.hpp"
#include "cli/options.hpp"
#include "cli/spread.hpp"
#include "core/ranks/ranks.hpp"
#include "core/system/interrupt.hpp"
#include "core/system/progress_terminal.hpp"
#include "core/text/wrapped.hpp"
#include "inference/table.hpp"
#include "load/same_on_ranks.hpp"

namespace sysid::cli {
namespace {

void add_options(CLI::App& verb, ResultOptions& options, std::string& task) {
  add_result_options(verb, options);
  verb.add_option("--task", task, "the fit task (default: all fit tasks of the file)")->type_name("NAME");
}

ExitCode in_session(Messages const& messages, ResultOptions const& options, std::function<ExitCode(Session&)> const& work) {
  return with_checked_file(messages, options.file, [&](Source const& source, CheckedFile const& file, Diagnostics const&) {
    require_same_text(source);
    std::ostream nowhere(nullptr);
    SilentProgress silent;
    TerminalProgress terminal;
    LineOutput out(std::cout, wrapped_for(STDOUT_FILENO)), notices(std::cerr, wrapped_for(STDERR_FILENO));
    Session session(source, file, options.run, options.quiet || !ranks::leads() ? static_cast<Progress&>(silent) : terminal, out,
                    options.quiet ? nowhere : static_cast<std::ostream&>(notices));
    ExitCode const exit = work(session);
    if (options.quiet && exit == ExitCode::interrupted) std::cerr << "sysid: interrupted\n";
    return exit;
  });
}

ExitCode with_session(Messages const& messages, ResultOptions options, std::function<ExitCode(Session&)> const& work) {
  install_interrupt_handlers();
  return among_ranks(messages, options.run.execution.threads, [&] { return in_session(messages, options, work); });
}

}  // namespace

Work declare_calibrate(CLI::App& verb) {
  struct Options : ResultOptions {
    CalibrateOptions calibrate;
  };
  auto const options = std::make_shared<Options>();
  options->run.output = "results/calibrate";
  options->run.checkpoint_interval = 1;
  add_options(verb, *options, options->calibrate.task);
  verb.add_option("--replications", options->calibrate.replications, "number of records that are simulated and fitted")
      ->type_name("N")
      ->check(CLI::Range(10, 100000))
      ->capture_default_str();
  verb.add_flag("--resume", options->run.resume, "continue after an interruption; keep tasks that are complete");
  verb.add_option("--checkpoint-interval", options->run.checkpoint_interval, "time between checkpoints")
      ->type_name("SECONDS")
      ->check(refuse_no_duration)
      ->default_str("1");
  verb.add_option("--interrupt-after", options->run.interrupt_after, "interrupt after the n-th replication")->group("");
  return [options](Messages const& messages) {
    return with_session(messages, *options, [&](Session& session) { return calibrate(session, options->calibrate); });
  };
}

Work declare_crosscheck(CLI::App& verb) {
  struct Options : ResultOptions {
    CrosscheckOptions crosscheck;
  };
  auto const options = std::make_shared<Options>();
  options->run.output = "results/crosscheck";
  add_options(verb, *options, options->crosscheck.task);
  std::vector<std::string> names;
  for (BackendRow const& each : backends()) names.emplace_back(each.name);
  verb.add_option("--against", options->crosscheck.against, "the other back end (default: nuts for a fit by mh, else mh)")
      ->type_name("NAME")
      ->check([names](std::string const& name) { return refuse_other_name(name, names); },
              fmt::format("{{{}}}", fmt::join(names, ",")));
  return [options](Messages const& messages) {
    return with_session(messages, *options, [&](Session& session) { return crosscheck(session, options->crosscheck); });
  };
}

}  // namespace sysid::cli
