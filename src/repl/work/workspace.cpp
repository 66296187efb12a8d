// Statements of a file and the names that tie them together.
#include "repl/work/workspace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/text/diagnostic.hpp"
#include "syntax/entry.hpp"
#include "syntax/expression_text.hpp"
#include "syntax/parse.hpp"
#include "syntax/words.hpp"

namespace sysid::repl {
namespace {

bool blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == ';' || c == '\r'; }

/// `text` with the spans replaced; spans lie apart.
std::string replaced(std::string text, std::map<std::uint32_t, std::pair<std::uint32_t, std::string>> const& by_begin) {
  for (auto each = by_begin.rbegin(); each != by_begin.rend(); ++each)
    text.replace(each->first, each->second.first - each->first, each->second.second);
  return text;
}

/// The place of an item's own name.
Span own_name(ast::Item const& item) {
  return std::visit(
      [](auto const& each) -> Span {
        using Each = std::decay_t<decltype(each)>;
        if constexpr (std::is_same_v<Each, ast::Use>)
          return each.module.span;
        else if constexpr (std::is_same_v<Each, ast::Task>)
          return each.name ? each.name->span : Span{};
        else
          return each.name.span;
      },
      item);
}

/// An item beside those that it refers to, where one of them is about to change.
struct Dependence {
  std::vector<ItemReference> references;
  Span own;              // its name
  bool reaches = false;  // depends on what changes
  bool held = false;     // and a task that was run depends on it
};

std::vector<Dependence> dependences(std::vector<WorkItem> const& items, std::size_t changed, std::set<std::string> const& run) {
  std::vector<Dependence> nodes;
  for (WorkItem const& item : items) {
    ast::Item const tree = item_of(item.text);
    nodes.push_back({references_of(tree), own_name(tree)});
  }
  nodes[changed].reaches = true;
  auto const refers = [&](Dependence const& node, std::size_t to) {
    return std::any_of(node.references.begin(), node.references.end(),
                       [&](ItemReference const& each) { return each.kind == items[to].kind && each.name == items[to].name; });
  };
  // Blocks do not refer in circles; as many passes as there are items reach all.
  for (std::size_t pass = 0; pass < items.size(); ++pass)
    for (std::size_t i = 0; i < items.size(); ++i)
      for (std::size_t j = 0; j < items.size() && !nodes[i].reaches; ++j)
        nodes[i].reaches = items[i].kind != ItemKind::task && nodes[j].reaches && refers(nodes[i], j);
  for (std::size_t pass = 0; pass < items.size(); ++pass)
    for (std::size_t i = 0; i < items.size(); ++i) {
      bool const holds = items[i].kind == ItemKind::task ? run.contains(items[i].name) : nodes[i].held;
      for (std::size_t j = 0; j < items.size() && holds; ++j)
        nodes[j].held = nodes[j].held || (nodes[j].reaches && refers(nodes[i], j));
    }
  return nodes;
}

/// What is kept of what was called so.
using KeptNames = std::map<std::pair<ItemKind, std::string>, std::string>;

/// Where the text refers to what is kept, and how.
std::map<std::uint32_t, std::pair<std::uint32_t, std::string>> renamed(Dependence const& node, KeptNames const& names) {
  std::map<std::uint32_t, std::pair<std::uint32_t, std::string>> all;
  for (ItemReference const& each : node.references)
    if (auto const name = names.find({each.kind, each.name}); name != names.end())
      all[each.span.begin] = {each.span.end, name->second};
  return all;
}

/// A task that was run goes on with what it was run on.
WorkItem reading_kept(WorkItem task, Dependence const& node, KeptNames const& names) {
  task.text = replaced(task.text, renamed(node, names));
  // Without a name of its own it would be called after the model's new one.
  if (node.own.begin == node.own.end) task.text = task.name + " = " + task.text;
  return task;
}

/// As it was, under its new name.
WorkItem kept(WorkItem item, Dependence const& node, KeptNames const& names) {
  item.kept_of = item.name;
  item.name = names.at({item.kind, item.kept_of});
  auto places = renamed(node, names);
  places[node.own.begin] = {node.own.end, item.name};
  item.text = replaced(item.text, places);
  return item;
}

}  // namespace

std::string title_of(ItemKind kind, std::string_view name) { return std::string(word_of(kind)) + " " + std::string(name); }

