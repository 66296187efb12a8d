// Every kind of task has a row in each table over the kinds.
#include <doctest/doctest.h>

#include <set>

#include "app/run/task_runners.hpp"
#include "app/session/task_rows.hpp"
#include "check/checked/task_kinds.hpp"
#include "check/task/select_options.hpp"
#include "syntax/words.hpp"

using namespace sysid;

TEST_CASE("the kinds of tasks are the verbs of the language, each with a row of its own") {
  REQUIRE(task_kinds().size() == words::verbs.size());
  for (std::size_t i = 0; i < task_kinds().size(); ++i) {
    TaskKindRow const& row = task_kinds()[i];
    CAPTURE(row.verb);
    CHECK(static_cast<std::size_t>(row.kind) == i);
    CHECK(row.verb == words::verbs[i]);
    CHECK(find_task_kind(row.verb) == &row);
    CHECK(&row_of(row.kind) == &row);
    CHECK((row.preposition.empty() || words::contains(words::prepositions, row.preposition)));
    CHECK(!task_options(row.verb).empty());
  }
  CHECK(find_task_kind("guess") == nullptr);
}

TEST_CASE("a kind of task says what it reads and how it runs") {
  CHECK(task_rows().size() == task_kinds().size());
  CHECK(task_runners().size() == task_kinds().size());
  for (TaskKindRow const& kind : task_kinds()) {
    CAPTURE(kind.verb);
    TaskRow const& row = row_for(task_rows(), kind.kind);
    CHECK((row.experiments && row.data && row.name && row.digest && row.refusal && row.needs));
    TaskRunner const& runner = task_runner(kind.kind);
    CHECK((runner.run && runner.complete && runner.example));
    CHECK(runner.example({}).find(std::string(kind.verb) + " ") != std::string::npos);
  }
}

TEST_CASE("each option of select is written out as it is read") {
  SelectTask task;
  task.distance.text = "nmse";
  task.distance.channels = {"displacement", "force"};
  task.distance.weights = {1, 0.5};
  for (SelectOptionRow const& row : select_options()) {
    CAPTURE(row.option.name);
    std::string const start = std::string(row.option.name) + (row.call ? "(" : " = ");
    CHECK(row.option.usage.starts_with(start));
    CHECK(row.text(task).starts_with(start));
  }
  CHECK(select_options_text(task) == "distance = nmse, weights(displacement = 1, force = 0.5)");
}
