// repl, lsp: the verbs that stay until one leaves them.
#include "cli/command.hpp"
#include "cli/options.hpp"
#include "lsp/server.hpp"
#include "repl/prompt.hpp"

namespace sysid::cli {

Work declare_repl(CLI::App& verb) {
  struct Options {
    std::string file;
    RunOptions run;
  };
  auto const options = std::make_shared<Options>();
  verb.add_option("FILE", options->file, "a .sysid file to load first");
  add_output(verb, options->run.output);
  verb.add_flag("--force", options->run.force, "replace existing results");
  add_seed(verb, options->run.seed, "seed of tasks that state none (default: a random seed, which is written into the task)");
  options->run.execution.threads = 0;
  add_threads(verb, options->run.execution.threads);
  return [options](Messages const&) { return static_cast<ExitCode>(repl::run_prompt(options->run, options->file)); };
}

Work declare_lsp(CLI::App& verb) {
  auto const stdio = std::make_shared<bool>(true);
  verb.add_flag("--stdio", *stdio, "use standard input and output (the only mode)");
  return [stdio](Messages const&) {
    std::ios::sync_with_stdio(false);  // so that what has come already can be told
    return static_cast<ExitCode>(lsp::serve(std::cin, std::cout));
  };
}

}  // namespace sysid::cli
