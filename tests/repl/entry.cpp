// What an entry is, and where its statements end.
#include "repl/work/entry.hpp"

#include <doctest/doctest.h>

#include "repl/workbench.hpp"
#include "syntax/entry.hpp"

using namespace sysid;
using repl::EntryPart;

namespace {

std::vector<EntryPart::Kind> kinds(std::string const& entry) {
  Diagnostics diagnostics;
  std::vector<EntryPart::Kind> result;
  for (EntryPart const& part : repl::parts_of(entry, diagnostics)) result.push_back(part.kind);
  return result;
}

/// Code and line:column of what is wrong with an entry.
std::string mistake(std::string const& entry) {
  Diagnostics diagnostics;
  repl::parts_of(entry, diagnostics);
  if (diagnostics.all().empty()) return "none";
  Diagnostic const& first = diagnostics.all().front();
  return first.code + " " + std::to_string(first.primary->span.begin);
}

}  // namespace

TEST_CASE("a statement goes on while something is open, or its line ends in what no statement ends in") {
  for (char const* text : {"model a {", "model a {\n input x [N]\n", "fit a to b with mh(samples =", "m*y'' +",
                           "k =", "parameter k ~", "fit a to", "fit a to b with", "mean(k", "fit a to b,"})
    CHECK_MESSAGE(unfinished(text), text);
  for (char const* text : {"", "# a comment (", "model a { }", "fit a to b with map", "mean(k)", "m*y'' + k*y = x", "k }",
                           "file \"a {\"", "posterior", "a = (1 + 2)"})
    CHECK_MESSAGE(!unfinished(text), text);
}

TEST_CASE("statements of an entry are told apart, blocks whole") {
  std::string const text =
      "use damping; model a {\n input x [N]; state y\n} # behind\nparameter k =\n 1\nmean(k); fit a to b\n  with map";
  std::vector<std::string> statements;
  for (Span const span : top_level_statements(text)) statements.push_back(text.substr(span.begin, span.end - span.begin));
  CHECK(statements == std::vector<std::string>{"use damping", "model a {\n input x [N]; state y\n}", "parameter k =\n 1", "mean(k)",
                                               "fit a to b\n  with map"});
}

TEST_CASE("statements in one line mean the same") {
  CHECK(in_one_line("model a {\n  input x [N]  # force\n\n  m*y'' +\n    k*y = x; state y\n}\n") ==
        "model a { input x [N]; m*y'' + k*y = x; state y }");
  CHECK(in_one_line("mean( k )") == "mean( k )");
}

TEST_CASE("each statement of the language and each expression is what it is in a file") {
  using enum EntryPart::Kind;
  CHECK(kinds("fit a to b with map") == std::vector{items});
  CHECK(kinds("posterior = fit a to b with map; model c { state y }") == std::vector{items, items});
  CHECK(kinds("parameter k [N/m] ~ log_uniform(1, 2)") == std::vector{model_statement});
  CHECK(kinds("m*y'' + k*y = x") == std::vector{model_statement});
  CHECK(kinds("observe d ~ normal(y, sd = 1)") == std::vector{model_statement});
  CHECK(kinds("measure d = y [mm]; split train = rows 1..50") == std::vector{data_statement, data_statement});
  CHECK(kinds("input x = force [N] hold linear") == std::vector{data_statement});
  CHECK(kinds("input x [N]") == std::vector{model_statement});
  CHECK(kinds("step 1 [ms]; step (1 [ms])") == std::vector{data_statement, data_statement});
  CHECK(kinds("step(0); step(0.5)*2") == std::vector{expression, expression});
  CHECK(kinds("quantile(fn, 0.95)") == std::vector{expression});
  CHECK(kinds("first.k - second.k") == std::vector{expression});
  CHECK(kinds("# nothing").empty());
}

TEST_CASE("a mistake is told as what the statement was meant to be, where it stands in the entry") {
  CHECK(mistake("posterior = fitt a to b") == "E1111 12");
  CHECK(mistake("mean(k); parameter k log_uniform(1, 2)") == "E1113 21");
  CHECK(mistake("mean(k") == "E1102 6");
  CHECK(mistake("modle a { }").substr(0, 5) == "E1110");
  CHECK(mistake("m*y'' + k y = x").substr(0, 5) == "E1105");
  CHECK(mistake("measure d y").substr(0, 5) == "E1101");
}

TEST_CASE("a command is a word and the rest of its line, and no operator follows it") {
  std::string arguments;
  auto const name = [&](char const* entry) {
    auto const* row = repl::command_of(entry, arguments);
    return row == nullptr ? std::string() : std::string(row->name);
  };
  CHECK(name("load models/a.sysid") == "load");
  CHECK(arguments == "models/a.sysid");
  CHECK(name("  help  log_uniform ") == "help");
  CHECK(arguments == "log_uniform");
  CHECK(name("?fit") == "help");
  CHECK(name("load ./a.sysid") == "load");
  CHECK(name("load = fit a to b with map") == "");
  CHECK(name("load*y'' = x") == "");
  CHECK(name("load * y'' = x") == "");
  CHECK(name("show(k)") == "");
  CHECK(name("exit") == "quit");
  CHECK(name("loads") == "");
}
