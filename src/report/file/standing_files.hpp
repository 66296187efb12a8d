// What stands in a task's folder: which of its files are of a result, that nothing is overwritten unasked, and what is removed.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/text/diagnostic.hpp"

namespace sysid {

/// The table of `track`, which may grow while rows arrive, and is then a result as soon as it is there.
inline constexpr char const* tracked_rows = "track.csv";

/// Whether files of that name in a folder's figures/ are taken for those of a result.
bool is_figure_file(std::string const& name);

/// The names of those that go with a result, exported ones and those in its figures/ included: "draws_1.csv", "figures/pairs.svg".
/// Without the table of `track`, and without folders, which are the user's whatever their names.
std::vector<std::string> files_of_result(std::filesystem::path const& folder);

/// Whether the table of `track` is there.
bool holds_track(std::filesystem::path const& folder);

/// True when the folder holds files of a result of before, whole or not. A checkpoint is none.
bool holds_result(std::filesystem::path const& folder);

/// UserError when it holds some.
void require_no_result(std::filesystem::path const& folder);

/// Of a folder that holds some, but no summary: rows of a track that was killed, or what is left where files were removed.
UserError no_complete_result(std::filesystem::path const& folder, Help help);

/// Removes the files of a result (draws of more chains than a new run has would otherwise stay), with the pictures, texts and
/// scripts that lie in its figures/. but: a file that stays, whatever its name.
void remove_result(std::filesystem::path const& folder, std::filesystem::path const& but = {});

/// Removes what a killed run left half written, of the files that a run writes into its folder; those of other names stay. To be
/// called by whoever holds the folder's lock, after `complete_replacement`.
void remove_partial(std::filesystem::path const& folder);

}  // namespace sysid
