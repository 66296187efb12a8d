// The documentation is true: its snippets pass the checker, its commands exist, its output is what the program prints, its links
// lead somewhere. The first line of a fenced block says what it is:
//
//   ```sysid KIND                    text of the language; KIND says what stands around it (see `framed`)
//   ```sysid refused CODE KIND       the same, refused with that code
//   ```sysid saved as NAME           a whole file, which the reader saves under that name
//   ```sysid added to NAME           what the reader writes behind it
//   ```sh                            commands from the root of the repository
//   ```text from COMMAND             lines of what COMMAND prints, in order; a line of three dots leaves some out
//   ```cpp from FILE                 text of that file, word for word
//
// Pages that save files are followed, command by command (followed.cpp).
#include <doctest/doctest.h>

#include <algorithm>
#include <iterator>
#include <regex>

#include "app/preflight/check_file.hpp"
#include "app/record/record_text.hpp"
#include "app/run/pipeline.hpp"
#include "app/running.hpp"
#include "check/task/task_options.hpp"
#include "data/input_rule.hpp"
#include "distribution/distribution.hpp"
#include "function/table.hpp"
#include "gaussian_process/kernel.hpp"
#include "house/quoted_output.hpp"
#include "inference/table.hpp"
#include "regression/choice/selector.hpp"
#include "regression/column/columns.hpp"
#include "report/page/check_page.hpp"
#include "result/finding_table.hpp"
#include "solver/solver.hpp"
#include "syntax/words.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

