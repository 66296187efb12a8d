// list, explain, document, version: information about the language and the program.
#include <fmt/format.h>
#include <unistd.h>

#include "app/catalogue/explain.hpp"
#include "app/catalogue/lists.hpp"
#include "app/catalogue/module_page.hpp"
#include "cli/command.hpp"
#include "core/numeric/instruction_set.hpp"
#include "core/ranks/ranks.hpp"
#include "core/text/diagnostic.hpp"
#include "core/text/words.hpp"
#include "core/text/wrapped.hpp"
#include "load/modules.hpp"

namespace sysid::cli {
namespace {

/// laid_out: for a terminal of so many columns.
ExitCode print(std::string const& text, std::string (*laid_out)(std::string_view, int)) {
  std::cout << laid_out(text, terminal_columns(STDOUT_FILENO));
  return ExitCode::success;
}

/// what: "message"; verb: the one that lists all there are, which are `known`.
ExitCode unknown(Messages const& messages, char const* what, std::string const& name, std::vector<std::string> const& known,
                 char const* verb) {
  std::string const guess = did_you_mean(name, known);
  messages.complain(fmt::format("there is no {} {}", what, name),
                    fmt::format("{}{}`sysid {}` lists them all", guess, guess.empty() ? "" : " ", verb));
  return ExitCode::usage;
}

}  // namespace

Work declare_list(CLI::App& verb) {
  auto const table = std::make_shared<std::string>();
  verb.add_option("TABLE", *table, list_topics())->required();
  return [table](Messages const& messages) {
    if (ListRow const* const row = find_list(*table)) return print(row->text(), &wrapped_rows);
    std::vector<std::string> topics;
    for (ListRow const& row : lists()) topics.emplace_back(row.name);
    std::string const guess = did_you_mean(*table, topics);
    messages.complain(fmt::format("there is no list of `{}`", *table),
                      guess.empty() ? fmt::format("there are lists of {}", quoted(topics)) : guess);
    return ExitCode::usage;
  };
}

Work declare_explain(CLI::App& verb) {
  auto const code = std::make_shared<std::string>();
  verb.add_option("CODE", *code, "code of a message or a finding, such as E2001 or chains_disagree; without it, all are listed");
  return [code](Messages const& messages) {
    if (code->empty()) return print(list_codes(), &wrapped_rows);
    std::optional<std::string> const page = explain(*code);
    return page ? print(*page, &filled) : unknown(messages, "message", *code, codes(), "explain");
  };
}

Work declare_document(CLI::App& verb) {
  auto const module = std::make_shared<std::string>();
  verb.add_option("MODULE", *module, "a module of `sysid list modules`")->required();
  return [module](Messages const& messages) {
    auto const page = module_page(*module);
    std::vector<std::string> module_names;
    for (LibraryModule const& each : library_modules()) module_names.emplace_back(each.name);
    return page ? print(*page, &filled) : unknown(messages, "module", *module, module_names, "list modules");
  };
}

std::string version_text() {
  std::string const mpi = ranks::mpi_library();
  return fmt::format("sysid {} ({}, {})\n", SYSID_VERSION, name(instruction_set()), mpi.empty() ? "no MPI" : mpi);
}

Work declare_version(CLI::App&) {
  return [](Messages const&) { return print(version_text(), &wrapped); };
}

}  // namespace sysid::cli
