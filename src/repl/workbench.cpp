// Entries to a checked work: nothing means anything else at the prompt than in a file, since it is a file that is checked.
#include "repl/workbench.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "app/session/preconditions.hpp"
#include "core/text/words.hpp"
#include "core/text/wrapped.hpp"
#include "data/table.hpp"
#include "experiment/experiments.hpp"
#include "load/load.hpp"
#include "repl/change.hpp"
#include "repl/words.hpp"
#include "syntax/entry.hpp"
#include "syntax/parse.hpp"

namespace sysid::repl {
namespace {

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) text.replace(at, from.size(), to);
}

/// A command misspelt before its arguments, `colums x.csv`, reads like a product without its sign: the help is the command's name.
void suggest_command(Diagnostics& diagnostics, std::string const& entry) {
  std::vector<Diagnostic> all = diagnostics.all();
  if (all.front().code != "E1105") return;
  std::vector<std::string> names;
  for (CommandRow const& row : commands()) names.emplace_back(row.name);
  std::string const word = entry.substr(0, std::min(entry.find(' '), entry.size()));
  if (std::string near = did_you_mean(word, names); !near.empty()) all.front().help = std::move(near);
  diagnostics.replace(std::move(all));
}

}  // namespace

std::string at_the_prompt(std::string text) {
  replace_all(text, "sysid explain CODE, for each word in brackets", "`help WORD`, for each word in brackets");
  replace_all(text, "sysid explain ", "help ");
  replace_all(text, "`./sysid list ", "`list ");
  replace_all(text, "go on with --resume", "go on with `resume`");
  replace_all(text, "--resume goes on from there", "`resume` goes on from there");
  replace_all(text, "--resume starts it again", "`resume` starts it again");
  replace_all(text, "add --force to replace them, or -o DIR to write elsewhere",
              "give the task another name, or start the prompt with --force or another -o");
  replace_all(text, "go on with `resume`, or start again with --force",
              "give the task another name, or start the prompt with --force or another -o");
  return text;
}

Workbench::Workbench(RunOptions options, Progress& progress, Voices voices)
    : options_(std::move(options)), progress_(progress), voices_(voices) {
  options_.figures = false;
}
Workbench::~Workbench() = default;

void Workbench::say(std::string const& line) { voices_.messages << line << '\n' << std::flush; }

void Workbench::answer_lines(std::string const& text) { voices_.answers << wrapped(text, voices_.columns()) << std::flush; }

bool Workbench::refuse(std::string const& message, std::string const& help) {
  say(fmt::format("{}{}{}", message, help.empty() ? "" : "\nhelp: ", help));
  return false;
}

void Workbench::show(Diagnostics const& diagnostics, std::string const& entry) {
  voices_.messages << at_the_prompt(render(diagnostics, Source("prompt", entry), voices_.colour)) << std::flush;
}

void Workbench::show(Diagnostics const& diagnostics, Source const& source, Work const& work, std::string const& entry) {
  Source shown("prompt", entry);
  auto const shift = shown.next_begin();
  for (int file = 0; file < source.files(); ++file) shown.include(source.name(file), std::string(source.text(file)));
  auto const place = [&](Span span) {
    for (std::size_t i = 0; i < work.items.size(); ++i) {
      std::uint32_t const begin = work.begin(i);
      for (TypedPart const& part : work.items[i].typed)
        if (span.begin >= begin + part.in_text.begin && span.end <= begin + part.in_text.end) {
          std::uint32_t const from = part.in_typed - (begin + part.in_text.begin);  // may wrap around, and back
          return Span{span.begin + from, span.end + from};
        }
    }
    return Span{span.begin + shift, span.end + shift};
  };
  Diagnostics mapped;
  for (Diagnostic each : diagnostics.all()) {
    if (each.severity != Severity::error && !warned_.insert(each.code + each.message).second) continue;
    if (each.primary) each.primary->span = place(each.primary->span);
    for (Label& label : each.secondary) label.span = place(label.span);
    mapped.add(std::move(each));
  }
  voices_.messages << at_the_prompt(render(mapped, shown, voices_.colour)) << std::flush;
}

bool Workbench::guarded(Source const& source, std::function<bool()> const& act) {
  auto const told = [&](Diagnostics const& diagnostics) {
    voices_.messages << at_the_prompt(render(diagnostics, source, voices_.colour)) << std::flush;
    return false;
  };
  try {
    return act();
  } catch (UnusableData const& error) {
    return told(error.diagnostics());
  } catch (UserError const& error) {
    Diagnostics one;
    one.add(error.diagnostic());
    return told(one);
  } catch (UnreadableData const& error) {
    return told(error.diagnostics());
  } catch (IoError const& error) {
    return refuse(error.what(), error.help());
  } catch (std::bad_alloc const&) {
    return refuse("out of memory");
  } catch (std::exception const& error) {
    return refuse(fmt::format("this is an error in sysid, not in your file: {}", error.what()),
                  "please `save` the work and report it with that file");
  }
}

std::set<std::string> Workbench::tasks_run() const {
  std::set<std::string> names;
  for (Result const& each : results_) names.insert(each.task);
  return names;
}

bool Workbench::complete(std::string const& entry) const {
  std::string arguments;
  return command_of(entry, arguments) != nullptr || !unfinished(entry);
}

bool Workbench::enter(std::string const& entry) {
  std::string const text(trimmed(entry));
  std::string arguments;
  if (CommandRow const* row = command_of(text, arguments)) return command(*row, arguments);
  return guarded(Source("prompt", entry), [&] { return enter_parts(entry); });
}

