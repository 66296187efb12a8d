// Rules of HTML and of WCAG 2.2 that a program can check.
#include "page_rules.hpp"

#include <set>

#include "xml_page.hpp"

namespace sysid::test {

std::string broken_rules(std::string const& text) {
  std::string broken;
  auto const rule = [&](bool kept, std::string const& words) {
    if (!kept) broken += words + "\n";
  };
  XmlPage const page = parse_xml(text);
  if (!page.fault.empty()) return "not well-formed: " + page.fault + "\n";

  // Nothing leaves the page.
  for (char const* word : {"@import", "url(", "<script", "<link", "<iframe", "<img", "<object", "<embed"})
    rule(text.find(word) == std::string::npos, std::string("the page holds ") + word);
  std::set<std::string> ids, targets;
  for (Element const& element : page.elements) {
    for (auto const& [name, value] : element.attributes) {
      if (name == "id") rule(ids.insert(value).second, "the id " + value + " stands twice");
      if (name == "href" || name == "xlink:href") {
        rule(value.starts_with('#'), "a reference to " + value);
        targets.insert(value.substr(1));
      }
      rule(name != "src" && name != "srcset" && name != "data" && name != "action" && !name.starts_with("on"),
           element.name + " has " + name);
      if (name == "aria-labelledby" || name == "aria-describedby") targets.insert(value);
    }
    rule(element.name != "svg" || (element.attributes.contains("role") && element.attributes.contains("aria-label") &&
                                   !element.attributes.at("aria-label").empty()),
         "a picture without a text");
  }
  for (std::string const& target : targets) rule(ids.contains(target), "nothing has the id " + target);

  // Landmarks, a title, one first heading and none left out.
  for (char const* name : {"title", "header", "nav", "main", "footer", "h1"})
    rule(page.named(name).size() == 1, std::string(name) + " does not stand once");
  int level = 0;
  for (Element const& element : page.elements) {
    if (element.name.size() != 2 || element.name[0] != 'h' || element.name[1] < '1' || element.name[1] > '6') continue;
    int const next = element.name[1] - '0';
    rule(next <= level + 1,
         "heading " + element.text + " of level " + std::to_string(next) + " below one of " + std::to_string(level));
    rule(!element.text.empty(), "a heading without a text");
    level = next;
  }

  // Tables say what they are, and which cells head which.
  std::size_t captions = 0;
  for (Element const* caption : page.named("caption")) captions += caption->text.empty() ? 0 : 1;
  rule(captions == page.named("table").size(), "a table without a caption");
  for (Element const* cell : page.named("th")) {
    rule(cell->attributes.contains("scope"), "a header cell without scope: " + cell->text);
    rule(!cell->text.empty(), "a header cell without a text");
  }
  for (Element const* figure : page.named("figure")) rule(!figure->text.empty(), "a figure without a caption");
  return broken;
}

}  // namespace sysid::test
