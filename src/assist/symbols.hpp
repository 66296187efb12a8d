// Which name of a text stands where and what it means: what hover, definitions, references and renaming read.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/text/source.hpp"
#include "syntax/ast.hpp"

namespace sysid::assist {

enum class SymbolKind {
  module,
  model,
  model_argument,
  part,
  time,
  input,
  state,
  disturbance,
  parameter,
  constant,
  local,
  derived,
  function,
  process,
  function_argument,
  channel,
  data,
  data_part,
  candidates,
  dictionary,
  task,
  column,  // of a data file, by the name it has there
  file,    // a text that names one
  word,    // of the language: a function, distribution, kernel, back end, setting or option
};

/// "model", "parameter", "local definition".
std::string_view kind_name(SymbolKind kind);

struct Symbol {
  SymbolKind kind = SymbolKind::local;
  std::string name;
  std::optional<Span> declaration;  // of the name; absent: a word of the language, or something outside of the texts
  Span statement;                   // what declares it, where it has a declaration
  int owner = -1;                   // the model, dictionary, data block or function in which it is declared; -1: none
  std::optional<ast::UnitExpression> unit;
  int refers = -1;                   // of a part: its model
  bool named_after_another = false;  // a task without a name of its own: `fit duffing ...` is fit_duffing
  std::string signature, summary;    // of a word
};

/// One name in a text. Of `spring.k` and `q[2]` each name is one; primes and indices are none of it.
struct Occurrence {
  Span span;
  int symbol = 0;
  bool declares = false;
  int primes = 0;
};

/// Where the names of a block are known: the braces of a model, dictionary, data block or set of candidates with what stands
/// before.
struct Block {
  Span span;
  int symbol = 0;
};

struct SymbolTable {
  std::vector<Symbol> symbols;
  std::vector<Occurrence> occurrences;  // by place, none overlap
  /// By symbol: the smallest index of those that must have one name. A channel of a model and the same channel of another that is
  /// fitted to the same data are two symbols under one name.
  std::vector<int> group;
  std::vector<Block> blocks;

  /// The name that `offset` touches, the one behind it first.
  Occurrence const* at(std::uint32_t offset) const;
  /// All names of the symbol's group, by place.
  std::vector<Occurrence> all_of(int symbol) const;
  /// The block around an offset, or nullptr.
  Block const* block_at(std::uint32_t offset) const;
};

}  // namespace sysid::assist
