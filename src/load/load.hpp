// A file of the language from its text to the checked file.
#pragma once
#include <functional>
#include <optional>
#include <string>

#include "check/check.hpp"
#include "core/text/diagnostic.hpp"
#include "load/modules.hpp"

namespace sysid {

/// A file that passed the front end: its text, the checked models, data blocks and tasks.
struct Loaded {
  Source source;
  CheckedFile file;
};

/// The data blocks that need no `file` line, since who loads has their data; the `path` of one without it is empty.
using DataAtHand = std::function<bool(std::string const& block)>;

/// Parses, puts modules and parts in, checks. Nothing when there are errors in `diagnostics`, which refer to `source`; the texts of
/// modules join it. IoError when a module cannot be read.
std::optional<CheckedFile> load(Source& source, Diagnostics& diagnostics, UnsavedText const& unsaved = {},
                                DataAtHand const& at_hand = {});

}  // namespace sysid
