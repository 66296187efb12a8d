// A page as a parser of XML sees it: elements with attributes, in order; a page that is not well-formed is refused with its place.
#pragma once
#include <map>
#include <string>
#include <vector>

namespace sysid::test {

struct Element {
  std::string name;
  std::map<std::string, std::string> attributes;
  std::string text;  // directly inside and within its children
  int parent = -1;   // index in the page
};

struct XmlPage {
  std::vector<Element> elements;  // in the order of their beginnings
  std::string fault;              // "line 12: mismatched tag"; empty: well-formed

  std::vector<Element const*> named(std::string const& name) const;
};

XmlPage parse_xml(std::string const& page);

}  // namespace sysid::test
