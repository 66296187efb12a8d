// expat does the parsing.
#include "xml_page.hpp"

#include <expat.h>

#include <memory>

namespace sysid::test {

namespace {

struct Reading {
  XmlPage page;
  std::vector<int> open;
};

}  // namespace

std::vector<Element const*> XmlPage::named(std::string const& name) const {
  std::vector<Element const*> out;
  for (Element const& each : elements)
    if (each.name == name) out.push_back(&each);
  return out;
}

XmlPage parse_xml(std::string const& page) {
  std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> const parser(XML_ParserCreate("UTF-8"), &XML_ParserFree);
  Reading reading;
  XML_SetUserData(parser.get(), &reading);
  XML_SetElementHandler(
      parser.get(),
      [](void* data, char const* name, char const** attributes) {
        auto& [into, open] = *static_cast<Reading*>(data);
        into.elements.push_back({name, {}, {}, open.empty() ? -1 : open.back()});
        for (; *attributes != nullptr; attributes += 2) into.elements.back().attributes[attributes[0]] = attributes[1];
        open.push_back(static_cast<int>(into.elements.size()) - 1);
      },
      [](void* data, char const*) { static_cast<Reading*>(data)->open.pop_back(); });
  XML_SetCharacterDataHandler(parser.get(), [](void* data, char const* text, int length) {
    auto& [into, open] = *static_cast<Reading*>(data);
    for (int const at : open) into.elements[static_cast<std::size_t>(at)].text.append(text, static_cast<std::size_t>(length));
  });
  if (XML_Parse(parser.get(), page.data(), static_cast<int>(page.size()), 1) == XML_STATUS_ERROR)
    reading.page.fault =
        "line " + std::to_string(XML_GetCurrentLineNumber(parser.get())) + ": " + XML_ErrorString(XML_GetErrorCode(parser.get()));
  return std::move(reading.page);
}

}  // namespace sysid::test
