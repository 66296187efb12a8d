// What the models, dictionaries and data blocks of all files declare, read before their uses.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "assist/symbols.hpp"
#include "check/elaborate/environment.hpp"

namespace sysid::assist {

/// The names of one model or dictionary; quantities, functions and channels live in separate spaces.
struct NameScope {
  int symbol = -1;
  Environment const* home = nullptr;
  std::map<std::string, int> quantities, functions, channels;
  std::map<std::string, ast::Model const*> parts;  // by the name of the part; nullptr: of an unknown model
};

struct DataScope {
  int symbol = -1;
  std::map<std::string, int> parts;
};

/// A table in the making.
class TableBuilder {
 public:
  /// A name that is declared at `name`; the first of a scope counts, all are listed.
  int declare(SymbolKind kind, ast::Name const& name, Span statement, int owner, std::optional<ast::UnitExpression> unit = {});
  /// A symbol without a place of its own.
  int add(Symbol symbol);
  void mention(Span span, int symbol, int primes = 0, bool declares = false);
  /// Both have one name.
  void unite(int a, int b);
  Symbol& operator[](int symbol) { return table_.symbols[static_cast<std::size_t>(symbol)]; }
  void block(Span span, int symbol) { table_.blocks.push_back({span, symbol}); }
  SymbolTable take();

 private:
  int root(int symbol);
  SymbolTable table_;
  std::vector<int> parent_;
};

NameScope declared(ast::Model const& model, int symbol, Environment const& home, TableBuilder& table);
NameScope declared(ast::Dictionary const& dictionary, int symbol, Environment const& home, TableBuilder& table);
DataScope declared(ast::Data const& data, int symbol, TableBuilder& table);

}  // namespace sysid::assist