bool Workbench::enter_parts(std::string const& entry) {
  Diagnostics diagnostics;
  auto const parts = parts_of(entry, diagnostics);
  if (!diagnostics.all().empty()) {
    suggest_command(diagnostics, std::string(trimmed(entry)));
    show(diagnostics, entry);
    return false;
  }
  for (std::size_t i = 0; i < parts.size();) {
    if (parts[i].kind == EntryPart::Kind::expression) {
      // Blanks before it, so that places are those in the entry.
      std::string text(parts[i].span.begin, ' ');
      text += entry.substr(parts[i].span.begin, parts[i].span.end - parts[i].span.begin);
      auto const tree = parse_expression(Source("prompt", text), diagnostics);
      if (!tree || !answer(*tree, text)) return false;
      ++i;
      continue;
    }
    // What stands together is checked together, up to a task, which is run before what follows.
    Work changed = work_;
    std::string const model = model_, data = data_;
    std::vector<std::string> tasks, notices;
    for (; i < parts.size() && parts[i].kind != EntryPart::Kind::expression && tasks.empty(); ++i)
      if (!draft(parts[i], entry, changed, tasks, notices)) {
        model_ = model;
        data_ = data;
        return false;
      }
    changed.prune();
    Work const before = work_;
    auto const checked_before = checked_;
    bool const unsaved_before = unsaved_;
    if (!adopt(std::move(changed), entry)) {
      model_ = model;
      data_ = data;
      return false;
    }
    for (std::string const& notice : notices) say(notice);
    for (std::string const& task : tasks) {
      if (run_task(task, checked_, false)) continue;
      // What could not be run is no part of the work.
      work_ = before;
      checked_ = checked_before;
      unsaved_ = unsaved_before;
      return false;
    }
  }
  return true;
}

bool Workbench::draft(EntryPart const& part, std::string const& entry, Work& work, std::vector<std::string>& tasks,
                      std::vector<std::string>& notices) {
  auto const put = [&](WorkItem item) {
    auto const more = work.put(std::move(item), tasks_run());
    notices.insert(notices.end(), more.begin(), more.end());
  };
  std::string const text = entry.substr(part.span.begin, part.span.end - part.span.begin);
  auto const length = static_cast<std::uint32_t>(text.size());
  if (part.kind == EntryPart::Kind::items) {
    ast::Item const tree = item_of(text);
    WorkItem item{kind_of(tree), name_of(tree), "", text, false, {{{0, length}, part.span.begin}}};
    if (item.kind == ItemKind::task) {
      item.text = with_seed(text);
      tasks.push_back(item.name);
    }
    if (item.kind == ItemKind::model) model_ = item.name;
    if (item.kind == ItemKind::data) data_ = item.name;
    put(std::move(item));
    return true;
  }
  bool const of_model = part.kind == EntryPart::Kind::model_statement;
  std::string const& name = of_model ? model_ : data_;
  std::size_t const place = work.find(of_model ? ItemKind::model : ItemKind::data, name);
  if (name.empty() || place == work.items.size()) {
    Diagnostics diagnostics;
    diagnostics.add({Severity::error,
                     "",
                     of_model ? "this statement belongs to a model, but there is none yet"
                              : "this statement belongs to a data block, but there is none yet",
                     Label{part.span, {}},
                     {},
                     of_model ? "begin with `model NAME {`, or `load FILE`" : "begin with `data NAME {`, or `load FILE`"});
    show(diagnostics, entry);
    return false;
  }
  put(with_statement(work.items[place], entry, part.span));
  return true;
}

void Workbench::ask_for_columns(Work const& draft, Source const& source, CheckedFile const& file, Diagnostics& diagnostics) {
  std::ostream nowhere(nullptr);
  Session const session(source, file, options_, progress_, nowhere, nowhere);
  for (DataBlock const& block : file.data) {
    std::size_t const now = draft.find(ItemKind::data, block.name), before = work_.find(ItemKind::data, block.name);
    bool const changed =
        now < draft.items.size() && (before == work_.items.size() || work_.items[before].text != draft.items[now].text);
    std::filesystem::path const path = session.folder() / block.path;
    // What a task has yet to make may look otherwise then.
    Task const* made = maker(session, block);
    if (!changed || !std::filesystem::is_regular_file(path) || (made != nullptr && !made_.contains(made->name))) continue;
    auto const refused = [&](auto const& ask) {
      try {
        ask();
        return false;
      } catch (UserError const& error) {
        diagnostics.add(error.diagnostic());
        return true;
      } catch (IoError const&) {
        return true;  // who reads it says so
      }
    };
    std::optional<Table> table;
    if (refused([&] { table = Table::read(path.string(), block.path_span); })) continue;
    auto const ask = [&](ColumnUse const& use) { refused([&] { table->numbers(use.column, use.span); }); };
    if (block.time) ask(*block.time);
    for (DataInputUse const& input : block.inputs) ask(input);
    for (DataMeasureUse const& measure : block.measured) ask(measure);
  }
}

bool Workbench::adopt(Work draft, std::string const& entry) {
  Source source(draft.path.string(), draft.text());
  Diagnostics diagnostics;
  auto file = sysid::load(source, diagnostics);
  // What comes from a file is said of the tasks that read it.
  if (file && !entry.empty()) ask_for_columns(draft, source, *file, diagnostics);
  show(diagnostics, source, draft, entry);
  if (!file || diagnostics.has_errors()) return false;
  for (WorkItem& item : draft.items) item.typed.clear();
  if (draft.text() != work_.text()) unsaved_ = true;
  work_ = std::move(draft);
  checked_ = std::make_shared<Checked const>(Checked{std::move(source), std::move(*file)});
  return true;
}

}  // namespace sysid::repl
