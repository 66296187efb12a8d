// Every request that the server claims, by a scripted client.
#include <doctest/doctest.h>

#include "client.hpp"
#include "core/system/files.hpp"
#include "load/modules.hpp"
#include "syntax/format.hpp"
#include "temporary_folder.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

std::string const text = R"(# an oscillator
use hysteresis

function cubed(a) = a^3

model oscillator "driven" {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter β [N/m] ~ log_uniform(1e3, 1e5)   # 𝛼 stands here
  parameter m [kg] = 1
  parameter k3 [N/m^3] ~ normal(0, sd = 1e9)
  parameter sigma [mm] ~ half_normal(1)
  part joint = bouc_wen(n = 1, displacement = y)
  let speed = y'
  m*y'' + 20 [N s/m]*speed + β*y + k3*cubed(y) + joint.force = x
  observe displacement ~ normal(y, sd = sigma)
}

data bench {
  file "bench.csv"
  time t [s]
  input x = force [N] hold zero_order
  measure displacement = y [mm]
  split train = rows 1..3, test = rows 4..4
}

posterior = fit oscillator to bench.train with mh(samples = 10000, chains = 2), seed = 1
refined = fit oscillator to bench.train with map, search = near(posterior), seed = 1
forecast = predict posterior on bench.test with draws(20)
both = predict refined, posterior on bench.test with draws(20)
)";

struct Bench {
  TemporaryFolder folder;
  Client client;
  Bench() {
    write_file(folder.path() / "bench.csv", "t,force,y\n0,1,0\n0.1,1,0.1\n0.2,1,0.2\n0.3,1,0.1\n");
    client.open((folder.path() / "bench.sysid").string(), text);
  }
  std::size_t find(std::string const& what, std::size_t more = 0) const {
    std::size_t const at = text.find(what);
    REQUIRE(at != std::string::npos);
    return at + more;
  }
  std::string hover(std::string const& what, std::size_t more = 0) {
    Json const found = client.at("hover", text, find(what, more));
    return found.is_null() ? "" : found.at("contents").at("value").get<std::string>();
  }
};

