// Digests are compared; of texts that differ, rank 0 has the other too, and shows the first line that is not the same.
#include "load/same_on_ranks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/ranks/ranks.hpp"
#include "core/system/digest.hpp"

namespace sysid {
namespace {

Diagnostic differing(std::string const& who, std::string const& what, std::string const& name) {
  return {Severity::error,
          "E6215",
          fmt::format("{} has {} than rank 0", who, what),
          std::nullopt,
          {},
          "all ranks must read the same files: keep them where all nodes see them, or copy them to each node again",
          {name}};
}

/// Of the leader's text; the whole file where only the other has more.
std::optional<Span> first_other_line(Source const& source, int file, std::string_view other) {
  std::string_view const own = source.text(file);
  auto const same = std::mismatch(own.begin(), own.end(), other.begin(), other.end()).first - own.begin();
  int const line = 1 + static_cast<int>(std::count(own.begin(), own.begin() + same, '\n'));
  std::string_view const words = source.line(line, file);
  if (words.empty()) return std::nullopt;
  std::uint32_t const begin = source.line_begin(line, file);
  return Span{begin, begin + static_cast<std::uint32_t>(words.size())};
}

}  // namespace

void require_same_text(Source const& source) {
  std::vector<ranks::Alike> files;
  for (int k = 0; k < source.files(); ++k) files.push_back({source.name(k), sha256(source.text(k))});
  auto const other = ranks::difference(files);
  if (!other) return;
  std::string const& name = other->leading.what.empty() ? other->other.what : other->leading.what;
  Diagnostic said = differing(other->who, fmt::format("another text of `{}`", name), name);
  int const file = static_cast<int>(other->place);
  std::vector<std::string> const texts = ranks::gather(file < source.files() ? source.text(file) : std::string_view());
  // The place is one of the leader's text: no other rank has it.
  if (ranks::leads() && file < source.files() && other->leading.what == other->other.what)
    if (auto const line = first_other_line(source, file, texts[static_cast<std::size_t>(other->rank)]))
      said.primary = Label{*line, "the first line that differs"};
  throw UserError(said);
}

void require_same_data(CheckedFile const& file, std::map<int, std::string> const& digests) {
  std::vector<ranks::Alike> records;
  std::vector<int> blocks;
  for (auto const& [block, digest] : digests) {
    records.push_back({file.data[static_cast<std::size_t>(block)].mention(), digest});
    blocks.push_back(block);
  }
  auto const other = ranks::difference(records);
  if (!other) return;
  std::string const& name = other->leading.what.empty() ? other->other.what : other->leading.what;
  Diagnostic said = differing(other->who, fmt::format("other data in `{}`", name), name);
  if (other->place < blocks.size()) said.primary = Label{file.data[static_cast<std::size_t>(blocks[other->place])].path_span, {}};
  throw UserError(said);
}

}  // namespace sysid