std::vector<std::string> words_of(std::string const& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

// What stands around a snippet of each kind. in model: statements of an oscillator; data: data blocks of it; task: tasks with it.
std::optional<std::string> framed(std::string const& kind, std::string const& text) {
  static std::string const body =
      "input x [N]\nstate y [m]\ninitial y = 0, y' = 0\nparameter m [kg] ~ log_uniform(0.1, 10)\n"
      "parameter c [N s/m] ~ log_uniform(2, 200)\nparameter k [N/m] ~ log_uniform(1e3, 1e5)\n"
      "m*y'' + c*y' + k*y = x\nobserve displacement ~ normal(y, sd = 1e-6)\n";
  static std::string const model = "model oscillator {\n" + body + "}\n";
  static std::string const data =
      "data bench { file \"bench.csv\"; time t [s]; input x = x [N] hold zero_order; measure displacement = y [mm]\n"
      "split train = rows 1..500, test = rows 501..1500 }\n";
  if (kind == "file") return text;
  if (kind == "model") return "model example {\n" + text + "}\n";
  if (kind == "in model") return "model oscillator {\n" + body + text + "}\n";
  if (kind == "task") return model + data + text;
  if (kind == "task after posterior") return model + data + "posterior = fit oscillator to bench.train with mh\n" + text;
  if (kind == "data") {
    std::string all = model + text;
    std::regex const block("(^|\n)data (\\w+)");
    for (std::sregex_iterator i(text.begin(), text.end(), block), end; i != end; ++i)
      all += "check_" + (*i)[2].str() + " = fit oscillator to " + (*i)[2].str() + " with map\n";
    return all;
  }
  return std::nullopt;
}

// The file that a reader has before him who saved all blocks of its name up to this one.
std::optional<std::string> saved_until(Page const& page, Fence const& last) {
  std::string const name = saved_text(last)->name;
  std::string text;
  for (Fence const& block : page.blocks) {
    auto const saved = saved_text(block);
    if (saved && saved->name == name) text = (saved->behind ? text : "") + block.joined();
    if (block.line == last.line) break;
  }
  return text;
}

void check_snippet(Page const& page, Fence const& block) {
  std::string kind = block.info.substr(5), code;
  if (!kind.empty()) kind.erase(0, 1);
  if (kind.starts_with("refused ")) {
    code = kind.substr(8, 5);
    kind = kind.substr(std::min<std::size_t>(14, kind.size()));
  }
  auto const text = saved_text(block) ? saved_until(page, block) : framed(kind, block.joined());
  REQUIRE_MESSAGE(text, page.name << ":" << block.line << ": a snippet of no known kind: `" << kind << "`");
  Source source(page.name + ":" + std::to_string(block.line), *text);
  Diagnostics diagnostics;
  bool const passed = load(source, diagnostics).has_value();
  std::string const said = render(diagnostics, source, false);
  if (code.empty())
    CHECK_MESSAGE(passed, said);
  else
    CHECK_MESSAGE((!passed && said.find("[" + code + "]") != std::string::npos), source.name()
                                                                                     << " is not refused with " << code << "\n"
                                                                                     << said);
}

// Verbs and options as src/cli/ defines them.
struct KnownCommands {
  std::set<std::string> verbs, flags, options;
  KnownCommands() {
    std::string text;
    for (auto const& entry : fs::directory_iterator(root / "src/cli")) text += read_file(entry.path());
    auto const each = [&](char const* pattern, auto const& take) {
      std::regex const expression(pattern);
      for (std::sregex_iterator i(text.begin(), text.end(), expression), end; i != end; ++i) take((*i)[1].str());
    };
    auto const insert_names = [](std::set<std::string>& into, std::string const& names) {
      std::istringstream stream(names);
      for (std::string name; std::getline(stream, name, ',');) into.insert(name);
    };
    each("\\{\"(\\w+)\", (?:tasks|files|results|looking_up),", [&](std::string const& name) { verbs.insert(name); });
    each("\\{\"(--[a-z]+)\", \"", [&](std::string const& name) { flags.insert(name); });  // rows of exporters
    each("(?:add|set_help)_flag\\(\"!?(-[^\"]*)\"", [&](std::string const& names) { insert_names(flags, names); });
    each("add_option(?:_function<[^(]*>)?\\(\\s*\"(-[^\"]*)\"", [&](std::string const& names) { insert_names(options, names); });
  }
};

bool is_placeholder(std::string const& word) {
  return std::all_of(word.begin(), word.end(), [](char c) { return (c >= 'A' && c <= 'Z') || c == '_'; });
}

void check_command(Page const& page, std::string const& command) {
  static KnownCommands const known;
  std::vector<std::string> const words = words_of(command.substr(0, command.find_first_of("|>&;#")));
  std::string const where = page.name + ": `" + command + "`: ";
  CHECK_MESSAGE(words.size() > 1, where << "no verb");
  if (words.size() < 2) return;
  CHECK_MESSAGE((is_placeholder(words[1]) || known.verbs.contains(words[1])), where << "no such verb");
  for (std::size_t i = 2; i < words.size(); ++i) {
    if (words[i].starts_with("-")) {
      CHECK_MESSAGE((known.flags.contains(words[i]) || known.options.contains(words[i])), where << "no option " << words[i]);
      if (known.options.contains(words[i])) ++i;
    } else if (words[i].ends_with(".sysid")) {
      if (is_followed(page) && !fs::exists(root / words[i])) continue;  // saved or made by the reader
      if (words[i].starts_with("results/")) {                           // made by an earlier command of the page
        std::string const folder = fs::path(words[i]).parent_path().string();
        std::string const text = read_file(page.path), task = " -o " + fs::path(folder).parent_path().string() + "\n";
        CHECK_MESSAGE((text.find("mkdir -p " + folder) != std::string::npos || text.find(task) != std::string::npos),
                      where << "nothing makes " << folder);
        continue;
      }
      REQUIRE_MESSAGE(fs::exists(root / words[i]), where << "no file " << words[i]);
      Source source(words[i], read_file(root / words[i]));
      Diagnostics diagnostics;
      CHECK_MESSAGE(load(source, diagnostics), render(diagnostics, source, false));
    }
  }
}

}  // namespace

TEST_CASE("snippets of the language pass the checker or are refused as said") {
  int count = 0;
  each_block("sysid", [&](Page const& page, Fence const& block) {
    check_snippet(page, block);
    ++count;
  });
  CHECK(count > 20);
}

TEST_CASE("commands have verbs, options and files that exist") {
  int count = 0;
  std::regex const quoted("`(\\./sysid [^`]*)`");
  for (fs::path const& path : pages()) {
    Page const page = read_page(path);
    for (Fence const& block : page.blocks)
      for (std::string const& line : block.text)
        if (block.info.starts_with("sh") && line.starts_with("./sysid")) check_command(page, line), ++count;
    std::string prose;  // inline code may run over the end of a line
    for (std::string const& line : page.prose) prose += line + " ";
    for (std::sregex_iterator i(prose.begin(), prose.end(), quoted), end; i != end; ++i)
      check_command(page, (*i)[1].str()), ++count;
  }
  CHECK(count > 10);
}

