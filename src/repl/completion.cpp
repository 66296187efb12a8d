// The language server completes what a file may contain; the prompt adds its commands and the names of results.
#include "repl/completion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>

#include "assist/completion.hpp"
#include "core/text/utf8.hpp"
#include "repl/help.hpp"
#include "repl/statistics.hpp"
#include "syntax/words.hpp"

namespace sysid::repl {
namespace {

using Words = std::vector<std::string>;

void append(Words& words, auto const& more) {
  for (auto const& each : more) words.emplace_back(each);
}

/// Files and folders that continue a path; folders end in /.
Words files(std::string const& path, std::string_view extension) {
  auto const slash = path.rfind('/');
  std::string const folder = slash == std::string::npos ? "" : path.substr(0, slash + 1);
  std::filesystem::path where = folder;
  if (folder.starts_with("~/") && std::getenv("HOME") != nullptr)
    where = std::filesystem::path(std::getenv("HOME")) / folder.substr(2);
  Words words;
  std::error_code failed;
  for (auto const& entry : std::filesystem::directory_iterator(where.empty() ? "." : where, failed)) {
    std::string const name = entry.path().filename().string();
    std::error_code ignored;
    bool const is_folder = entry.is_directory(ignored);
    if (name.starts_with('.') || (!is_folder && !name.ends_with(extension))) continue;
    words.push_back(folder + name + (is_folder ? "/" : ""));
  }
  return words;
}

Words names_of_work(Workbench const& workbench) {
  Words words;
  for (WorkItem const& item : workbench.work().items) words.push_back(item.name);
  return words;
}

Words names_of_results(Workbench const& workbench) {
  Words words;
  for (Result const& result : workbench.results()) {
    words.push_back(result.task);
    for (DrawColumn const& column : result.draws) words.push_back(column.name);
    for (RecordSeries const& record : result.records)
      for (SeriesColumn const& column : record.quantities) words.push_back(column.name);
  }
  return words;
}

/// What a model declares, as its own statements name it.
Words names_of_model(Workbench const& workbench) {
  Words words;
  if (workbench.checked() == nullptr) return words;
  for (Model const& model : workbench.checked()->models) {
    if (model.name != workbench.current_model()) continue;
    auto const add = [&](auto const& quantities) {
      for (auto const& each : quantities) words.push_back(each.name);
    };
    add(model.inputs), add(model.states), add(model.parameters), add(model.channels), add(model.derived);
  }
  return words;
}

/// What stands behind `first.`, a task that has been run.
Words members(Workbench const& workbench, std::string const& owner) {
  Words words;
  for (Result const& result : workbench.results()) {
    if (result.task != owner) continue;
    for (DrawColumn const& column : result.draws) words.push_back(owner + "." + column.name);
    for (RecordSeries const& record : result.records)
      for (SeriesColumn const& column : record.quantities) words.push_back(owner + "." + column.name);
  }
  return words;
}

/// A text in which the entry stands where it would in the file, and where it begins there.
struct Framed {
  std::string text;
  std::size_t begin = 0;
};

/// The brackets and braces that are open behind an entry, closed again: what stands around a word can then be read.
std::string closed(std::string const& entry) {
  std::string open;
  bool quoted = false;
  for (char const c : entry) {
    if (c == '"') quoted = !quoted;
    if (quoted) continue;
    if (c == '(' || c == '[' || c == '{') open.insert(open.begin(), c == '(' ? ')' : c == '[' ? ']' : '}');
    if ((c == ')' || c == ']' || c == '}') && !open.empty()) open.erase(open.begin());
  }
  return (quoted ? "\"" : "") + open;
}

Framed in_file(Workbench const& workbench, std::string const& entry) {
  std::string const before = workbench.work().text() + "\n";
  return {before + entry + "\n" + closed(entry) + "\n", before.size()};
}

/// Inside the block that statements of its kind change; as in a file where there is none yet.
Framed in_block(Workbench const& workbench, ItemKind kind, std::string const& name, std::string const& entry) {
  Workspace const& work = workbench.work();
  std::size_t const place = work.find(kind, name);
  if (name.empty() || place == work.items.size()) {
    std::string const before = workbench.work().text() + fmt::format("\n{} unnamed {{\n", word_of(kind));
    return {before + entry + closed(entry) + "\n}\n", before.size()};
  }
  std::string text = work.text();
  std::size_t const brace = work.begin(place) + work.items[place].text.rfind('}');
  text.insert(brace, "\n" + entry + closed(entry) + "\n");
  return {std::move(text), brace + 1};
}

/// Adds what may stand at the end of the entry there; returns where the word begins in the entry.
std::size_t add_language(Workbench const& workbench, Framed const& framed, std::size_t length, Words& words) {
  auto const offset = static_cast<std::uint32_t>(framed.begin + length);
  assist::Completions const found = assist::complete(workbench.work().path.string(), framed.text, offset);
  for (assist::Completion const& each : found.items) words.push_back(each.label);
  return found.replaces.begin - framed.begin;
}

/// The first words of an entry.
Words first_words() {
  Words words;
  for (CommandRow const& row : commands()) words.emplace_back(row.name);
  append(words, words::items), append(words, words::verbs), append(words, words::model_statements),
      append(words, words::data_statements);
  return words;
}

Words functions_of_prompt() {
  Words words = {"plot", "trace", "histogram"};
  for (PromptFunction const& row : prompt_functions()) words.emplace_back(row.name);
  return words;
}

/// Arguments of a command.
Words arguments_of(Workbench const& workbench, std::string_view command) {
  if (command == "help") {
    Words words = words_with_help();
    append(words, names_of_work(workbench));
    return words;
  }
  if (command == "list") return {"functions", "distributions", "kernels", "backends", "discovery", "solvers", "modules"};
  Words words = names_of_work(workbench);
  if (command == "refit") append(words, std::array{"as", "with"});
  if (command == "drop") append(words, names_of_model(workbench));
  return words;
}

}  // namespace

std::string common_beginning(std::vector<std::string> const& words) {
  if (words.empty()) return "";
  std::string common = words.front();
  for (std::string const& word : words) {
    std::size_t i = 0;
    while (i < common.size() && i < word.size() && common[i] == word[i]) ++i;
    common.resize(i);
  }
  // No character is cut in two.
  common.resize(character_begin(words.front(), common.size()));
  return common;
}

Completions completions(Workbench const& workbench, std::string const& entry) {
  auto const finish = [&](Words words, std::size_t begin) {
    std::string const written = entry.substr(begin);
    std::erase_if(words, [&](std::string const& each) { return !each.starts_with(written); });
    std::sort(words.begin(), words.end());
    words.erase(std::unique(words.begin(), words.end()), words.end());
    return Completions{begin, std::move(words)};
  };
  std::size_t const first = std::min(entry.find_first_not_of(" \t\n"), entry.size());
  std::size_t first_end = first;
  while (first_end < entry.size() && words::continues_name(entry[first_end])) ++first_end;
  std::string const first_word = entry.substr(first, first_end - first);
  std::size_t begin = entry.size();
  while (begin > first && (words::continues_name(entry[begin - 1]) || entry[begin - 1] == '.')) --begin;
  bool const one_line = entry.find('\n') == std::string::npos;
  if (one_line && first_end < entry.size() && entry[first_end] == ' ') {
    if (first_word == "load" || first_word == "save" || first_word == "columns") {
      std::size_t const path = std::min(entry.find_first_not_of(' ', first_end), entry.size());
      return finish(files(entry.substr(path), first_word == "columns" ? ".csv" : ".sysid"), path);
    }
    std::string arguments;
    CommandRow const* command = command_of(entry.substr(0, first_end), arguments);
    if (command != nullptr && entry.find('=') == std::string::npos) return finish(arguments_of(workbench, command->name), begin);
  }
  std::string const written = entry.substr(begin);
  if (auto const dot = written.rfind('.'); dot != std::string::npos)
    if (Words of_result = members(workbench, written.substr(0, dot)); !of_result.empty())
      return finish(std::move(of_result), begin);

  Words words;
  bool const whole_block = words::contains(words::items, first_word) && entry.find('{') != std::string::npos;
  if (first_end == entry.size()) append(words, first_words());
  std::size_t word = add_language(workbench, in_file(workbench, entry), entry.size(), words);
  if (whole_block) return finish(std::move(words), word);
  // The rest of a task is no statement of a block; a statement of a block may be an expression over results as well.
  bool const task = !words.empty() && first_end < entry.size();
  if (!task) {
    if (words::contains(words::data_statements, first_word))
      word = add_language(workbench, in_block(workbench, ItemKind::data, workbench.current_data(), entry), entry.size(), words);
    word = add_language(workbench, in_block(workbench, ItemKind::model, workbench.current_model(), entry), entry.size(), words);
  }
  if (word != begin) return finish(std::move(words), word);  // a path, or what stands behind a dot
  append(words, names_of_model(workbench));
  append(words, functions_of_prompt());
  append(words, names_of_results(workbench));
  return finish(std::move(words), begin);
}

}  // namespace sysid::repl
