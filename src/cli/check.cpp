// check: messages and a page about a file before any sampling.
#include <unistd.h>

#include <sstream>

#include "app/preflight/check_file.hpp"
#include "app/session/session.hpp"
#include "cli/command.hpp"
#include "cli/options.hpp"
#include "core/text/wrapped.hpp"
#include "diagnostics/verdict.hpp"
#include "report/page/check_page.hpp"

namespace sysid::cli {
namespace {

struct CheckOptions {
  std::string file;
  RunOptions run;
};

ExitCode fill_page(Messages const& messages, CheckOptions const& options, CheckPage& page) {
  return with_checked_file(messages, options.file, [&](Source const& source, CheckedFile const& file, Diagnostics const& said) {
    SilentProgress silent;
    std::ostream nowhere(nullptr);
    Session session(source, file, options.run, silent, nowhere, nowhere);
    CheckResult result = check_file(session);
    messages.show(result.diagnostics, source);
    for (Diagnostics const* each : {&said, static_cast<Diagnostics const*>(&result.diagnostics)})
      for (Diagnostic const& one : each->all()) ++(one.severity == Severity::error ? result.page.errors : result.page.warnings);
    page = std::move(result.page);
    if (!messages.json) std::cout << wrapped(check_text(page), terminal_columns(STDOUT_FILENO));
    if (result.diagnostics.has_errors()) return result.unreadable ? ExitCode::io : ExitCode::user_error;
    return grade(page) == Severity::error ? ExitCode::doubtful : ExitCode::success;
  });
}

ExitCode check(Messages const& messages, CheckOptions const& options) {
  CheckPage page;
  page.file = options.file;
  if (!messages.json) return fill_page(messages, options, page);
  std::ostringstream collected;  // they are a part of the page
  ExitCode const exit = fill_page({true, &collected}, options, page);
  std::cout << check_json(page, collected.str());
  return exit;
}

}  // namespace

Work declare_check(CLI::App& verb) {
  auto const options = std::make_shared<CheckOptions>();
  options->run.execution.threads = 0;
  add_file(verb, options->file);
  add_output(verb, options->run.output, "folder of results (`-o` of `run`) in which records of `simulate` tasks are looked for");
  add_seed(verb, options->run.seed, "seed of the prior draws, in place of the one in the file");
  return [options](Messages const& messages) { return check(messages, *options); };
}

}  // namespace sysid::cli
