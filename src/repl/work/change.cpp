// Places of named things in a block, and text put in for them.
#include "repl/work/change.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "repl/work/entry.hpp"
#include "syntax/entry.hpp"
#include "syntax/expression_text.hpp"
#include "syntax/unparse.hpp"
#include "syntax/walk.hpp"

namespace sysid::repl {
namespace {

/// The name spaces of a block, in the order in which a name alone is looked up: where it is declared, then where it is given more.
enum class SlotKind { name, function, equation, input, measure, constant, split, read, observe, initial, time, file };

/// Something with a name in a block: a statement, or an element of one. Of what there is one of, and of equations, the name is
/// empty.
struct Slot {
  SlotKind kind;
  std::string name;
  Span span;
};

/// A statement as named things. list: its elements are things of their own, under a word that they share.
struct Named {
  std::vector<Slot> slots;
  bool list = false;
  bool joins = false;  // a list that new elements are added to
  std::string word{};  // before the elements of a list
};

Named named(ast::ModelStatement const& statement) {
  return std::visit(
      [](auto const& each) -> Named {
        using Each = std::decay_t<decltype(each)>;
        if constexpr (std::is_same_v<Each, ast::InputDeclaration> || std::is_same_v<Each, ast::StateDeclaration>) {
          Named result{{}, true, false, std::is_same_v<Each, ast::InputDeclaration> ? "input" : "state"};
          for (ast::Declared const& name : each.names) result.slots.push_back({SlotKind::name, name.name.text, name.span});
          return result;
        } else if constexpr (std::is_same_v<Each, ast::InitialDeclaration>) {
          Named result{{}, true, true, "initial"};
          for (ast::InitialValue const& value : each.values)
            result.slots.push_back({SlotKind::initial, text_of(value.state), value.span});
          return result;
        } else if constexpr (std::is_same_v<Each, ast::ParameterDeclaration> || std::is_same_v<Each, ast::Definition> ||
                             std::is_same_v<Each, ast::DisturbanceDeclaration>) {
          return {{{SlotKind::name, each.name.name.text, each.span}}};
        } else if constexpr (std::is_same_v<Each, ast::FunctionDefinition> || std::is_same_v<Each, ast::ProcessDefinition>) {
          return {{{SlotKind::function, each.name.text, each.span}}};
        } else if constexpr (std::is_same_v<Each, ast::Observation>) {
          return {{{SlotKind::observe, each.channel.name.text, each.span}}};
        } else if constexpr (std::is_same_v<Each, ast::Part>) {
          return {{{SlotKind::name, each.name.text, each.span}}};
        } else if constexpr (std::is_same_v<Each, ast::Equation>) {
          return {{{SlotKind::equation, "", each.span}}};
        } else {
          return {{{SlotKind::time, "", each.span}}};
        }
      },
      statement);
}

Named named(ast::DataStatement const& statement) {
  return std::visit(
      [](auto const& each) -> Named {
        using Each = std::decay_t<decltype(each)>;
        if constexpr (std::is_same_v<Each, ast::DataFile>) {
          return {{{SlotKind::file, "", each.span}}};
        } else if constexpr (std::is_same_v<Each, ast::DataTime> || std::is_same_v<Each, ast::DataRate>) {
          return {{{SlotKind::time, "", each.span}}};
        } else if constexpr (std::is_same_v<Each, ast::DataInput>) {
          return {{{SlotKind::input, each.input.text, each.span}}};
        } else if constexpr (std::is_same_v<Each, ast::DataMeasure>) {
          return {{{SlotKind::measure, each.channel.text, each.span}}};
        } else if constexpr (std::is_same_v<Each, ast::DataConstant>) {
          return {{{SlotKind::constant, each.parameter.text, each.span}}};
        } else if constexpr (std::is_same_v<Each, ast::DataReading>) {
          Named result{{}, true, true, "read"};
          for (ast::ReadingSetting const& setting : each.settings)
            result.slots.push_back({SlotKind::read, setting.name.text, setting.span});
          return result;
        } else {
          Named result{{}, true, true, "split"};
          for (ast::SplitPart const& part : each.parts) result.slots.push_back({SlotKind::split, part.name.text, part.span});
          return result;
        }
      },
      statement);
}

/// The text of a block under change, with what of it was typed.
class Editor {
 public:
  Editor(std::string text, std::vector<TypedPart> typed) : text_(std::move(text)), typed_(std::move(typed)) {}

