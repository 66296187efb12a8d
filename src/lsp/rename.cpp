// A new name everywhere, or why not.
#include "assist/rename.hpp"

#include "lsp/features.hpp"

namespace sysid::lsp {

Json prepare_rename(Documents& documents, Json const& params) {
  Document& document = document_of(documents, params);
  ReadPlace const place = place_of(documents, params);
  if (!place.reading || document.reading != place.reading) throw RequestError(request_failed, "the text cannot be read");
  auto const what = assist::can_rename(*place.reading, place.offset);
  if (what.name.empty() && what.refusal.empty()) return nullptr;
  if (!what.refusal.empty()) throw RequestError(request_failed, what.refusal);
  return {{"range", range(Lines(document.text), what.span)}, {"placeholder", what.name}};
}

Json rename(Documents& documents, Json const& params) {
  Document& document = document_of(documents, params);
  std::string const name = params.at("newName").get<std::string>();
  auto const result = assist::rename(document.path, document.text,
                                     Lines(document.text).offset(position_from(params.at("position"))), name, documents.unsaved());
  if (!result.refusal.empty()) throw RequestError(request_failed, result.refusal);
  Json changes = Json::object();
  for (auto const& [path, places] : result.places) {
    std::optional<std::string> const open = path == document.path ? std::optional(document.text) : documents.unsaved()(path);
    std::string const text = open ? *open : assist::text_of_file(path);
    Lines const lines(text);
    Json edits = Json::array();
    for (Span const span : places) edits.push_back({{"range", range(lines, span)}, {"newText", name}});
    changes[path == document.path ? document.uri : uri_of(path)] = std::move(edits);
  }
  return {{"changes", std::move(changes)}};
}

}  // namespace sysid::lsp
