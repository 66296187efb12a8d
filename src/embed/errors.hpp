// What the engine throws as one kind of error with its text, for programs that have the engine in them: one place, as
// src/cli/messages.cpp is for the command line.
#pragma once
#include <exception>
#include <string>
#include <utility>

#include "core/text/diagnostic.hpp"
#include "core/text/source.hpp"

namespace sysid::embed {

/// The messages as the command line prints them, and as JSON, one object a line.
class Raised : public std::exception {
 public:
  Raised(Diagnostics const& diagnostics, Source const& source);
  char const* what() const noexcept override { return text_.c_str(); }
  std::string const& json() const { return json_; }

 private:
  std::string text_, json_;
};

/// Inside a handler: throws what it caught as Raised, or again where it is Interrupted or std::bad_alloc.
[[noreturn]] void raise_caught(Source const& source);

/// What `work` returns; what it throws is raised, with places in `source`.
template <class Work>
auto guarded(Source const& source, Work&& work) {
  try {
    return std::forward<Work>(work)();
  } catch (...) {
    raise_caught(source);
  }
}

}  // namespace sysid::embed
