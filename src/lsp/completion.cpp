// What may be written at the cursor.
#include "assist/completion.hpp"

#include "lsp/features.hpp"

namespace sysid::lsp {
namespace {

/// CompletionItemKind of the protocol.
int kind_of(assist::CompletionKind kind) {
  using assist::CompletionKind;
  switch (kind) {
    case CompletionKind::keyword:
      return 14;
    case CompletionKind::name:
      return 6;  // variable
    case CompletionKind::function:
    case CompletionKind::word:
      return 3;  // function
    case CompletionKind::setting:
      return 10;  // property
    case CompletionKind::choice:
      return 12;  // value
    case CompletionKind::column:
      return 5;  // field
    case CompletionKind::file:
      return 17;
    case CompletionKind::module:
      return 9;
    case CompletionKind::unit:
      return 11;
  }
  return 1;
}

}  // namespace

Json completion(Documents& documents, Json const& params) {
  Document& document = document_of(documents, params);
  Lines const lines(document.text);
  auto const found =
      assist::complete(document.path, document.text, lines.offset(position_from(params.at("position"))), documents.unsaved());
  Json const where = range(lines, found.replaces);
  Json items = Json::array();
  for (assist::Completion const& each : found.items) {
    Json item = {{"label", each.label}, {"kind", kind_of(each.kind)}, {"textEdit", {{"range", where}, {"newText", each.label}}}};
    if (!each.detail.empty()) item["detail"] = each.detail;
    if (!each.summary.empty()) item["documentation"] = each.summary;
    items.push_back(std::move(item));
  }
  return {{"isIncomplete", false}, {"items", std::move(items)}};
}

}  // namespace sysid::lsp
