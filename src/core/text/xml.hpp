// Text inside XML and HTML.
#pragma once
#include <string>
#include <string_view>

namespace sysid {

/// `<`, `>`, `&` and `"` as entities: for text between tags and for values of attributes in double quotes.
std::string escape(std::string_view text);

}  // namespace sysid
