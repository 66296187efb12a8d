// What the name under the pointer is.
#include "assist/hover.hpp"

#include "lsp/features.hpp"

namespace sysid::lsp {

Json hover(Documents& documents, Json const& params) {
  ReadPlace const place = place_of(documents, params);
  if (!place.reading) return nullptr;
  auto const found = assist::hover(*place.reading, place.offset);
  if (!found) return nullptr;
  Json result = {{"contents", {{"kind", "markdown"}, {"value", found->markdown}}}};
  Document& document = document_of(documents, params);
  if (document.reading == place.reading) result["range"] = range(Lines(document.text), found->span);
  return result;
}

}  // namespace sysid::lsp