TEST_CASE("quoted output is what the program prints") {
  int run = 0;
  each_block("text from ", [&](Page const& page, Fence const& block) {
    std::string const command = block.info.substr(10);
    std::vector<std::string> const words = words_of(command);
    INFO(page.name, ":", block.line);
    REQUIRE_MESSAGE((words.size() == 3 && words[0] == "./sysid"), "cannot run `" << command << "` for its output");
    if (words[1] == "run") {  // compared where that model is run (tests/app/golden_run.cpp)
      CHECK((words[2].starts_with("models/") && fs::exists(root / words[2])));
      ++run;
      return;
    }
    if (words[1] == "data") {  // tests run at the root, where such paths begin
      check_quotes(command, record_text(look_at_record(words[2])));
      return;
    }
    REQUIRE(words[1] == "check");
    TemporaryFolder const folder;
    Source source((root / words[2]).string(), read_file(root / words[2]));
    Diagnostics diagnostics;
    auto const file = load(source, diagnostics);
    REQUIRE_MESSAGE(file, render(diagnostics, source, false));
    RunOptions options;
    options.output = folder.path();
    SilentProgress progress;
    std::ostringstream out, notices;
    Session session(source, *file, options, progress, out, notices);
    check_quotes(command, check_text(check_file(session).page));
  });
  CHECK(run > 10);
}

TEST_CASE("quoted C++ stands in the file it is said to be from") {
  each_block("cpp from ", [](Page const& page, Fence const& block) {
    std::string const file = block.info.substr(9);
    REQUIRE_MESSAGE(fs::exists(root / file), page.name << ": no file " << file);
    CHECK_MESSAGE(read_file(root / file).find(block.joined()) != std::string::npos,
                  page.name << ":" << block.line << ": not in " << file);
  });
}

TEST_CASE("paths of sources in the text exist") {
  std::regex const path("`((?:src|tests|grammar|stdlib|models|docs)/[A-Za-z0-9_./-]+)`");
  // What the examples of the page on extensions add.
  std::set<std::string> const added = {"src/distribution/logistic.cpp", "src/gaussian_process/rational_quadratic.cpp",
                                       "src/inference/importance.cpp", "src/function/softplus.cpp", "src/solver/midpoint.cpp"};
  int count = 0;
  for (fs::path const& name : pages())
    for (std::string const& line : read_page(name).prose)
      for (std::sregex_iterator i(line.begin(), line.end(), path), end; i != end; ++i) {
        std::string const found = (*i)[1].str();
        if (found.find("NAME") != std::string::npos || found.find("VERB") != std::string::npos || added.contains(found)) continue;
        CHECK_MESSAGE(fs::exists(root / found), name.string() << ": no " << found);
        ++count;
      }
  CHECK(count > 50);
}

TEST_CASE("the reference names every word of every table, with its settings") {
  std::string const text = read_file(root / "docs/reference.md");
  auto const named = [&](std::string_view name, std::string const& kind) {
    std::regex const word("[^A-Za-z0-9_]" + std::string(name) + "[^A-Za-z0-9_]");
    CHECK_MESSAGE(std::regex_search(text, word), "docs/reference.md does not name the " << kind << " " << name);
  };
  for (DistributionRow const& row : distributions()) {
    named(row.name, "distribution");
    for (ArgumentRow const& argument : row.arguments)
      for (Spelling const& spelling : argument.spellings) named(spelling.name, "argument");
  }
  for (FunctionRow const& row : functions()) named(row.name, "function");
  for (gaussian_process::KernelRow const& row : gaussian_process::kernels()) named(row.name, "kernel");
  for (InputRuleRow const& row : input_rules()) named(row.name, "input rule");
  auto const with_settings = [&](auto const& rows, std::string const& kind) {
    for (auto const& row : rows) {
      named(row.name, kind);
      for (SettingRow const& setting : row.settings) named(setting.name, "setting of " + std::string(row.name));
    }
  };
  with_settings(backends(), "back end");
  with_settings(selectors(), "back end");
  with_settings(solvers(), "solver");
  with_settings(regression::selectors(), "selector");
  with_settings(regression::forms(), "form of derivatives");
  for (std::string_view const verb : words::verbs)
    for (std::string const& option : task_option_names(verb)) named(option, "option of " + std::string(verb));
  for (std::string_view const word : words::model_statements) named(word, "statement");
  for (std::string_view const word : words::data_statements) named(word, "statement");
  for (std::string_view const word : words::verbs) named(word, "verb");
}

