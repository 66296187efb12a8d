// What a message is about, for constructors of messages: the words for its sentence, and apart from them the names for the rules.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace sysid::errors {

using Names = std::vector<std::string>;

struct Subject {
  std::string words;  // "the value of `width`", "an index"
  Names names = {};   // "width": given, never read from the words
};

/// "`width`".
Subject named(std::string const& name);
/// "the value of `width`"; before: "the value of".
Subject named(std::string_view before, std::string const& name);

/// Of what an option or a setting was written, in a task of which verb, and which verbs have such an option.
struct OptionOwner {
  std::string name, verb;
  Names verbs;
};

}  // namespace sysid::errors
