// The statements of a session and the names between them.
#include "repl/work/workspace.hpp"

#include <doctest/doctest.h>

using namespace sysid;
using namespace sysid::repl;

namespace {

WorkItem item(std::string const& text) {
  auto const tree = item_of(text);
  return {kind_of(tree), name_of(tree), "", text};
}

Workspace work(std::vector<std::string> const& statements) {
  Workspace work;
  for (std::string const& each : statements) work.put(item(each), {});
  return work;
}

}  // namespace

TEST_CASE("a file's statements keep the comments before and behind them") {
  std::string const text = "# head\n\nuse damping  # behind\n// next\nmodel a { }; fit a to b with map # last\n";
  auto const items = items_of(text);
  REQUIRE(items.size() == 3);
  CHECK(items[0].lead == "# head\n\n");
  CHECK(items[0].text == "use damping  # behind");
  CHECK(items[1].lead == "// next\n");
  CHECK(items[2].name == "fit_a");
  CHECK(items[2].text == "fit a to b with map # last");
  Workspace all;
  all.items = items;
  CHECK(all.text() == "# head\n\nuse damping  # behind\n// next\nmodel a { }\nfit a to b with map # last\n");
  CHECK(all.text().substr(all.begin(1), 7) == "model a");
}

TEST_CASE("a statement replaces that of its name; a task goes to the end while none refers to it") {
  Workspace w = work({"model a { }", "f = fit a to b with map", "data b { }"});
  w.put(item("model a { state y }"), {});
  CHECK(w.text() == "model a { state y }\nf = fit a to b with map\ndata b { }\n");
  w.put(item("f = fit a to b with ml"), {});
  CHECK(w.text() == "model a { state y }\ndata b { }\nf = fit a to b with ml\n");
  w.put(item("p = predict f on b"), {});
  w.put(item("f = fit a to b with map"), {});
  CHECK(w.text() == "model a { state y }\ndata b { }\nf = fit a to b with map\np = predict f on b\n");
  w.put(item("g = fit a to b with ml"), {});
  w.put(item("predict f, g on b"), {});
  CHECK(w.items.back().name == "predict_f_g");
  w.put(item("g = fit a to b with map"), {});  // it stays before what refers to it
  CHECK(
      w.text() ==
      "model a { state y }\ndata b { }\nf = fit a to b with map\np = predict f on b\ng = fit a to b with map\npredict f, g on b\n");
}

TEST_CASE("what a task was run on stays with it when it changes, and goes when nothing refers to it any more") {
  Workspace w = work({"model spring { }", "model rig { part s = spring() }", "candidates set { rig; spring }", "data b { }",
                      "f = fit rig to b with map", "g = fit rig to b with ml", "s = select set to b with abc_smc"});
  auto const notices = w.put(item("model spring { state y }"), {"f"});
  CHECK(notices.size() == 1);
  CHECK(w.text() ==
        "model spring_1 { }\nmodel spring { state y }\nmodel rig_1 { part s = spring_1() }\nmodel rig { part s = spring() }\n"
        "candidates set { rig; spring }\ndata b { }\nf = fit rig_1 to b with map\ng = fit rig to b with ml\ns = select set to b "
        "with abc_smc\n");
  CHECK(w.items[w.find("spring_1")].kept_of == "spring");
  CHECK(w.items[w.find("rig_1")].kept_of == "rig");
  CHECK(w.items[w.find("rig")].kept_of.empty());
  w.put(item("f = fit rig to b with map"), {"f"});
  w.prune();
  CHECK(w.find("spring_1") == w.items.size());
  CHECK(w.find("rig_1") == w.items.size());
  CHECK(w.find("rig") < w.items.size());
}

TEST_CASE("nothing is kept of what no task was run on, and nothing changes where the text is the same") {
  Workspace w = work({"model a { }", "data b { }", "f = fit a to b with map"});
  CHECK(w.put(item("model a { state y }"), {}).empty());
  CHECK(w.put(item("model a { state y }"), {"f"}).empty());
  CHECK(w.items.size() == 3);
  CHECK(w.put(item("data b { rate 1 [Hz] }"), {"f"}).size() == 1);
  CHECK(w.items.back().text == "f = fit a to b_1 with map");
}

TEST_CASE("a fit without a name keeps what it was called when its model goes on under another name") {
  Workspace w = work({"model a { }", "data b { }", "fit a to b with map"});
  CHECK(w.put(item("model a { state y }"), {"fit_a"}).size() == 1);
  CHECK(w.items.back().text == "fit_a = fit a_1 to b with map");
  CHECK(w.items.back().name == "fit_a");
  // One with a name has it already.
  Workspace named = work({"model a { }", "data b { }", "f = fit a to b with map"});
  named.put(item("model a { state y }"), {"f"});
  CHECK(named.items.back().text == "f = fit a_1 to b with map");
}

TEST_CASE("paths of data go with the file") {
  Workspace w = work({"data b { file \"../records/b.csv\"; rate 1 [Hz] }", "data c { file \"/tmp/c.csv\" }"});
  w.path = "/home/a/models/duffing/work.sysid";
  w.move_to("/home/a/work.sysid");
  CHECK(w.items[0].text == "data b { file \"models/records/b.csv\"; rate 1 [Hz] }");
  CHECK(w.items[1].text == "data c { file \"/tmp/c.csv\" }");
}
