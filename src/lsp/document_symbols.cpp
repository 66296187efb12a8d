// The outline of a file: blocks with what they declare, functions and tasks.
#include "lsp/features.hpp"

namespace sysid::lsp {
namespace {

using assist::Symbol;
using assist::SymbolKind;

/// SymbolKind of the protocol; 0: no part of an outline.
int kind_of(SymbolKind kind) {
  switch (kind) {
    case SymbolKind::model:
    case SymbolKind::dictionary:
      return 5;  // class
    case SymbolKind::data:
      return 19;  // object
    case SymbolKind::candidates:
      return 10;  // enum
    case SymbolKind::task:
      return 24;  // event
    case SymbolKind::function:
    case SymbolKind::process:
      return 12;
    case SymbolKind::part:
      return 8;  // field
    case SymbolKind::channel:
    case SymbolKind::derived:
    case SymbolKind::data_part:
      return 7;  // property
    case SymbolKind::constant:
    case SymbolKind::model_argument:
      return 14;
    case SymbolKind::time:
    case SymbolKind::input:
    case SymbolKind::state:
    case SymbolKind::disturbance:
    case SymbolKind::parameter:
    case SymbolKind::local:
      return 13;  // variable
    default:
      return 0;
  }
}

Json outline(assist::Reading const& reading, Lines const& lines, int owner) {
  Json all = Json::array();
  for (std::size_t i = 0; i < reading.names.symbols.size(); ++i) {
    Symbol const& symbol = reading.names.symbols[i];
    if (symbol.owner != owner || !symbol.declaration || kind_of(symbol.kind) == 0) continue;
    if (reading.source.place(symbol.declaration->begin).file > 0) continue;
    Span const whole = cover(symbol.statement, *symbol.declaration);
    std::string detail(kind_name(symbol.kind));
    if (symbol.unit) detail += " [" + std::string(reading.source.text(symbol.unit->span)) + "]";
    Json one = {{"name", symbol.name},
                {"detail", detail},
                {"kind", kind_of(symbol.kind)},
                {"range", range(lines, whole)},
                {"selectionRange", range(lines, *symbol.declaration)}};
    if (Json inner = outline(reading, lines, static_cast<int>(i)); !inner.empty()) one["children"] = std::move(inner);
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace

Json document_symbols(Documents& documents, Json const& params) {
  Document& document = document_of(documents, params);
  assist::Reading const* reading = documents.reading(document);
  if (reading == nullptr) return nullptr;
  return outline(*reading, Lines(document.text), -1);
}

}  // namespace sysid::lsp
