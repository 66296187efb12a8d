// From a name to its declarations and to all of its uses.
#include <filesystem>

#include "lsp/features.hpp"

namespace sysid::lsp {
namespace {

using assist::Occurrence;
using assist::Symbol;
using assist::SymbolKind;

/// The modules of the standard library are inside the program, not in files.
bool in_a_file(assist::Reading const& reading, std::uint32_t offset) {
  int const file = reading.source.place(offset).file;
  return file == 0 || std::filesystem::exists(reading.source.name(file));
}

Json beginning_of(std::filesystem::path const& file) {
  if (!std::filesystem::exists(file)) return nullptr;
  return {{"uri", uri_of(file.string())}, {"range", range(Lines(""), {0, 0})}};
}

/// The file of a data block, by the text that names it.
std::string file_of(assist::Reading const& reading, int data) {
  for (Symbol const& symbol : reading.names.symbols)
    if (symbol.kind == SymbolKind::file && symbol.owner == data) return symbol.name;
  return {};
}

}  // namespace

Json definition(Documents& documents, Json const& params) {
  ReadPlace const place = place_of(documents, params);
  if (!place.reading) return nullptr;
  assist::SymbolTable const& names = place.reading->names;
  Occurrence const* found = names.at(place.offset);
  if (found == nullptr) return nullptr;
  Symbol const& symbol = names.symbols[static_cast<std::size_t>(found->symbol)];
  std::filesystem::path const folder = std::filesystem::path(document_of(documents, params).path).parent_path();
  if (symbol.kind == SymbolKind::module) return beginning_of(folder / (symbol.name + ".sysid"));
  if (symbol.kind == SymbolKind::file) return beginning_of(folder / symbol.name);
  if (symbol.kind == SymbolKind::column) {
    std::string const file = file_of(*place.reading, symbol.owner);
    return file.empty() ? Json(nullptr) : beginning_of(folder / file);
  }
  Json all = Json::array();
  for (Occurrence const& each : names.all_of(found->symbol))
    if (each.declares && in_a_file(*place.reading, each.span.begin)) all.push_back(location(place.reading->source, each.span));
  if (all.empty() && symbol.declaration && in_a_file(*place.reading, symbol.declaration->begin))
    all.push_back(location(place.reading->source, *symbol.declaration));
  return all.empty() ? Json(nullptr) : all;
}

Json references(Documents& documents, Json const& params) {
  ReadPlace const place = place_of(documents, params);
  Occurrence const* found = place.reading ? place.reading->names.at(place.offset) : nullptr;
  if (found == nullptr) return nullptr;
  bool const with_declarations = params.at("context").at("includeDeclaration").get<bool>();
  Json all = Json::array();
  for (Occurrence const& each : place.reading->names.all_of(found->symbol))
    if ((with_declarations || !each.declares) && in_a_file(*place.reading, each.span.begin))
      all.push_back(location(place.reading->source, each.span));
  return all;
}

Json document_highlight(Documents& documents, Json const& params) {
  ReadPlace const place = place_of(documents, params);
  Document& document = document_of(documents, params);
  // Of a text that cannot be read the places are not known.
  if (!place.reading || document.reading != place.reading) return nullptr;
  Occurrence const* found = place.reading->names.at(place.offset);
  if (found == nullptr) return nullptr;
  Lines const lines(document.text);
  Json all = Json::array();
  for (Occurrence const& each : place.reading->names.all_of(found->symbol))
    if (place.reading->source.place(each.span.begin).file == 0)
      all.push_back({{"range", range(lines, each.span)}, {"kind", each.declares ? 3 : 2}});
  return all;
}

}  // namespace sysid::lsp