TEST_CASE("findings that the methods page lists are rows of the table") {
  int count = 0;
  std::regex const code("`([a-z_]+)`");
  for (std::string const& line : read_page(root / "docs/methods/verdict.md").prose) {
    if (!line.starts_with("| error |") && !line.starts_with("| warning |") && !line.starts_with("| note |")) continue;
    for (std::sregex_iterator i(line.begin(), line.end(), code), end; i != end; ++i) {
      std::string const name = (*i)[1].str();
      if (find_backend(name) != nullptr) continue;
      auto const found = finding_code(name);
      CHECK_MESSAGE(found, "nothing finds " << name);
      ++count;
    }
  }
  CHECK(count > 15);
}

TEST_CASE("every case stands in the table of cases, shows a figure, quotes a run and says whose its data are") {
  std::string const table = read_file(root / "models/README.md");
  std::regex const picture("!\\[[^\\]]+\\]\\(([^)/]+\\.svg)\\)");
  for (auto const& entry : fs::directory_iterator(root / "models")) {
    if (!entry.is_directory()) continue;
    bool const runs = std::any_of(fs::directory_iterator(entry.path()), fs::directory_iterator(),
                                  [](fs::directory_entry const& file) { return file.path().extension() == ".sysid"; });
    if (!runs) continue;  // records that tests read
    std::string const name = entry.path().filename().string();
    CHECK_MESSAGE(table.find("(" + name + "/README.md)") != std::string::npos, "models/README.md leaves out " << name);
    Page const page = read_page(entry.path() / "README.md");
    std::string prose;
    for (std::string const& line : page.prose) prose += line + " ";
    bool const ours = prose.find("licence of the project ([BSD 3-Clause](../../LICENSE))") != std::string::npos;
    CHECK_MESSAGE((ours || prose.find("*Source*:") != std::string::npos), page.name << " does not say whose its data are");
    CHECK_MESSAGE(std::any_of(page.blocks.begin(), page.blocks.end(),
                              [&](Fence const& block) {
                                return block.info.starts_with("text from ./sysid run models/" + name + "/") &&
                                       block.joined().find("verdict: ") != std::string::npos;
                              }),
                  page.name << " quotes no verdict");
    std::sregex_iterator figure(prose.begin(), prose.end(), picture), end;
    CHECK_MESSAGE(figure != end, page.name << " shows no figure");
    for (; figure != end; ++figure) {
      std::string const file = (*figure)[1].str();
      REQUIRE_MESSAGE(fs::exists(entry.path() / file), page.name << ": no " << file);
      CHECK_MESSAGE(fs::file_size(entry.path() / file) < 150'000, file << " is too large for a page");
    }
  }
}

TEST_CASE("links lead to files and headings that exist") {
  int count = 0;
  std::regex const link("\\]\\(([^)\\s]+)\\)");
  for (fs::path const& path : pages()) {
    Page const page = read_page(path);
    for (std::string const& line : page.prose)
      for (std::sregex_iterator i(line.begin(), line.end(), link), end; i != end; ++i) {
        std::string const target = (*i)[1].str();
        if (target.find("://") != std::string::npos) continue;
        ++count;
        std::size_t const hash = target.find('#');
        fs::path const file = hash == 0 ? path : path.parent_path() / target.substr(0, hash);
        CHECK_MESSAGE(fs::exists(file), page.name << ": no " << target);
        if (hash != std::string::npos && fs::exists(file))
          CHECK_MESSAGE(anchors(file).contains(target.substr(hash + 1)), page.name << ": no heading " << target);
      }
  }
  CHECK(count > 10);
}

TEST_CASE("the README is the only page at the top") {
  for (fs::directory_entry const& entry : fs::directory_iterator(root))
    if (entry.path().extension() == ".md") CHECK(entry.path().filename() == "README.md");
}