std::string_view word_of(ItemKind kind) {
  switch (kind) {
    case ItemKind::use:
      return "module";
    case ItemKind::model:
      return "model";
    case ItemKind::data:
      return "data";
    case ItemKind::candidates:
      return "candidates";
    case ItemKind::dictionary:
      return "dictionary";
    case ItemKind::function:
      return "function";
    case ItemKind::task:
      return "task";
  }
  return "";
}

ItemKind kind_of(ast::Item const& item) { return static_cast<ItemKind>(item.index()); }

std::string name_of(ast::Item const& item) {
  return std::visit(
      [](auto const& each) -> std::string {
        using Each = std::decay_t<decltype(each)>;
        if constexpr (std::is_same_v<Each, ast::Use>)
          return each.module.text;
        else if constexpr (std::is_same_v<Each, ast::Task>)
          return each.called();
        else
          return each.name.text;
      },
      item);
}

Span span_of(ast::Item const& item) {
  return std::visit([](auto const& each) { return each.span; }, item);
}

std::vector<ItemReference> references_of(ast::Item const& item) {
  std::vector<ItemReference> found;
  auto const add = [&](ItemKind kind, ast::Name const& name) { found.push_back({kind, name.span, name.text}); };
  if (auto const* model = std::get_if<ast::Model>(&item)) {
    for (ast::ModelStatement const& statement : model->statements)
      if (auto const* part = std::get_if<ast::Part>(&statement)) add(ItemKind::model, part->model.function);
  } else if (auto const* set = std::get_if<ast::Candidates>(&item)) {
    for (ast::CandidateStatement const& statement : set->statements)
      if (auto const* candidate = std::get_if<ast::Candidate>(&statement)) add(ItemKind::model, candidate->model);
  } else if (auto const* task = std::get_if<ast::Task>(&item)) {
    auto const kind = words::task_kind(task->verb.text);
    if (kind == TaskKind::predict) {
      add(ItemKind::task, task->subject);
      for (ast::Name const& other : task->others) add(ItemKind::task, other);
    } else if (kind == TaskKind::discover) {
      add(ItemKind::dictionary, task->subject);
    } else {
      add(ItemKind::model, task->subject);
      if (kind == TaskKind::select) add(ItemKind::candidates, task->subject);
    }
    for (ast::DataReference const& data : task->data) add(ItemKind::data, data.data);
    for (ast::Option const& option : task->options) {
      auto const* near = std::get_if<ast::Box<ast::Call>>(&option.value.node);
      if (!option.key || option.key->text != "search" || near == nullptr || (*near)->arguments.empty()) continue;
      if (auto const* fit = std::get_if<ast::Reference>(&(*near)->arguments[0].value.node)) add(ItemKind::task, fit->name);
    }
  }
  return found;
}

ast::Item item_of(std::string const& text) {
  Diagnostics diagnostics;
  auto tree = parse(Source("", text), diagnostics);
  if (!tree || tree->items.size() != 1) throw InternalError("a statement of the work does not parse alone");
  return std::move(tree->items.front());
}

std::string Workspace::text() const {
  std::string all;
  for (WorkItem const& item : items) all += item.lead + item.text + '\n';
  return all;
}

std::uint32_t Workspace::begin(std::size_t item) const {
  std::size_t at = 0;
  for (std::size_t i = 0; i < item; ++i) at += items[i].lead.size() + items[i].text.size() + 1;
  return static_cast<std::uint32_t>(at + items[item].lead.size());
}

std::size_t Workspace::find(ItemKind kind, std::string_view name) const {
  return static_cast<std::size_t>(
      std::find_if(items.begin(), items.end(), [&](WorkItem const& each) { return each.kind == kind && each.name == name; }) -
      items.begin());
}

std::size_t Workspace::find(std::string_view name) const {
  return static_cast<std::size_t>(
      std::find_if(items.begin(), items.end(),
                   [&](WorkItem const& each) { return each.kind != ItemKind::use && each.name == name; }) -
      items.begin());
}

