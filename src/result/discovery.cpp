// The words for what became of a term, for results and their readers.
#include "result/discovery.hpp"

#include <fmt/format.h>

#include <charconv>

namespace sysid {
namespace {

constexpr std::string_view in_round = "dropped in round ";

}  // namespace

std::string word(TermFate fate) {
  switch (fate.kind) {
    case TermFate::Kind::known:
      return "known";
    case TermFate::Kind::kept:
      return "kept";
    case TermFate::Kind::left_out:
      return "left out";
    case TermFate::Kind::dropped:
      break;
  }
  return fate.round > 0 ? fmt::format("{}{}", in_round, fate.round) : "dropped";
}

std::optional<TermFate> term_fate(std::string_view stored) {
  for (TermFate::Kind const kind : {TermFate::Kind::known, TermFate::Kind::kept, TermFate::Kind::dropped, TermFate::Kind::left_out})
    if (stored == word(TermFate{kind})) return TermFate{kind};
  if (!stored.starts_with(in_round)) return std::nullopt;
  stored.remove_prefix(in_round.size());
  TermFate fate{TermFate::Kind::dropped};
  auto const [end, error] = std::from_chars(stored.data(), stored.data() + stored.size(), fate.round);
  if (error != std::errc() || end != stored.data() + stored.size() || fate.round < 1) return std::nullopt;
  return fate;
}

}  // namespace sysid
