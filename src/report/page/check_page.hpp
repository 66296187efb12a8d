// The page of `sysid check`: text for a person, JSON for a program.
#pragma once
#include <string>

#include "result/check_page.hpp"

namespace sysid {

std::string dictionary_text(DictionaryPage const& page);
std::string check_text(CheckPage const& page);
/// messages: of `render_json`, one object per line; they become a part of the page.
std::string check_json(CheckPage const& page, std::string const& messages);

}  // namespace sysid