std::vector<std::string> Workspace::put(WorkItem item, std::set<std::string> const& run) {
  std::size_t const place = find(item.kind, item.name);
  if (place == items.size()) {
    items.push_back(std::move(item));
    return {};
  }
  if (items[place].text == item.text) {
    items[place].typed = item.typed;
    return {};
  }
  std::vector<std::string> notices;
  if (item.kind == ItemKind::task) {
    bool const referred = std::any_of(items.begin(), items.end(), [&](WorkItem const& other) {
      if (other.kind != ItemKind::task || other.name == item.name) return false;
      auto const references = references_of(item_of(other.text));
      return std::any_of(references.begin(), references.end(),
                         [&](ItemReference const& each) { return each.kind == ItemKind::task && each.name == item.name; });
    });
    if (!referred) {
      items.erase(items.begin() + static_cast<std::ptrdiff_t>(place));
      items.push_back(std::move(item));
      return {};
    }
  } else {
    notices = keep_earlier(place, run);
  }
  WorkItem& old = items[find(item.kind, item.name)];
  item.lead = old.lead;
  old = std::move(item);
  return notices;
}

std::vector<std::string> Workspace::keep_earlier(std::size_t changed, std::set<std::string> const& run) {
  std::vector<Dependence> const nodes = dependences(items, changed, run);
  if (!nodes[changed].held) return {};
  KeptNames names;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (!nodes[i].held) continue;
    int number = 1;
    while (find(fmt::format("{}_{}", items[i].name, number)) < items.size()) ++number;
    names[{items[i].kind, items[i].name}] = fmt::format("{}_{}", items[i].name, number);
  }
  std::vector<WorkItem> after;
  std::vector<std::string> notices;
  for (std::size_t i = 0; i < items.size(); ++i) {
    bool const task = items[i].kind == ItemKind::task && run.contains(items[i].name);
    WorkItem item = task ? reading_kept(items[i], nodes[i], names) : items[i];
    if (nodes[i].held) {
      WorkItem earlier = kept(items[i], nodes[i], names);
      if (i == changed)
        notices.push_back(fmt::format("the earlier `{}` is kept as `{}`, with the tasks that used it", item.name, earlier.name));
      after.push_back(std::move(earlier));
      item.lead.clear();
    }
    after.push_back(std::move(item));
  }
  items = std::move(after);
  return notices;
}

void Workspace::prune() {
  for (bool again = true; again;) {
    std::set<std::pair<ItemKind, std::string>> wanted;
    for (WorkItem const& item : items)
      for (ItemReference const& each : references_of(item_of(item.text))) wanted.insert({each.kind, each.name});
    again = std::erase_if(items, [&](WorkItem const& item) {
              return !item.kept_of.empty() && !wanted.contains({item.kind, item.name});
            }) > 0;
  }
}

void Workspace::move_to(std::filesystem::path const& to) {
  namespace fs = std::filesystem;
  fs::path const before = fs::absolute(path).parent_path(), after = fs::absolute(to).parent_path();
  path = to;
  if (before.lexically_normal() == after.lexically_normal()) return;
  for (WorkItem& item : items) {
    if (item.kind != ItemKind::data) continue;
    ast::Data const data = std::get<ast::Data>(item_of(item.text));
    for (ast::DataStatement const& statement : data.statements) {
      auto const* file = std::get_if<ast::DataFile>(&statement);
      if (file == nullptr || fs::path(file->path.value).is_absolute()) continue;
      std::string const seen = (before / file->path.value).lexically_normal().lexically_relative(after.lexically_normal()).string();
      item.text.replace(file->path.span.begin, file->path.span.end - file->path.span.begin, string_literal(seen));
    }
  }
}

std::vector<WorkItem> items_of(std::string const& text) {
  Diagnostics diagnostics;
  auto const tree = parse(Source("", text), diagnostics);
  if (!tree) throw InternalError("a text that was parsed does not parse again");
  std::vector<WorkItem> items;
  std::size_t end = 0;
  for (ast::Item const& each : tree->items) {
    Span const span = span_of(each);
    std::size_t begin = end;
    while (begin < span.begin && blank(text[begin])) ++begin;
    std::size_t stop = span.end;
    // A comment behind the statement belongs to it.
    std::size_t const line = std::min(text.find('\n', stop), text.size());
    std::size_t const next = text.find_first_not_of(" \t;", stop);
    if (next < line && (text[next] == '#' || text.compare(next, 2, "//") == 0)) stop = line;
    WorkItem item{kind_of(each), name_of(each), text.substr(begin, span.begin - begin), text.substr(span.begin, stop - span.begin)};
    items.push_back(std::move(item));
    end = stop;
  }
  return items;
}

}  // namespace sysid::repl
