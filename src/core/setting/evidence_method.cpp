// The words of the methods, in the order of the enumeration.
#include "core/setting/evidence_method.hpp"

#include <array>
#include <cstddef>

namespace sysid {
namespace {

struct Row {
  std::string_view word, title;
};

constexpr std::array<Row, 6> rows = {{{"auto", "automatic"},
                                      {"importance", "importance sampling"},
                                      {"bridge", "bridge sampling"},
                                      {"smc", "tempered SMC"},
                                      {"laplace", "Laplace"},
                                      {"none", "none"}}};

}  // namespace

std::string_view word(EvidenceMethod method) { return rows.at(static_cast<std::size_t>(method)).word; }

std::string_view title(EvidenceMethod method) { return rows.at(static_cast<std::size_t>(method)).title; }

std::optional<EvidenceMethod> evidence_method(std::string_view word) {
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (rows[k].word == word) return static_cast<EvidenceMethod>(k);
  return std::nullopt;
}

std::vector<std::string> evidence_words() {
  std::vector<std::string> words;
  for (Row const& row : rows) words.emplace_back(row.word);
  return words;
}

}  // namespace sysid