  /// [begin, end) becomes before + the typed text of `from` + after.
  void replace(std::uint32_t begin, std::uint32_t end, std::string_view before, std::string const& entry, Span from,
               std::string_view after = {}) {
    std::string const put = std::string(before) + entry.substr(from.begin, from.end - from.begin) + std::string(after);
    text_.replace(begin, end - begin, put);
    auto const moved = [by = static_cast<std::int64_t>(put.size()) - (end - begin)](std::uint32_t at) {
      return static_cast<std::uint32_t>(at + by);
    };
    std::vector<TypedPart> kept;
    for (TypedPart const& each : typed_) {
      Span const at = each.in_text;
      // A block that was typed in the same entry goes on behind what is put into it.
      if (at.begin < begin) kept.push_back({{at.begin, std::min(at.end, begin)}, each.in_typed});
      std::uint32_t const rest = std::max(at.begin, end);
      if (rest < at.end) kept.push_back({{moved(rest), moved(at.end)}, each.in_typed + (rest - at.begin)});
    }
    typed_ = std::move(kept);
    auto const first = static_cast<std::uint32_t>(begin + before.size());
    typed_.push_back({{first, first + (from.end - from.begin)}, from.begin});
  }
  /// Behind a statement and the comment in its line.
  void add_behind(std::uint32_t statement_end, std::string const& entry, Span from, std::string_view word = {}) {
    std::size_t const line = std::min(text_.find('\n', statement_end), text_.size());
    std::size_t const next = text_.find_first_not_of(" \t", statement_end);
    bool const to_line_end = next >= line || text_[next] == '#' || text_.compare(next, 2, "//") == 0;
    auto const at = to_line_end ? static_cast<std::uint32_t>(line) : statement_end;
    replace(at, at, "\n  " + std::string(word), entry, from,
            text_.compare(at, 1, "}") == 0 || text_.compare(at, 2, " }") == 0 ? "\n" : "");
  }
  std::string const& text() const { return text_; }
  std::vector<TypedPart> take_typed() { return std::move(typed_); }

