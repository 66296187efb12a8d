// No word without help.
#include "repl/help.hpp"

#include <doctest/doctest.h>

#include <iterator>
#include <set>
#include <sstream>

#include "check/dictionary/generators.hpp"
#include "check/task/task_options.hpp"
#include "distribution/distribution.hpp"
#include "function/table.hpp"
#include "gaussian_process/kernel.hpp"
#include "inference/table.hpp"
#include "regression/choice/selector.hpp"
#include "regression/column/columns.hpp"
#include "repl/statistics.hpp"
#include "repl/workbench.hpp"
#include "solver/solver.hpp"
#include "syntax/words.hpp"

using namespace sysid;

TEST_CASE("every word of the language, every setting and every code of a message has help") {
  std::set<std::string> words;
  auto const add = [&](auto const& table) {
    for (auto const& each : table) words.insert(std::string(each));
  };
  auto const add_rows = [&](auto const& rows) {
    for (auto const& row : rows) words.insert(std::string(row.name));
  };
  auto const add_settings = [&](auto const& rows) {
    for (auto const& row : rows) {
      words.insert(std::string(row.name));
      add_rows(row.settings);
    }
  };
  add(words::reserved), add(words::items), add(words::verbs), add(words::prepositions), add(words::task_words);
  add(words::model_statements), add(words::model_words), add(words::data_statements), add(words::data_words);
  add(words::candidate_words), add(words::dictionary_statements);
  add_rows(functions()), add_rows(distributions()), add_rows(gaussian_process::kernels()), add_rows(generators());
  add_settings(backends()), add_settings(selectors()), add_settings(solvers());
  add_settings(regression::selectors()), add_settings(regression::forms());
  add_rows(repl::commands()), add_rows(repl::prompt_functions());
  for (std::string_view const verb : words::verbs)
    for (std::string const& option : task_option_names(verb)) words.insert(option);
  for (char const* other : {"E2103", "2103", "chains_disagree", "hysteresis", "plot", "trace"}) words.insert(other);
  CHECK(words.size() > 150);
  for (std::string const& word : words) CHECK_MESSAGE(repl::help_on(word).has_value(), word);
  CHECK_FALSE(repl::help_on("frobnicate").has_value());
}

TEST_CASE("on a narrow screen help is laid out anew, and nothing of it is lost") {
  auto const words = [](std::string const& text) {
    std::istringstream in(text);
    return std::vector<std::string>(std::istream_iterator<std::string>(in), {});
  };
  for (char const* word : {"refit", "E2103", "mh", "fit", "hysteresis", "log_normal", "plot"}) {
    CAPTURE(word);
    std::string const whole = *repl::help_on(word), narrow = *repl::help_on(word, 60);
    CHECK(whole != narrow);
    CHECK((words(whole) == words(narrow)));
  }
  std::string const overview = repl::help_overview(60);
  CHECK((words(overview) == words(repl::help_overview())));
  std::istringstream lines(overview);
  for (std::string line; std::getline(lines, line);) CHECK_MESSAGE(line.size() <= 60, line);
  // An equation stays whole.
  CHECK(repl::help_on("hysteresis", 60)->find("alpha*abs(displacement')*abs(z)^(n - 1)*z - beta*displacement'*abs(z)^n\n") !=
        std::string::npos);
}

TEST_CASE("help on a word says how it is written, and what it does") {
  CHECK(repl::help_on("log_uniform")->find("log_uniform(lower, upper)") != std::string::npos);
  CHECK(repl::help_on("burn_in")->find("burn_in of mh") != std::string::npos);
  CHECK(repl::help_on("e2103")->find("E2103") == 0);
}
