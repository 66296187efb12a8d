// Declarations, in the order of the text.
#include "assist/name_scopes.hpp"
#include "core/text/without_index.hpp"

#include <algorithm>
#include <numeric>

namespace sysid::assist {

int TableBuilder::add(Symbol symbol) {
  table_.symbols.push_back(std::move(symbol));
  parent_.push_back(static_cast<int>(parent_.size()));
  return parent_.back();
}

int TableBuilder::declare(SymbolKind kind, ast::Name const& name, Span statement, int owner,
                          std::optional<ast::UnitExpression> unit) {
  int const symbol = add({kind, name.text, name.span, statement, owner, std::move(unit), -1, false, {}, {}});
  mention(name.span, symbol, 0, true);
  return symbol;
}

void TableBuilder::mention(Span span, int symbol, int primes, bool declares) {
  if (span.begin < span.end) table_.occurrences.push_back({span, symbol, declares, primes});
}

int TableBuilder::root(int symbol) {
  while (parent_[static_cast<std::size_t>(symbol)] != symbol) symbol = parent_[static_cast<std::size_t>(symbol)];
  return symbol;
}

void TableBuilder::unite(int a, int b) {
  a = root(a);
  b = root(b);
  parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
}

SymbolTable TableBuilder::take() {
  for (int symbol = 0; symbol < static_cast<int>(parent_.size()); ++symbol) table_.group.push_back(root(symbol));
  auto& all = table_.occurrences;
  // A declaration that is found again as a use stays one.
  std::stable_sort(all.begin(), all.end(), [](Occurrence const& a, Occurrence const& b) {
    return a.span.begin != b.span.begin ? a.span.begin < b.span.begin : a.declares && !b.declares;
  });
  all.erase(std::unique(all.begin(), all.end(), [](Occurrence const& a, Occurrence const& b) { return a.span == b.span; }),
            all.end());
  std::sort(table_.blocks.begin(), table_.blocks.end(), [](Block const& a, Block const& b) { return a.span.begin < b.span.begin; });
  return std::move(table_);
}

namespace {

class Declarer {
 public:
  Declarer(int symbol, Environment const& home, TableBuilder& table) : table_(table) {
    scope_.symbol = symbol;
    scope_.home = &home;
  }

  NameScope take() { return std::move(scope_); }

  void quantity(SymbolKind kind, ast::Declared const& declared, Span statement) {
    enter(scope_.quantities, kind, declared.name, statement, declared.unit);
  }
  void argument(ast::ModelArgument const& argument) {
    enter(scope_.quantities, SymbolKind::model_argument, argument.name, argument.span, {});
  }

  void operator()(ast::TimeDeclaration const& time) { quantity(SymbolKind::time, time.time, time.span); }
  void operator()(ast::InputDeclaration const& inputs) {
    for (ast::Declared const& each : inputs.names) quantity(SymbolKind::input, each, inputs.span);
  }
  void operator()(ast::StateDeclaration const& states) {
    for (ast::Declared const& each : states.names) quantity(SymbolKind::state, each, states.span);
  }
  void operator()(ast::DisturbanceDeclaration const& disturbance) {
    quantity(SymbolKind::disturbance, disturbance.name, disturbance.span);
  }
  void operator()(ast::ParameterDeclaration const& parameter) { quantity(SymbolKind::parameter, parameter.name, parameter.span); }
  void operator()(ast::DictionaryParameter const& parameter) { quantity(SymbolKind::parameter, parameter.name, parameter.span); }
  void operator()(ast::Definition const& definition) {
    SymbolKind const kind = definition.kind == ast::DefinitionKind::constant ? SymbolKind::constant
                            : definition.kind == ast::DefinitionKind::local  ? SymbolKind::local
                                                                             : SymbolKind::derived;
    quantity(kind, definition.name, definition.span);
  }
  void operator()(ast::FunctionDefinition const& function) {
    enter(scope_.functions, SymbolKind::function, function.name, function.span, {});
  }
  void operator()(ast::ProcessDefinition const& process) {
    enter(scope_.functions, SymbolKind::process, process.name, process.span, {});
  }
  void operator()(ast::Observation const& observation) {
    enter(scope_.channels, SymbolKind::channel, observation.channel.name, observation.span, observation.channel.unit);
  }
  void operator()(ast::Part const& part) {
    enter(scope_.quantities, SymbolKind::part, part.name, part.span, {});
    auto const model = scope_.home->models.find(part.model.function.text);
    scope_.parts.emplace(part.name.text, model == scope_.home->models.end() ? nullptr : model->second.tree);
  }
  void operator()(ast::DictionaryStates const& states) {
    // `y'' = acceleration` is about the state that `y [m] = displacement` declares.
    for (ast::DictionaryState const& each : states.states)
      if (each.primes == 0) enter(scope_.quantities, SymbolKind::state, each.name, each.span, each.unit);
    for (ast::DictionaryState const& each : states.states) {
      if (each.primes > 0) {
        auto const known = scope_.quantities.find(each.name.text);
        if (known == scope_.quantities.end())
          enter(scope_.quantities, SymbolKind::state, each.name, each.span, each.unit);
        else
          table_.mention(each.name.span, known->second, each.primes);
      }
      if (each.channel) enter(scope_.channels, SymbolKind::channel, base(*each.channel), each.span, {});
    }
  }
  template <class Other>
  void operator()(Other const&) {}

 private:
  /// Of `force[2]` the name alone.
  static ast::Name base(ast::Name name) {
    name.text = without_index(name.text);
    name.span.end = name.span.begin + static_cast<std::uint32_t>(name.text.size());
    return name;
  }
  void enter(std::map<std::string, int>& names, SymbolKind kind, ast::Name const& name, Span statement,
             std::optional<ast::UnitExpression> const& unit) {
    auto const known = names.find(name.text);
    // Elements of one channel are bound one by one.
    if (known != names.end() && kind == SymbolKind::channel)
      table_.mention(name.span, known->second);
    else
      names.emplace(name.text, table_.declare(kind, name, statement, scope_.symbol, unit));
  }

  TableBuilder& table_;
  NameScope scope_;
};

}  // namespace

NameScope declared(ast::Model const& model, int symbol, Environment const& home, TableBuilder& table) {
  Declarer declarer(symbol, home, table);
  for (ast::ModelArgument const& argument : model.arguments) declarer.argument(argument);
  for (ast::ModelStatement const& statement : model.statements) std::visit(declarer, statement);
  return declarer.take();
}

NameScope declared(ast::Dictionary const& dictionary, int symbol, Environment const& home, TableBuilder& table) {
  Declarer declarer(symbol, home, table);
  for (ast::DictionaryStatement const& statement : dictionary.statements) std::visit(declarer, statement);
  return declarer.take();
}

DataScope declared(ast::Data const& data, int symbol, TableBuilder& table) {
  DataScope scope{symbol, {}};
  for (ast::DataStatement const& statement : data.statements)
    if (auto const* split = std::get_if<ast::DataSplit>(&statement))
      for (ast::SplitPart const& part : split->parts)
        scope.parts.emplace(part.name.text, table.declare(SymbolKind::data_part, part.name, part.span, symbol));
  return scope;
}

}  // namespace sysid::assist
