// Words of the language, names, functions at the top of a file and tasks; statements: use_resolver_statements.cpp.
#include "assist/use_resolver.hpp"

#include <algorithm>
#include <array>
#include <set>

#include "check/expression/option_reader.hpp"
#include "core/text/without_index.hpp"

namespace sysid::assist {
namespace {

constexpr std::array<std::string_view, 3> channel_functions{"measured", "predicted", "residual"};

bool reads_channel(std::string const& function) {
  return std::find(channel_functions.begin(), channel_functions.end(), function) != channel_functions.end();
}

}  // namespace

// --- words of the language ---

void UseResolver::word(Span span, Word const& word, std::string const& owner) {
  auto const [place, fresh] = words_.emplace(std::to_string(static_cast<int>(word.kind)) + " " + owner + " " + word.name, 0);
  if (fresh) {
    Symbol symbol;
    symbol.kind = SymbolKind::word;
    symbol.name = word.name;
    symbol.signature = word.signature;
    symbol.summary = word.summary;
    place->second = table_.add(std::move(symbol));
  }
  table_.mention(span, place->second);
}

void UseResolver::setting(ast::Name const& name, std::string const& owner) {
  for (Word const& each : settings_of(owner))
    if (each.name == name.text) return word(name.span, each, owner);
}

void UseResolver::value(ast::Expression const& tree, std::string const& owner, std::string const& setting, Place const& place) {
  ast::Call const* called = as_call(tree);
  auto const name = called != nullptr ? std::optional(called->function.text) : as_word(tree);
  for (Word const& each : choices_of(owner, setting)) {
    if (name != each.name) continue;
    word(head_span(tree), each, owner + "." + setting);
    if (called != nullptr)
      for (ast::Argument const& argument : called->arguments) {
        if (argument.name) this->setting(*argument.name, called->function.text);
        value(argument.value, called->function.text, argument.name ? argument.name->text : "", place);
      }
    return;
  }
  expression(tree, place);
}

void UseResolver::word_call(ast::Call const& call, WordKind kind, Place const& place) {
  if (Word const* known = find_word(kind, call.function.text)) word(call.function.span, *known);
  for (ast::Argument const& argument : call.arguments) {
    if (argument.name) setting(*argument.name, call.function.text);
    value(argument.value, call.function.text, argument.name ? argument.name->text : "", place);
  }
}

// --- names ---

void UseResolver::path(std::string const& text, Span span, int primes, Scopes const& scopes) {
  std::string const names = without_index(text);
  Scopes at = scopes;
  std::size_t begin = 0;
  while (!at.empty()) {
    std::size_t const dot = std::min(names.find('.', begin), names.size());
    std::string const name = names.substr(begin, dot - begin);
    bool const last = dot == names.size();
    std::optional<int> found;
    Scopes next;
    for (NameScope const* scope : at) {
      auto const symbol = scope->quantities.find(name);
      if (symbol == scope->quantities.end()) continue;
      if (found) table_.unite(*found, symbol->second);
      found = found ? found : std::optional(symbol->second);
      auto const part = scope->parts.find(name);
      if (part != scope->parts.end() && part->second != nullptr) next.push_back(&models.at(part->second));
    }
    if (!found) return;
    std::uint32_t const from = span.begin + static_cast<std::uint32_t>(begin);
    table_.mention({from, from + static_cast<std::uint32_t>(name.size())}, *found, last ? primes : 0);
    if (last) return;
    at = std::move(next);
    begin = dot + 1;
  }
}

void UseResolver::element(ast::Name const& name, Scopes const& scopes) { path(name.text, name.span, 0, scopes); }

void UseResolver::channel(ast::Name const& name, Scopes const& scopes) {
  std::string const text = without_index(name.text);
  std::optional<int> found;
  for (NameScope const* scope : scopes) {
    auto const symbol = scope->channels.find(text);
    if (symbol == scope->channels.end()) continue;
    if (found) table_.unite(*found, symbol->second);
    found = found ? found : std::optional(symbol->second);
  }
  if (found) table_.mention({name.span.begin, name.span.begin + static_cast<std::uint32_t>(text.size())}, *found);
}

void UseResolver::arguments_of_model(std::vector<ast::Argument> const& arguments, Scopes const& scopes) {
  for (ast::Argument const& argument : arguments)
    if (argument.name) element(*argument.name, scopes);
}

void UseResolver::reference(ast::Reference const& reference, Place const& place) {
  for (ast::Expression const& index : reference.index) expression(index, place);
  std::string const& name = reference.name.text;
  if (place.locals != nullptr)
    if (auto const local = place.locals->find(name); local != place.locals->end())
      return table_.mention(reference.name.span, local->second, reference.primes);
  if (place.shared != nullptr) {
    open_[place.shared].push_back({name, reference.name.span, reference.primes});
    return;
  }
  if (place.scope == nullptr) return;
  if (place.scope->quantities.contains(name.substr(0, name.find('.'))))
    return path(name, reference.name.span, reference.primes, {place.scope});
}

void UseResolver::expression(ast::Expression const& tree, Place const& place) {
  std::visit(
      [&](auto const& node) {
        using Node = std::decay_t<decltype(node)>;
        if constexpr (std::is_same_v<Node, ast::Number>) {
          unit(node.unit, place);
        } else if constexpr (std::is_same_v<Node, ast::Reference>) {
          reference(node, place);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Unary>>) {
          expression(*node->operand, place);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Binary>>) {
          expression(*node->left, place);
          expression(*node->right, place);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Call>>) {
          call(*node, place);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Conditional>>) {
          expression(*node->condition, place);
          expression(*node->then, place);
          expression(*node->otherwise, place);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::List>>) {
          for (ast::Expression const& item : node->items) expression(item, place);
        }
      },
      tree.node);
}

void UseResolver::unit(std::optional<ast::UnitExpression> const& tree, Place const& place) {
  if (!tree) return;
  for (ast::UnitFactor const& factor : tree->factors) {
    if (auto const* group = std::get_if<ast::Box<ast::UnitExpression>>(&factor.base)) unit(**group, place);
    if (factor.exponent) expression(**factor.exponent, place);
  }
}

void UseResolver::call(ast::Call const& call, Place const& place) {
  std::string const& name = call.function.text;
  std::optional<int> own;
  if (place.scope != nullptr && place.shared == nullptr)
    if (auto const found = place.scope->functions.find(name); found != place.scope->functions.end()) own = found->second;
  if (!own && place.home != nullptr)
    if (auto const found = place.home->functions.find(name); found != place.home->functions.end()) {
      own = functions.at(found->second.tree);
      if (place.calls != nullptr) place.calls->push_back(found->second.tree);
    }
  bool const of_channel = !own && reads_channel(name);
  bool const family = !own && find_word(WordKind::family, name) != nullptr && find_word(WordKind::function, name) == nullptr;
  if (own)
    table_.mention(call.function.span, *own);
  else if (Word const* known = find_word(family ? WordKind::family : WordKind::function, name))
    word(call.function.span, *known);
  for (ast::Argument const& argument : call.arguments) {
    if (argument.name && family) setting(*argument.name, name);
    auto const* channel_name = of_channel ? std::get_if<ast::Reference>(&argument.value.node) : nullptr;
    if (channel_name != nullptr && (place.channels != nullptr || place.scope != nullptr)) {
      channel(channel_name->name, place.channels != nullptr ? *place.channels : Scopes{place.scope});
      for (ast::Expression const& index : channel_name->index) expression(index, place);
    } else {
      expression(argument.value, place);
    }
  }
}

// --- functions at the top of a file ---

std::vector<ast::FunctionDefinition const*> UseResolver::reached_from(NameScope const& scope) {
  std::vector<ast::FunctionDefinition const*> reached, open = calls_of_scopes_[&scope];
  std::set<ast::FunctionDefinition const*> seen;
  while (!open.empty()) {
    auto const* next = open.back();
    open.pop_back();
    if (!seen.insert(next).second) continue;
    reached.push_back(next);
    auto const& further = calls_of_functions_[next];
    open.insert(open.end(), further.begin(), further.end());
  }
  return reached;
}

void UseResolver::resolve_open_names() {
  std::map<ast::FunctionDefinition const*, Scopes> callers;
  for (auto const& [model, scope] : models)
    for (auto const* function : reached_from(scope)) callers[function].push_back(&scope);
  for (auto const& [dictionary, scope] : dictionaries)
    for (auto const* function : reached_from(scope)) callers[function].push_back(&scope);
  for (auto& [function, names] : open_) {
    Scopes& scopes = callers[function];
    std::sort(scopes.begin(), scopes.end(), [](NameScope const* a, NameScope const* b) { return a->symbol < b->symbol; });
    for (OpenName const& name : names) path(name.text, name.span, name.primes, scopes);
  }
}

// --- tasks ---

void UseResolver::options(ast::Task const& task, Scopes const& scopes, Environment const& home) {
  Place place;
  place.home = &home;
  for (ast::Argument const& argument : task.arguments) expression(argument.value, place);
  for (ast::Option const& each : task.options) option(each, task, scopes, place);
}

void UseResolver::option(ast::Option const& option, ast::Task const& task, Scopes const& scopes, Place const& place) {
  std::string const key = key_of(option);
  if (option.input) {
    element(*option.key, scopes);
    if (ast::Call const* signal = as_call(option.value)) return word_call(*signal, WordKind::signal, place);
    return expression(option.value, place);
  }
  Span const head = option.key ? option.key->span : head_span(option.value);
  for (Word const& each : options_of(task.verb.text))
    if (each.name == key) word(head, each, task.verb.text);
  ast::Call const* call = as_call(option.value);
  if (!option.key && call != nullptr && (key == "values" || key == "weights" || key == "noise")) {
    for (ast::Argument const& argument : call->arguments) {
      if (argument.name && key == "values") element(*argument.name, scopes);
      if (argument.name && key != "values") channel(*argument.name, scopes);
      expression(argument.value, place);
    }
    return;
  }
  if (option.key && key == "distance") {
    Place of_distance = place;
    of_distance.channels = &scopes;
    return value(option.value, task.verb.text, key, of_distance);
  }
  if (option.key && key == "search" && call != nullptr)  // near(posterior)
    for (ast::Argument const& argument : call->arguments)
      if (auto const* fit = std::get_if<ast::Reference>(&argument.value.node))
        if (auto const known = tasks.find(fit->name.text); known != tasks.end()) table_.mention(fit->name.span, known->second);
  if (option.key) return value(option.value, task.verb.text, key, place);
  WordKind const kind = backends_of(task.verb.text);
  if (find_word(kind, key) != nullptr) {
    if (call != nullptr) return word_call(*call, kind, place);
    return word(head, *find_word(kind, key));
  }
  if (call != nullptr)
    for (ast::Argument const& argument : call->arguments) expression(argument.value, place);
}

}  // namespace sysid::assist
