// What the prompt knows besides the language.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "app/check_file.hpp"
#include "app/lists.hpp"
#include "app/pipeline.hpp"
#include "core/files.hpp"
#include "data/table.hpp"
#include "repl/change.hpp"
#include "repl/help.hpp"
#include "repl/workbench.hpp"
#include "report/check_page.hpp"
#include "report/number.hpp"
#include "syntax/entry.hpp"
#include "syntax/format.hpp"
#include "syntax/parse.hpp"
#include "syntax/words.hpp"

namespace sysid::repl {
namespace {

std::string stripped(std::string_view text) {
  auto const first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1));
}

/// A path as it is typed, with or without quotes; `~/` is the home folder.
std::filesystem::path path_of(std::string text) {
  if (text.size() > 1 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
  if (text.starts_with("~/"))
    if (char const* home = std::getenv("HOME")) return std::filesystem::path(home) / text.substr(2);
  return text;
}

std::vector<std::string> words_in(std::string const& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

std::string score(std::optional<double> value) { return value ? significant(*value, 4) : std::string(); }

}  // namespace

std::span<CommandRow const> commands() {
  static constexpr CommandRow rows[] = {
      {"load", "load FILE", "takes the statements of a file into the work; runs nothing", &Workbench::load},
      {"reload", "reload", "takes the file again that was loaded or saved last", &Workbench::reload},
      {"save", "save FILE", "writes the work as a file that `sysid run` repeats", &Workbench::save},
      {"columns", "columns FILE.csv", "what a data file holds", &Workbench::columns},
      {"list", "list, list TOPIC", "the work; functions, distributions, kernels, backends, discovery, solvers or modules",
       &Workbench::list},
      {"show", "show, show NAME", "the text of the work, of one of its statements, or what a task found", &Workbench::show_text},
      {"check", "check", "what the data can tell, before any sampling", &Workbench::check},
      {"run", "run, run TASK ...", "runs tasks of the work: those that have not been run, or those named", &Workbench::run},
      {"refit", "refit [FIT] [as NAME] [with ...]", "fits the model as it is now again, beginning where the last fit ended",
       &Workbench::refit},
      {"resume", "resume", "goes on with a task that Ctrl-C has stopped", &Workbench::resume},
      {"change", "change NAME", "the model or data block that statements typed from here on change", &Workbench::change},
      {"drop", "drop NAME", "takes a statement out of the work, or a declaration out of the model", &Workbench::drop},
      {"help", "help, help WORD", "this; what a word of the language or a message means", &Workbench::help},
      {"quit", "quit", "ends the session, as Ctrl-D does", &Workbench::quit},
  };
  return rows;
}

CommandRow const* command_of(std::string_view entry, std::string& arguments) {
  std::string const text = stripped(entry);
  if (text.empty()) return nullptr;
  auto const row = [](std::string_view name) {
    auto const all = commands();
    return &*std::find_if(all.begin(), all.end(), [&](CommandRow const& each) { return each.name == name; });
  };
  if (text.front() == '?') {
    arguments = stripped(std::string_view(text).substr(1));
    return row("help");
  }
  std::size_t end = 0;
  while (end < text.size() && words::continues_name(text[end])) ++end;
  std::string const word = text == "exit" ? "quit" : text.substr(0, end);
  auto const all = commands();
  if (std::none_of(all.begin(), all.end(), [&](CommandRow const& each) { return each.name == word; })) return nullptr;
  arguments = stripped(std::string_view(text).substr(end));
  if (arguments.empty()) return row(word);
  // What an operator follows is a name: `load = fit ...`, `load*y + x`. A path may begin with / . or ~.
  bool const apart = text[end] == ' ' || text[end] == '\t';
  char const next = arguments.front();
  bool const path = (next == '/' || next == '~' || next == '.') && arguments.size() > 1 && arguments[1] != ' ';
  bool const names = words::continues_name(next) || next == '"' || path || (next == '[' && word == "help");
  bool const operation = arguments.starts_with("and ") || arguments.starts_with("or ");
  if (!apart || !names || operation) return nullptr;
  return row(word);
}

bool Workbench::command(CommandRow const& row, std::string const& arguments) {
  return guarded(Source("prompt", arguments), [&] { return (this->*row.run)(arguments); });
}

bool Workbench::take_file(std::filesystem::path const& path) {
  std::string const text = read_file(path, most_text_bytes + 1);
  Source source(path.string(), text);
  Diagnostics diagnostics;
  auto const file = sysid::load(source, diagnostics);
  voices_.messages << at_the_prompt(render(diagnostics, source, voices_.colour));
  for (Diagnostic const& each : diagnostics.all()) warned_.insert(each.code + each.message);
  if (!file) return false;
  Work loaded;
  loaded.path = path;
  loaded.items = items_of(text);
  Work draft = work_;
  if (draft.items.empty())
    draft.path = path;
  else
    loaded.move_to(draft.path);
  std::vector<std::string> notices;
  for (WorkItem& item : loaded.items) {
    auto const more = draft.put(std::move(item), tasks_run());
    notices.insert(notices.end(), more.begin(), more.end());
  }
  draft.prune();
  bool const first = work_.items.empty();
  if (!adopt(std::move(draft), "")) return false;
  if (first) unsaved_ = false;
  for (std::string const& notice : notices) say(notice);
  for (WorkItem const& item : work_.items) {
    if (item.kind == ItemKind::model && !item.kept) model_ = item.name;
    if (item.kind == ItemKind::data && !item.kept) data_ = item.name;
  }
  // Of several models the one that is fitted last is the likeliest to be worked on.
  for (Task const& task : checked_->file.tasks)
    if (auto const* fit = std::get_if<FitTask>(&task.what)) {
      std::string const& model = checked_->file.models[static_cast<std::size_t>(fit->model)].name;
      if (work_.find(ItemKind::model, model) < work_.items.size()) model_ = model;
    }
  loaded_ = path;
  std::size_t tasks = 0;
  std::string names;
  for (WorkItem const& item : items_of(text)) {
    tasks += item.kind == ItemKind::task ? 1 : 0;
    names += fmt::format("{}{} {}", names.empty() ? "" : ", ", word_of(item.kind), item.name);
  }
  say(fmt::format("{}: {}{}", path.string(), names, tasks == 0 ? "" : "; `run` runs its tasks"));
  return true;
}

bool Workbench::load(Arguments path) {
  if (path.empty()) return refuse("load what?", "`load FILE.sysid`");
  return take_file(path_of(path));
}

bool Workbench::reload(Arguments) {
  if (loaded_.empty()) return refuse("no file has been loaded or saved", "`load FILE.sysid`");
  return take_file(loaded_);
}

bool Workbench::save(Arguments path) {
  std::filesystem::path const to = path.empty() ? loaded_ : path_of(path);
  if (to.empty()) return refuse("save as what?", "`save work.sysid`");
  if (work_.items.empty()) return refuse("there is nothing to save yet");
  if (std::filesystem::exists(to) && to != loaded_)
    return refuse(fmt::format("`{}` is there already", to.string()), "take another name, or remove it");
  Work moved = work_;
  moved.move_to(to);
  Diagnostics diagnostics;
  auto const text = formatted(Source(to.string(), moved.text()), diagnostics);
  if (!text) throw InternalError("the work cannot be laid out");
  write_file(to, *text);
  if (!adopt(std::move(moved), "")) return false;
  loaded_ = to;
  unsaved_ = false;
  say(fmt::format("{} written; `sysid run {} -o DIR` repeats it", to.string(), to.string()));
  return true;
}

bool Workbench::list(Arguments topic) {
  constexpr std::string_view topics[] = {"functions", "distributions", "kernels", "backends", "discovery", "solvers", "modules"};
  if (!topic.empty()) {
    if (std::find(std::begin(topics), std::end(topics), topic) == std::end(topics))
      return refuse(fmt::format("there is no list of {}", topic), fmt::format("topics are {}", fmt::join(topics, ", ")));
    voices_.answers << sysid::list(topic) << std::flush;
    return true;
  }
  if (work_.items.empty()) {
    say("nothing yet: begin with `load FILE`, or with `model NAME {`");
    return true;
  }
  std::vector<std::vector<std::string>> rows;
  for (WorkItem const& item : work_.items) {
    if (item.kind == ItemKind::task) continue;
    bool const current =
        (item.kind == ItemKind::model && item.name == model_) || (item.kind == ItemKind::data && item.name == data_);
    rows.push_back({std::string(word_of(item.kind)), item.name,
                    current     ? "changed by statements typed now"
                    : item.kept ? "as it was when a task ran"
                                : ""});
  }
  if (!rows.empty()) voices_.answers << align_columns(rows, 3);
  std::vector<std::vector<std::string>> tasks = {{"task", "", "nmse", "rmse"}};
  for (WorkItem const& item : work_.items) {
    if (item.kind != ItemKind::task) continue;
    Result const* result = find_result(item.name);
    std::string const task = in_one_line(item.text);
    tasks.push_back({task,
                     result == nullptr                  ? "not run"
                     : interrupted_.contains(item.name) ? "stopped"
                                                        : "done",
                     result == nullptr ? "" : score(result->nmse), result == nullptr ? "" : score(result->rmse)});
  }
  if (tasks.size() > 1) voices_.answers << align_columns(tasks, 2);
  voices_.answers << std::flush;
  return true;
}

bool Workbench::show_text(Arguments name) {
  auto const laid_out = [](std::string const& text) {
    Diagnostics ignored;
    return formatted(Source("", text), ignored).value_or(text + "\n");
  };
  if (name.empty()) {
    if (work_.items.empty()) return list("");
    voices_.answers << laid_out(work_.text()) << std::flush;
    return true;
  }
  Result const* result = find_result(name);
  std::size_t const place = work_.find(name);
  if (result == nullptr && place == work_.items.size()) {
    std::vector<std::string> known;
    for (WorkItem const& item : work_.items) known.push_back(item.name);
    return refuse(fmt::format("there is no `{}` in the work", name), did_you_mean(name, known));
  }
  if (place < work_.items.size()) voices_.answers << laid_out(work_.items[place].text);
  if (result != nullptr) voices_.answers << '\n' << result->summary << fmt::format("files: {}\n", result->folder.string());
  voices_.answers << std::flush;
  return true;
}

bool Workbench::columns(Arguments path) {
  if (path.empty()) return refuse("columns of what?", "`columns FILE.csv`");
  auto const folder = work_.path.parent_path();
  auto const given = path_of(path);
  Table const table = Table::read((std::filesystem::exists(given) ? given : folder / given).string());
  std::vector<std::vector<std::string>> rows = {{"column", "numbers", "smallest", "largest", "first"}};
  for (std::string const& column : table.columns()) {
    std::vector<double> values;
    try {
      values = table.numbers(column);
    } catch (UserError const&) {
      rows.push_back({column, "not all numbers", "", "", ""});
      continue;
    }
    double low = std::nan(""), high = low;
    int count = 0;
    for (double const each : values) {
      if (std::isnan(each)) continue;
      ++count;
      low = std::isnan(low) ? each : std::min(low, each);
      high = std::isnan(high) ? each : std::max(high, each);
    }
    rows.push_back({column, std::to_string(count), significant(low, 4), significant(high, 4),
                    values.empty() ? "" : significant(values.front(), 6)});
  }
  voices_.answers << fmt::format("{} rows\n", table.rows()) << align_columns(rows, 1) << std::flush;
  return true;
}

bool Workbench::check(Arguments) {
  if (!checked_) return refuse("there is nothing to check yet");
  std::ostream nowhere(nullptr);
  Session session(checked_->source, checked_->file, options_, progress_, nowhere, nowhere);
  CheckResult const result = check_file(session);
  voices_.messages << at_the_prompt(render(result.diagnostics, checked_->source, voices_.colour)) << std::flush;
  voices_.answers << check_text(result.page) << std::flush;
  return !result.diagnostics.has_errors();
}

bool Workbench::run(Arguments tasks) {
  if (!checked_) return refuse("there is nothing to run yet");
  std::vector<std::string> names = words_in(tasks);
  if (names.empty())
    for (WorkItem const& item : work_.items)
      if (item.kind == ItemKind::task && find_result(item.name) == nullptr) names.push_back(item.name);
  if (names.empty()) {
    say("all tasks have been run; `run TASK` runs one again");
    return true;
  }
  for (std::string const& name : names) {
    std::size_t const place = work_.find(ItemKind::task, name);
    if (place == work_.items.size()) {
      std::vector<std::string> known;
      for (WorkItem const& item : work_.items)
        if (item.kind == ItemKind::task) known.push_back(item.name);
      return refuse(fmt::format("there is no task `{}`", name), did_you_mean(name, known));
    }
    std::string const seeded = with_seed(in_one_line(work_.items[place].text));
    if (seeded != in_one_line(work_.items[place].text)) {
      Work draft = work_;
      draft.items[place].text = seeded;
      if (!adopt(std::move(draft), "")) return false;
    }
    if (!run_task(name, checked_, false)) return false;
    if (interrupted_.contains(name)) return true;  // whoever stops one stops all
  }
  return true;
}

bool Workbench::refit(Arguments arguments) {
  // [FIT] [as NAME] [with ...]
  std::string head = arguments, with;
  if (auto const at = (" " + arguments).find(" with "); at != std::string::npos) {
    head = arguments.substr(0, at);
    with = arguments.substr(at + 5);
  }
  std::vector<std::string> words = words_in(head);
  std::string name, from;
  if (words.size() >= 2 && words[words.size() - 2] == "as") {
    name = words.back();
    words.resize(words.size() - 2);
  }
  if (words.size() > 1) return refuse("refit takes one fit", "`refit`, `refit FIT`, `refit FIT as NAME with mh(samples = 4000)`");
  if (words.size() == 1) from = words[0];
  if (from.empty())
    for (Result const& each : results_)
      if (each.verb == "fit" && work_.find(ItemKind::task, each.task) < work_.items.size()) from = each.task;
  if (from.empty()) return refuse("no fit has been run yet", "`fit1 = fit MODEL to DATA with map`");
  std::size_t const place = work_.find(ItemKind::task, from);
  if (place == work_.items.size() || !fitted_.contains(from)) return refuse(fmt::format("`{}` is no fit that has been run", from));
  std::string const& text = work_.items[place].text;
  ast::Task const task = std::get<ast::Task>(item_of(text));
  auto const written = [&](Span span) { return text.substr(span.begin, span.end - span.begin); };
  // What was kept under a name of its own is meant as it is now.
  auto const now = [&](ItemKind kind, std::string const& item) {
    std::size_t const at = work_.find(kind, item);
    return at < work_.items.size() && work_.items[at].kept ? item.substr(0, item.rfind('_')) : item;
  };
  if (name.empty()) name = free_task_name(from);
  std::string statement = fmt::format("{} = fit {}", name, now(ItemKind::model, task.subject.text));
  for (std::size_t i = 0; i < task.arguments.size(); ++i) statement += (i == 0 ? "(" : ", ") + written(task.arguments[i].span);
  if (!task.arguments.empty()) statement += ")";
  for (std::size_t i = 0; i < task.data.size(); ++i)
    statement += fmt::format("{}{}{}", i == 0 ? " to " : ", ", now(ItemKind::data, task.data[i].data.text),
                             task.data[i].part ? "." + task.data[i].part->text : "");
  std::string options = stripped(with);
  bool const backend = !options.empty();
  for (ast::Option const& option : task.options) {
    // Of new options the rest stays: where the simulation starts, how it is solved, the seed.
    bool const is_backend = !option.key && !option.input;
    bool const stated = option.key && !options.empty() && options.find(option.key->text + " =") != std::string::npos;
    if ((option.key && option.key->text == "search") || (is_backend && backend) || stated) continue;
    options += (options.empty() ? "" : ", ") + written(option.span);
  }
  statement += fmt::format(" with {}, search = near({})", options, from);
  say(statement);
  return enter_parts(statement);
}

bool Workbench::resume(Arguments task) {
  std::string name = task;
  if (name.empty() && interrupted_.size() == 1) name = interrupted_.begin()->first;
  auto const place = interrupted_.find(name);
  if (place == interrupted_.end())
    return refuse(interrupted_.empty() ? "nothing has been stopped" : "which of the tasks that were stopped?",
                  interrupted_.empty() ? "" : "`resume TASK`");
  return run_task(name, std::shared_ptr<Checked const>(place->second), true);
}

bool Workbench::change(Arguments block) {
  for (ItemKind const kind : {ItemKind::model, ItemKind::data})
    if (work_.find(kind, block) < work_.items.size()) {
      (kind == ItemKind::model ? model_ : data_) = block;
      say(fmt::format("statements of a {} now change `{}`", kind == ItemKind::model ? "model" : "data block", block));
      return true;
    }
  std::vector<std::string> known;
  for (WorkItem const& item : work_.items)
    if (item.kind == ItemKind::model || item.kind == ItemKind::data) known.push_back(item.name);
  return refuse(fmt::format("there is no model or data block `{}` in the work", block), did_you_mean(block, known));
}

bool Workbench::drop(Arguments name) {
  Work draft = work_;
  std::size_t const place = draft.find(name);
  std::size_t const model = draft.find(ItemKind::model, model_);
  if (name.empty()) return refuse("drop what?", "`drop NAME`: a statement of the work, or a declaration of the current model");
  if (place < draft.items.size()) {
    draft.items.erase(draft.items.begin() + static_cast<std::ptrdiff_t>(place));
  } else if (model < draft.items.size()) {
    WorkItem without = without_statement(draft.items[model], name);
    if (without.text == draft.items[model].text)
      return refuse(fmt::format("there is no `{}` in the work, and no declaration of it in `{}`", name, model_));
    for (std::string const& notice : draft.put(std::move(without), tasks_run())) say(notice);
  } else {
    return refuse(fmt::format("there is no `{}` in the work", name));
  }
  draft.prune();
  if (!adopt(std::move(draft), "")) return false;
  if (work_.find(ItemKind::task, name) == work_.items.size()) {
    std::erase_if(results_, [&](Result const& each) { return each.task == name; });
    fitted_.erase(name);
    interrupted_.erase(name);
  }
  return true;
}

bool Workbench::help(Arguments word) {
  if (word.empty()) {
    voices_.answers << help_overview() << std::flush;
    return true;
  }
  if (auto const text = help_on(word)) {
    voices_.answers << *text << std::flush;
    return true;
  }
  if (find_result(word) != nullptr || work_.find(word) < work_.items.size()) return show_text(word);
  return refuse(fmt::format("there is no help on `{}`", word), did_you_mean(word, words_with_help()));
}

bool Workbench::quit(Arguments) {
  over_ = true;
  return true;
}

}  // namespace sysid::repl
