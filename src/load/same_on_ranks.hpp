// Ranks must have the same text and the same data; this is checked before the first task.
#pragma once
#include <map>
#include <string>

#include "check/checked/checked.hpp"
#include "core/text/source.hpp"

namespace sysid {

/// UserError, the same on all ranks, where one has another text of the file or of a module. Nothing where there is one rank.
void require_same_text(Source const& source);

/// Likewise of files of data: the digest of each, by index of the data block.
void require_same_data(CheckedFile const& file, std::map<int, std::string> const& digests);

}  // namespace sysid