 private:
  std::string text_;
  std::vector<TypedPart> typed_;
};

using Orders = std::map<std::string, int>;

void note_orders(ast::Equation const& equation, std::set<std::string> const& states, Orders& orders) {
  auto const note = [&](ast::Reference const& reference) {
    if (states.contains(reference.name.text)) orders[reference.name.text] = std::max(orders[reference.name.text], reference.primes);
  };
  each_reference(equation, note);
}

/// The states whose highest derivative stands in the equation.
std::set<std::string> leads(ast::Equation const& equation, Orders const& orders) {
  std::set<std::string> result;
  auto const note = [&](ast::Reference const& reference) {
    auto const order = orders.find(reference.name.text);
    if (order != orders.end() && reference.primes == order->second) result.insert(order->first);
  };
  each_reference(equation, note);
  return result;
}

/// The equation of the model that `typed` is meant to replace.
std::optional<Span> replaced_equation(ast::Model const& model, ast::Equation const& typed) {
  std::set<std::string> states;
  std::vector<ast::Equation const*> equations;
  for (ast::ModelStatement const& statement : model.statements) {
    if (auto const* declaration = std::get_if<ast::StateDeclaration>(&statement))
      for (ast::Declared const& name : declaration->names) states.insert(name.name.text);
    if (auto const* equation = std::get_if<ast::Equation>(&statement)) equations.push_back(equation);
  }
  Orders orders;
  for (ast::Equation const* each : equations) note_orders(*each, states, orders);
  std::optional<Span> found;
  int matches = 0;
  auto const wanted = leads(typed, orders);
  for (ast::Equation const* each : equations)
    if (!wanted.empty() && leads(*each, orders) == wanted) {
      found = each->span;
      ++matches;
    }
  if (matches == 1) return found;
  if (equations.size() == 1 && states.size() == 1) return equations.front()->span;
  return std::nullopt;
}

template <class Statement>
std::vector<Named> all_named(std::vector<Statement> const& statements) {
  std::vector<Named> all;
  for (Statement const& each : statements) all.push_back(named(each));
  return all;
}

/// Ranks of statements of a model by where they usually stand.
int rank(ast::ModelStatement const& statement) {
  if (std::holds_alternative<ast::Equation>(statement)) return 2;
  if (std::holds_alternative<ast::Observation>(statement)) return 3;
  auto const* definition = std::get_if<ast::Definition>(&statement);
  return definition != nullptr && definition->kind == ast::DefinitionKind::derived ? 4 : 1;
}
int rank(ast::DataStatement const& statement) { return static_cast<int>(statement.index()); }

Span span_of(auto const& statement) {
  return std::visit([](auto const& each) { return each.span; }, statement);
}

/// Behind which statement one of `typed`'s kind goes; the opening brace when behind none.
template <class Block, class Statement>
std::uint32_t place_for(Block const& block, Statement const& typed, std::string const& text) {
  std::optional<std::uint32_t> same, before;
  for (Statement const& each : block.statements) {
    if (each.index() == typed.index() && rank(each) == rank(typed)) same = span_of(each).end;
    if (rank(each) <= rank(typed)) before = span_of(each).end;
  }
  if (same) return *same;
  if (before) return *before;
  return static_cast<std::uint32_t>(text.find('{') + 1);
}

Span moved_back(Span span, std::uint32_t by) { return {span.begin - by, span.end - by}; }

template <class Block, class Statement>
void put(Editor& editor, std::string const& entry, Span at, Statement const& typed, std::uint32_t frame) {
  auto const block = [&] { return std::get<Block>(item_of(editor.text())); };
  Named const incoming = named(typed);
  auto const in_entry = [&](Span span) {
    Span const inside = moved_back(span, frame);
    return Span{at.begin + inside.begin, at.begin + inside.end};
  };
  for (Slot const& element : incoming.slots) {
    Block const current = block();
    Span const text = incoming.list ? in_entry(element.span) : at;
    std::optional<Span> place;
    std::optional<std::uint32_t> list_end;
    for (Named const& each : all_named(current.statements))
      for (Slot const& there : each.slots) {
        if (there.kind == element.kind && there.name == element.name && each.list == incoming.list && each.word == incoming.word)
          place = there.span;
        if (each.joins && each.word == incoming.word) list_end = there.span.end;
      }
    if constexpr (std::is_same_v<Block, ast::Model>)
      if (auto const* equation = std::get_if<ast::Equation>(&typed)) place = replaced_equation(current, *equation);
    if (place)
      editor.replace(place->begin, place->end, "", entry, text);
    else if (incoming.joins && list_end)
      editor.replace(*list_end, *list_end, ", ", entry, text);
    else
      editor.add_behind(place_for(current, typed, editor.text()), entry, text, incoming.list ? incoming.word + " " : "");
  }
}

/// The units that the parameters of a model are declared in; empty for none.
std::map<std::string, std::string> parameter_units(WorkItem const& model) {
  std::map<std::string, std::string> units;
  ast::Item const item = item_of(model.text);
  for (ast::ModelStatement const& statement : std::get<ast::Model>(item).statements)
    if (auto const* parameter = std::get_if<ast::ParameterDeclaration>(&statement))
      units[parameter->name.name.text] = parameter->name.unit ? unparse(*parameter->name.unit) : "";
  return units;
}

/// Of constants and definitions those that are numbers without a unit, which may replace a parameter.
std::set<std::string> bare_numbers(WorkItem const& model) {
  std::set<std::string> names;
  ast::Item const item = item_of(model.text);
  for (ast::ModelStatement const& statement : std::get<ast::Model>(item).statements) {
    auto const* definition = std::get_if<ast::Definition>(&statement);
    if (definition == nullptr || definition->name.unit) continue;
    bool bare = true;
    each_expression(definition->value, [&](ast::Expression const& each) {
      auto const* number = std::get_if<ast::Number>(&each.node);
      bare = bare && !std::holds_alternative<ast::Reference>(each.node) && (number == nullptr || !number->unit);
    });
    if (bare) names.insert(definition->name.name.text);
  }
  return names;
}

/// Blanks tell no two equations of a model apart.
std::string without_blanks(std::string text) {
  std::erase_if(text, [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; });
  return text;
}

}  // namespace

WorkItem with_statement(WorkItem block, std::string const& entry, Span span) {
  std::string const text = entry.substr(span.begin, span.end - span.begin);
  Editor editor(block.text, block.typed);
  if (block.kind == ItemKind::model)
    put<ast::Model>(editor, entry, span, model_statement_of(text), model_frame);
  else
    put<ast::Data>(editor, entry, span, data_statement_of(text), data_frame);
  block.text = editor.text();
  block.typed = editor.take_typed();
  return block;
}

std::vector<LostUnit> lost_units(WorkItem const& before, WorkItem const& after) {
  if (before.kind != ItemKind::model) return {};
  std::map<std::string, std::string> const had = parameter_units(before), has = parameter_units(after);
  std::set<std::string> const numbers = bare_numbers(after);
  std::vector<LostUnit> lost;
  for (auto const& [name, unit] : had) {
    auto const now = has.find(name);
    bool const without = now != has.end() ? now->second.empty() : numbers.contains(name);
    if (!unit.empty() && without) lost.push_back({name, unit});
  }
  return lost;
}

WorkItem without_statement(WorkItem block, std::string const& what) {
  std::optional<SlotKind> found;
  std::optional<Span> place;
  std::size_t in_list = 0;
  std::string const wanted = without_blanks(what);
  auto const is_meant = [&](Slot const& slot) {
    if (slot.kind != SlotKind::equation) return slot.name == what && !what.empty();
    return without_blanks(in_one_line(block.text.substr(slot.span.begin, slot.span.end - slot.span.begin))) == wanted;
  };
  auto const look = [&](auto const& statements) {
    for (auto const& statement : statements) {
      Named const each = named(statement);
      for (Slot const& slot : each.slots)
        if ((!found || slot.kind < *found) && is_meant(slot)) {
          found = slot.kind;
          place = span_of(statement);
          in_list = each.slots.size();
        }
    }
  };
  if (block.kind == ItemKind::model)
    look(std::get<ast::Model>(item_of(block.text)).statements);
  else
    look(std::get<ast::Data>(item_of(block.text)).statements);
  if (!place || in_list != 1) return block;
  // With its line where it has one to itself.
  std::size_t begin = place->begin, end = place->end;
  while (begin > 0 && (block.text[begin - 1] == ' ' || block.text[begin - 1] == '\t')) --begin;
  bool const own_line = begin > 0 && block.text[begin - 1] == '\n' && end < block.text.size() && block.text[end] == '\n';
  if (own_line) --begin;
  block.text.erase(own_line ? begin : place->begin, end - (own_line ? begin : place->begin));
  block.typed.clear();
  return block;
}

}  // namespace sysid::repl
