// By the word before, the bracket around and the block that is open; what does not fit is refused by the parser, not here.
#include "repl/completion.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "core/files.hpp"
#include "data/table.hpp"
#include "repl/help.hpp"
#include "syntax/words.hpp"

namespace sysid::repl {
namespace {

using Words = std::vector<std::string>;

void append(Words& words, auto const& more) {
  for (auto const& each : more) words.emplace_back(each);
}

/// Files and folders that continue a path; folders end in /.
Words files(std::string const& path, std::filesystem::path const& from, std::string_view extension) {
  auto const slash = path.rfind('/');
  std::string const folder = slash == std::string::npos ? "" : path.substr(0, slash + 1);
  std::filesystem::path where = from / folder;
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

/// The names in the head of a data file; none where it cannot be read.
Words columns(std::filesystem::path const& path) {
  constexpr std::size_t enough = 16384;  // for a header with its comments
  try {
    std::string head = read_file(path, enough);
    head.resize(std::min({head.rfind('\n') == std::string::npos ? head.size() : head.rfind('\n') + 1, head.size()}));
    return Table::parse(path.string(), head).columns();
  } catch (std::exception const&) {
    return {};
  }
}

/// The text in quotes behind the last `file` of an entry.
std::string file_named_in(std::string const& entry) {
  auto const at = entry.rfind("file ");
  if (at == std::string::npos) return "";
  auto const begin = entry.find('"', at), end = entry.find('"', begin + 1);
  return begin == std::string::npos || end == std::string::npos ? "" : entry.substr(begin + 1, end - begin - 1);
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

/// What stands behind `first.` or `bench.`.
Words members(Workbench const& workbench, std::string const& owner) {
  Words words;
  for (Result const& result : workbench.results()) {
    if (result.task != owner) continue;
    for (DrawColumn const& column : result.draws) words.push_back(owner + "." + column.name);
    for (RecordSeries const& record : result.records)
      for (SeriesColumn const& column : record.quantities) words.push_back(owner + "." + column.name);
  }
  if (workbench.checked() != nullptr)
    for (DataBlock const& block : workbench.checked()->data)
      if (block.name == owner)
        for (DataPart const& part : block.parts) words.push_back(owner + "." + part.name);
  return words;
}

/// The word of the block that is open at the end of an entry; empty where none is.
std::string open_block(std::string const& entry) {
  auto const brace = entry.rfind('{');
  if (brace == std::string::npos || entry.find('}', brace) != std::string::npos) return "";
  auto const line = entry.rfind('\n', brace);
  std::string const head = entry.substr(line == std::string::npos ? 0 : line + 1, brace);
  std::size_t const begin = head.find_first_not_of(" \t");
  return begin == std::string::npos ? "" : head.substr(begin, head.find_first_of(" \t{", begin) - begin);
}

Words statement_words(std::string const& block) {
  Words words;
  if (block == "model") append(words, words::model_statements);
  if (block == "data") append(words, words::data_statements);
  if (block == "candidates") append(words, words::candidate_words);
  if (block == "dictionary") append(words, words::dictionary_statements);
  return words;
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
  for (auto const rows : {statistics(), series_functions()})
    for (PromptFunction const& row : rows) words.emplace_back(row.name);
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
  while (!common.empty() && common.size() < words.front().size() &&
         (static_cast<unsigned char>(words.front()[common.size()]) & 0xC0U) == 0x80U)
    common.pop_back();
  return common;
}

Completions completions(Workbench const& workbench, std::string const& entry) {
  Completions result;
  std::size_t const line_begin = entry.rfind('\n') == std::string::npos ? 0 : entry.rfind('\n') + 1;
  std::string const line = entry.substr(line_begin);
  auto const finish = [&](Words words, std::size_t begin) {
    result.begin = begin;
    std::string const written = entry.substr(begin);
    std::erase_if(words, [&](std::string const& each) { return !each.starts_with(written); });
    std::sort(words.begin(), words.end());
    words.erase(std::unique(words.begin(), words.end()), words.end());
    result.words = std::move(words);
    return result;
  };
  std::filesystem::path const folder = workbench.work().path.parent_path();
  // Inside quotes a file.
  if (std::count(line.begin(), line.end(), '"') % 2 == 1) {
    std::size_t const quote = line_begin + line.rfind('"') + 1;
    return finish(files(entry.substr(quote), folder, ".csv"), quote);
  }
  std::size_t first = line.find_first_not_of(" \t");
  if (first == std::string::npos) first = line.size();
  std::size_t first_end = first;
  while (first_end < line.size() && words::continues_name(line[first_end])) ++first_end;
  std::string const first_word = line.substr(first, first_end - first);
  bool const alone = line_begin == 0;
  if (alone && first_end < line.size() && line[first_end] == ' ' &&
      (first_word == "load" || first_word == "save" || first_word == "columns")) {
    std::size_t const begin = std::min(line.find_first_not_of(' ', first_end), line.size());
    return finish(files(line.substr(begin), "", first_word == "columns" ? ".csv" : ".sysid"), begin);
  }
  std::size_t begin = entry.size();
  while (begin > line_begin && (words::continues_name(entry[begin - 1]) || entry[begin - 1] == '.')) --begin;
  std::string const written = entry.substr(begin);
  if (alone && begin > first_end && first_end < line.size() && line[first_end] == ' ') {
    std::string arguments;
    CommandRow const* command = command_of(first_word, arguments);
    if (command != nullptr && line.find('=') == std::string::npos) return finish(arguments_of(workbench, command->name), begin);
  }
  if (auto const dot = written.rfind('.'); dot != std::string::npos)
    return finish(members(workbench, written.substr(0, dot)), begin);
  std::string const block = open_block(entry);
  bool const begins =
      begin == line_begin + first || entry.find_last_not_of(" \t", begin == 0 ? 0 : begin - 1) == std::string::npos ||
      std::string_view(";{").find(entry[entry.find_last_not_of(" \t", begin == 0 ? 0 : begin - 1)]) != std::string_view::npos;
  Words words;
  if (begins) {
    words = block.empty() ? first_words() : statement_words(block);
    if (block.empty()) {
      append(words, functions_of_prompt());
      append(words, names_of_results(workbench));
    }
    append(words, names_of_model(workbench));
    return finish(std::move(words), begin);
  }
  bool const of_data =
      block == "data" ||
      (block.empty() && (first_word == "measure" || line.find(" hold") != std::string::npos || first_word == "input"));
  if (of_data) {
    std::string file = file_named_in(entry);
    if (file.empty() && workbench.checked() != nullptr)
      for (DataBlock const& data : workbench.checked()->data)
        if (data.name == workbench.current_data()) file = data.path;
    if (!file.empty()) append(words, columns(folder / file));
    append(words, std::array{"hold", "rows", "zero_order", "linear", "cubic", "band_limited"});
    append(words, names_of_model(workbench));
    return finish(std::move(words), begin);
  }
  words = words_with_help();
  append(words, names_of_work(workbench));
  append(words, names_of_results(workbench));
  append(words, names_of_model(workbench));
  return finish(std::move(words), begin);
}

}  // namespace sysid::repl