bool contains(std::string const& whole, std::string const& part) { return whole.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("a sound file has no errors; a mistake is published with code, range, related place and help, and goes when mended") {
  Bench bench;
  for (Json const& each : bench.client.diagnostics) CHECK(each.at("severity") != 1);
  std::size_t const at = bench.find("β*y +");
  bench.client.edit(text, {static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(at + 4)}, "β");
  REQUIRE(!bench.client.diagnostics.empty());
  std::string changed = text;
  changed.replace(at, 4, "β");
  Json const found = bench.client.diagnostics.front();
  CHECK(found.at("code") == "E2103");
  CHECK(text_of(changed, found.at("range")) == "β");
  CHECK(found.at("relatedInformation").size() == 1);
  CHECK(contains(found.at("message"), "help: multiply this by"));
  CHECK_FALSE(found.contains("codeDescription"));
  bench.client.edit(changed, {static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(at + 2)}, "β*y");
  for (Json const& each : bench.client.diagnostics) CHECK(each.at("severity") != 1);
}

TEST_CASE("data that the file names are read, too") {
  Bench bench;
  std::string wrong = text;
  wrong.replace(bench.find("= force"), 7, "= forces");
  bench.client.replace(wrong);
  REQUIRE(bench.client.diagnostics.size() >= 1);
  CHECK(text_of(wrong, bench.client.diagnostics.front().at("range")).starts_with("forces"));
}

TEST_CASE("hover says what a name is, its unit and its definition") {
  Bench bench;
  std::string const beta = bench.hover("β*y +");
  CHECK(contains(beta, "parameter β [N/m] ~ log_uniform(1e3, 1e5)"));
  CHECK(contains(beta, "parameter of model `oscillator`"));
  CHECK(contains(beta, "unit: `[N/m]`"));
  CHECK(contains(bench.hover("y'' +"), "`y''`: `["));
  CHECK(contains(bench.hover("speed + "), "unit: `["));  // not declared: found
  CHECK(contains(bench.hover("cubed(y)"), "function cubed(a) = a^3"));
  CHECK(contains(bench.hover("log_uniform"), "log_uniform(lower, upper)"));
  CHECK(contains(bench.hover("mh(samples", 1), "samples = 25000"));
  CHECK(contains(bench.hover("samples = 10000"), "by default 25000"));
  CHECK(contains(bench.hover("draws(20)"), "posterior draws"));
  CHECK(contains(bench.hover("hysteresis"), "standard library"));
  CHECK(contains(bench.hover("joint.force", 7), "derive force [N] = z"));
  CHECK(contains(bench.hover("displacement = y [mm]"), "channel of model"));
  CHECK(contains(bench.hover("force [N] hold"), "column `force`"));
  CHECK(bench.hover("# an").empty());
}

TEST_CASE("definitions, references and highlights go by meaning") {
  Bench bench;
  auto const defined = [&](std::string const& what, std::size_t more = 0) {
    Json const all = bench.client.at("definition", text, bench.find(what, more));
    return all.is_array()
               ? text_of(text, all.front().at("range")) + "@" + std::to_string(span_of(text, all.front().at("range")).begin)
               : std::string();
  };
  CHECK(defined("β*y +") == "β@" + std::to_string(bench.find("β [N/m]")));
  CHECK(defined("displacement = y [mm]") == "displacement@" + std::to_string(bench.find("observe displacement", 8)));
  CHECK(defined("train with") == "train@" + std::to_string(bench.find("split train", 6)));
  CHECK(defined("posterior on") == "posterior@" + std::to_string(bench.find("posterior =")));
  CHECK(defined("cubed(y)") == "cubed@" + std::to_string(bench.find("cubed(a)")));
  Json const file = bench.client.at("definition", text, bench.find("\"bench.csv\"", 3));
  CHECK(file.at("uri").get<std::string>().ends_with("bench.csv"));

  Json const uses = bench.client.at("references", text, bench.find("x [N]"), {{"context", {{"includeDeclaration", true}}}});
  CHECK(uses.size() == 3);  // declared, in the equation, bound to the column
  CHECK(bench.client.at("references", text, bench.find("x [N]"), {{"context", {{"includeDeclaration", false}}}}).size() == 2);
  Json const marks = bench.client.at("documentHighlight", text, bench.find("sigma)"));
  REQUIRE(marks.size() == 2);
  for (Json const& each : marks) CHECK(text_of(text, each.at("range")) == "sigma");
}

TEST_CASE("renaming changes every place of the meaning and no other, and refuses what would capture") {
  Bench bench;
  auto const renamed = [&](std::string const& what, std::string const& name) {
    Json const result = bench.client.at("rename", text, bench.find(what), {{"newName", name}});
    if (result.is_null()) return std::string();
    std::string changed = text;
    Json const edits = result.at("changes").at(bench.client.uri);
    for (auto edit = edits.rbegin(); edit != edits.rend(); ++edit) {
      Span const span = span_of(text, edit->at("range"));
      changed.replace(span.begin, span.end - span.begin, edit->at("newText"));
    }
    return changed;
  };
  Json const prepared = bench.client.at("prepareRename", text, bench.find("β*y +"));
  CHECK(prepared.at("placeholder") == "β");
  std::string const stiff = renamed("β*y +", "stiffness");
  CHECK(contains(stiff, "parameter stiffness [N/m] ~"));
  CHECK(contains(stiff, "+ stiffness*y +"));
  CHECK_FALSE(contains(stiff, "β"));
  std::string const drive = renamed("x [N]", "drive");
  CHECK(contains(drive, "input drive [N]"));
  CHECK(contains(drive, "input drive = force [N]"));
  CHECK(contains(drive, "= drive\n"));
  CHECK(contains(renamed("bench.train", "rig"), "data rig {"));
  std::string const result = renamed("posterior on", "result");
  CHECK((contains(result, "predict result on") && contains(result, "near(result)")));
  CHECK(contains(result, "predict refined, result on"));

  for (auto const& [what, name] : std::vector<std::pair<std::string, std::string>>{{"β*y +", "m"},
                                                                                   {"β*y +", "if"},
                                                                                   {"β*y +", "2k"},
                                                                                   {"β*y +", ""},
                                                                                   {"β*y +", "a b"},
                                                                                   {"log_uniform", "wide"},
                                                                                   {"force [N] hold", "power"},
                                                                                   {"joint = ", "speed"},
                                                                                   {"a^3", "cubed(b)"}}) {
    CAPTURE(what);
    CAPTURE(name);
    CHECK(renamed(what, name).empty());
    CHECK(bench.client.error.at("message").get<std::string>().find('`') != std::string::npos);
  }
  // A function that reads a name of its model would read its own argument.
  std::string const capture =
      "model a {\n  state z\n  initial z = 0\n  parameter k = 1\n  function f(b) = k*b\n  z' = f(z)\n  observe c ~ normal(z, sd = "
      "1)\n}\n";
  bench.client.replace(capture);
  CHECK(bench.client.at("rename", capture, capture.find("k*b"), {{"newName", "b"}}).is_null());
  CHECK(bench.client.error.at("message").get<std::string>().find("`b` is already used") != std::string::npos);
  CHECK_FALSE(bench.client.at("rename", capture, capture.find("k*b"), {{"newName", "d"}}).is_null());
}

TEST_CASE("a name of a module beside the file is renamed in all files that use it, and from there") {
  TemporaryFolder folder;
  std::string const module =
      "model spring {\n  input u [m]\n  parameter k [N/m] ~ log_uniform(1, 10)\n  derive force [N] = k*u\n}\n";
  std::string const user =
      "use springs\nmodel a {\n  state y [m]\n  initial y = 0, y' = 0\n  part s = spring(u = y)\n  1 [kg]*y'' + s.force + s.k*y = "
      "0\n  observe c ~ normal(y, sd = 1)\n}\n";
  write_file(folder.path() / "springs.sysid", module);
  write_file(folder.path() / "user.sysid", user);
  Client client;
  client.open((folder.path() / "user.sysid").string(), user);
  Json const found = client.at("definition", user, user.find("k*y"));
  CHECK(found.front().at("uri").get<std::string>().ends_with("springs.sysid"));
  Json const from_user = client.at("rename", user, user.find("k*y"), {{"newName", "stiffness"}});
  REQUIRE(from_user.is_object());
  CHECK(from_user.at("changes").size() == 2);
  client.open((folder.path() / "springs.sysid").string(), module);
  Json const from_module = client.at("rename", module, module.find("k*u"), {{"newName", "stiffness"}});
  CHECK(from_module == from_user);
  // What is open and not saved counts.
  client.replace("model other {\n  state z\n  initial z = 0\n  z' = -z\n  observe c ~ normal(z, sd = 1)\n}\n");
  client.uri = lsp::uri_of((folder.path() / "user.sysid").string());
  client.notify("textDocument/didChange",
                {{"textDocument", {{"uri", client.uri}, {"version", 9}}}, {"contentChanges", {{{"text", user}}}}});
  client.request("textDocument/documentSymbol", {{"textDocument", {{"uri", client.uri}}}});
  CHECK(!client.diagnostics.empty());
}

TEST_CASE("texts of a client that counts no versions are read") {
  std::string const right = "model a {\n  state y\n  initial y = 1\n  y' = -y\n  observe c ~ normal(y, sd = 1)\n}\n";
  std::string const wrong = "model a {\n  state y\n}\n";
  for (Json const& version : {Json(nullptr), Json("first")}) {
    Client client;
    client.uri = lsp::uri_of("uncounted.sysid");
    client.notify("textDocument/didOpen",
                  {{"textDocument", {{"uri", client.uri}, {"languageId", "sysid"}, {"version", version}, {"text", right}}}});
    client.settle();
    CHECK(client.diagnostics.empty());
    client.notify("textDocument/didChange",
                  {{"textDocument", {{"uri", client.uri}, {"version", version}}}, {"contentChanges", {{{"text", wrong}}}}});
    client.settle();
    CHECK(!client.diagnostics.empty());
  }
}

TEST_CASE("what a module says counts for the files that use it when it is opened, changed and closed") {
  TemporaryFolder folder;
  auto const model = [](std::string const& name) {
    return "model " + name + " {\n  input u [m]\n  parameter k [N/m] ~ log_uniform(1, 1e5)\n  derive force [N] = k*u\n}\n";
  };
  auto const path = [&](std::string const& name) { return (folder.path() / name).string(); };
  write_file(folder.path() / "springs.sysid", model("spring"));
  std::string const user =
      "use springs\nmodel rig {\n  input x [N]\n  state y [m]\n  initial y = 0, y' = 0\n  part s = spring(u = y)\n"
      "  1 [kg]*y'' + s.force = x\n  observe d ~ normal(y, sd = 1 [mm])\n}\n";
  Client client;
  client.open(path("rig.sysid"), user);
  std::string const uri = client.uri;
  CHECK(client.diagnostics.empty());
  // What an editor does beside it, and what the file is said to be then.
  auto const said_after = [&](std::string const& method, std::string const& of, Json params) {
    params["textDocument"]["uri"] = lsp::uri_of(path(of));
    client.notify("textDocument/" + method, std::move(params));
    client.settle();
    return client.diagnostics.size();
  };
  auto const text = [](std::string const& content) { return Json{{"textDocument", {{"text", content}, {"version", 1}}}}; };
  CHECK(said_after("didOpen", "springs.sysid", text(model("sprung"))) > 0);
  CHECK(said_after("didChange", "springs.sysid", {{"contentChanges", {{{"text", model("spring")}}}}}) == 0);
  CHECK(said_after("didChange", "springs.sysid", {{"contentChanges", {{{"text", model("sprung")}}}}}) > 0);
  CHECK(said_after("didClose", "springs.sysid", Json::object()) == 0);
  CHECK(client.uri == uri);

  // A module that no file holds yet.
  client.open(path("second.sysid"), "use dampers\n" + user);
  CHECK_FALSE(client.diagnostics.empty());
  CHECK(said_after("didOpen", "dampers.sysid", text(model("damper"))) == 0);
  CHECK(said_after("didClose", "dampers.sysid", Json::object()) > 0);
}

TEST_CASE("formatting is that of fmt, and nothing for a file with mistakes") {
  Bench bench;
  Json const edits =
      bench.client.request("textDocument/formatting", {{"textDocument", {{"uri", bench.client.uri}}}, {"options", Json::object()}});
  REQUIRE(edits.size() == 1);
  std::string changed = text;
  Span const span = span_of(text, edits.front().at("range"));
  changed.replace(span.begin, span.end - span.begin, edits.front().at("newText"));
  Diagnostics none;
  CHECK(changed == *formatted(Source("", text), none));
  bench.client.replace(changed);
  CHECK(bench.client.request("textDocument/formatting", {{"textDocument", {{"uri", bench.client.uri}}}}) == Json::array());
  bench.client.replace(text + "model {");
  CHECK(bench.client.request("textDocument/formatting", {{"textDocument", {{"uri", bench.client.uri}}}}).is_null());
}

TEST_CASE("the outline has blocks with what they declare, ranges around their names") {
  Bench bench;
  Json const all = bench.client.request("textDocument/documentSymbol", {{"textDocument", {{"uri", bench.client.uri}}}});
  std::vector<std::string> names;
  for (Json const& each : all) names.push_back(each.at("name"));
  std::sort(names.begin(), names.end());
  CHECK(names == std::vector<std::string>{"bench", "both", "cubed", "forecast", "oscillator", "posterior", "refined"});
  auto const check = [&](auto const& self, Json const& one) -> void {
    Span const whole = span_of(text, one.at("range")), name = span_of(text, one.at("selectionRange"));
    CHECK((whole.begin <= name.begin && name.end <= whole.end));
    CHECK(text_of(text, one.at("selectionRange")) == one.at("name"));
    if (one.contains("children"))
      for (Json const& inner : one.at("children")) self(self, inner);
  };
  for (Json const& each : all) check(check, each);
}

TEST_CASE("of a text that cannot be read the last one that could serves hover, and what is readable serves completion") {
  Bench bench;
  bench.client.at("hover", text, 0);
  std::string const broken = text + "\nmodel next {\n  parameter q [m] ~ normal(0, sd = 1)\n  let r = q + \n";
  bench.client.replace(broken);
  CHECK(!bench.client.diagnostics.empty());
  CHECK(bench.client.at("hover", broken, bench.find("β*y +")).is_object());
  CHECK(has(labels(bench.client.at("completion", broken, broken.size() - 1)), "q"));
  // Two blocks run into each other: there is no tree at all.
  std::string spoilt = text;
  spoilt.erase(bench.find("}\n\ndata"), 1);
  bench.client.replace(spoilt);
  Json const hover = bench.client.at("hover", spoilt, bench.find("β*y +"));
  REQUIRE(hover.is_object());
  CHECK(contains(hover.at("contents").at("value"), "parameter β"));
}

TEST_CASE("every capability is answered, and nothing else is claimed") {
  Bench bench;
  std::vector<std::string> claimed;
  for (auto const& [name, value] : bench.client.capabilities.items()) claimed.push_back(name);
  CHECK(claimed == std::vector<std::string>{"completionProvider", "definitionProvider", "documentFormattingProvider",
                                            "documentHighlightProvider", "documentSymbolProvider", "hoverProvider",
                                            "positionEncoding", "referencesProvider", "renameProvider", "textDocumentSync"});
  for (char const* method : {"hover", "completion", "definition", "documentHighlight", "prepareRename"}) {
    bench.client.at(method, text, bench.find("β*y +"));
    CHECK(bench.client.error.is_null());
  }
  bench.client.notify("textDocument/didClose", {{"textDocument", {{"uri", bench.client.uri}}}});
  CHECK(bench.client.diagnostics.empty());
  bench.client.at("hover", text, 0);
  CHECK(bench.client.error.at("code") == lsp::invalid_params);
}
