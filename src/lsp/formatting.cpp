// Canonical layout, as `sysid fmt` writes it.
#include "lsp/features.hpp"
#include "syntax/format.hpp"

namespace sysid::lsp {

Json formatting(Documents& documents, Json const& params) {
  Document const& document = document_of(documents, params);
  Diagnostics unsaid;
  auto const text = formatted(Source(document.path, document.text), unsaid);
  if (!text) return nullptr;
  std::string const& old = document.text;
  if (*text == old) return Json::array();
  // The lines that stay, before and behind, are left alone, and with them the cursor.
  std::size_t before = 0, line = 0;
  while (before < old.size() && before < text->size() && old[before] == (*text)[before])
    if (old[before++] == '\n') line = before;
  before = line;
  std::size_t behind = 0, whole_lines = 0;
  while (behind < old.size() - before && behind < text->size() - before &&
         old[old.size() - 1 - behind] == (*text)[text->size() - 1 - behind]) {
    if (old[old.size() - 1 - behind] == '\n') whole_lines = behind;
    ++behind;
  }
  Span const changed{static_cast<std::uint32_t>(before), static_cast<std::uint32_t>(old.size() - whole_lines)};
  return Json::array(
      {{{"range", range(Lines(old), changed)}, {"newText", text->substr(before, text->size() - whole_lines - before)}}});
}

}  // namespace sysid::lsp
