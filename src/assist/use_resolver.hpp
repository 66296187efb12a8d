// The names in expressions and calls, to what they mean in a model, a dictionary, a function or a task.
#pragma once
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "assist/name_scopes.hpp"
#include "assist/vocabulary.hpp"

namespace sysid::assist {

class UseResolver {
 public:
  explicit UseResolver(TableBuilder& table) : table_(table) {}

  std::map<ast::Model const*, NameScope> models;
  std::map<ast::Dictionary const*, NameScope> dictionaries;
  std::map<ast::FunctionDefinition const*, int> functions;  // those at the top of files
  std::map<std::string, int> tasks;

  void walk(ast::Model const& model);
  void walk(ast::Dictionary const& dictionary);
  void walk(ast::FunctionDefinition const& function, Environment const& home);
  /// An expression outside of models: units, functions, no quantities.
  void plain(ast::Expression const& expression, Environment const& home);
  /// A distribution outside of models.
  void distribution(ast::Call const& call, Environment const& home);
  void options(ast::Task const& task, std::vector<NameScope const*> const& scopes, Environment const& home);
  /// `n = 2` given to models.
  void arguments_of_model(std::vector<ast::Argument> const& arguments, std::vector<NameScope const*> const& scopes);
  /// `spring.k`, `q[2]`: in each of the scopes that has it; they are one name from then on.
  void element(ast::Name const& name, std::vector<NameScope const*> const& scopes);
  void channel(ast::Name const& name, std::vector<NameScope const*> const& scopes);
  /// A function at the top may read names of the models that call it: after all else.
  void resolve_open_names();

 private:
  using Scopes = std::vector<NameScope const*>;
  /// Where an expression stands.
  struct Place {
    NameScope const* scope = nullptr;                              // the model or dictionary; nullptr: none
    Environment const* home = nullptr;                             // whose functions are meant
    std::map<std::string, int> const* locals = nullptr;            // arguments of the function around it
    ast::FunctionDefinition const* shared = nullptr;               // the function at the top around it
    Scopes const* channels = nullptr;                              // of a distance: the candidates
    std::vector<ast::FunctionDefinition const*>* calls = nullptr;  // functions at the top that are called
  };

  void expression(ast::Expression const& expression, Place const& place);
  void reference(ast::Reference const& reference, Place const& place);
  void path(std::string const& text, Span span, int primes, Scopes const& scopes);
  void call(ast::Call const& call, Place const& place);
  /// A call whose name is a word of the language with settings by name.
  void word_call(ast::Call const& call, WordKind kind, Place const& place);
  void covariance(ast::Expression const& expression, ast::ProcessDefinition const& process,
                  std::map<std::string, int> const& inputs, Place const& place);
  void unit(std::optional<ast::UnitExpression> const& unit, Place const& place);
  void declared(ast::Declared const& declared, Place const& place);
  void function(ast::FunctionDefinition const& function, int symbol, Place place);
  void option(ast::Option const& option, ast::Task const& task, Scopes const& scopes, Place const& place);
  void setting(ast::Name const& name, std::string const& owner);
  void value(ast::Expression const& expression, std::string const& owner, std::string const& setting, Place const& place);
  void word(Span span, Word const& word, std::string const& owner = {});
  std::vector<ast::FunctionDefinition const*> reached_from(NameScope const& scope);

  // statements
  void statement(ast::TimeDeclaration const& each, Place const& place) { declared(each.time, place); }
  void statement(ast::DiscreteTimeDeclaration const& each, Place const& place) {
    if (each.step) expression(*each.step, place);
  }
  void statement(ast::InputDeclaration const& each, Place const& place) {
    for (ast::Declared const& name : each.names) declared(name, place);
  }
  void statement(ast::StateDeclaration const& each, Place const& place) {
    for (ast::Declared const& name : each.names) declared(name, place);
  }
  void statement(ast::InitialDeclaration const& each, Place const& place);
  void statement(ast::DisturbanceDeclaration const& each, Place const& place);
  void statement(ast::ParameterDeclaration const& each, Place const& place);
  void statement(ast::Definition const& each, Place const& place);
  void statement(ast::FunctionDefinition const& each, Place const& place);
  void statement(ast::ProcessDefinition const& each, Place const& place);
  void statement(ast::Observation const& each, Place const& place);
  void statement(ast::Part const& each, Place const& place);
  void statement(ast::Equation const& each, Place const& place);
  void statement(ast::DictionaryStates const& each, Place const& place);
  void statement(ast::DictionaryParameter const& each, Place const& place);
  void statement(ast::DictionaryList const& each, Place const& place);
  void statement(ast::CoefficientUnits const& each, Place const& place);

  struct OpenName {
    std::string text;
    Span span;
    int primes;
  };
  TableBuilder& table_;
  std::map<std::string, int> words_;  // by kind, owner and name
  std::map<ast::FunctionDefinition const*, std::vector<OpenName>> open_;
  std::map<ast::FunctionDefinition const*, std::vector<ast::FunctionDefinition const*>> calls_of_functions_;
  std::map<NameScope const*, std::vector<ast::FunctionDefinition const*>> calls_of_scopes_;
};

}  // namespace sysid::assist
