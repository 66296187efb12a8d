// Formulas are src/typeset's.
#include "report/page/typeset.hpp"

#include <fmt/format.h>

#include "core/text/xml.hpp"
#include "typeset/typeset.hpp"

namespace sysid {

std::vector<std::string> typeset(std::vector<std::string> const& statements) {
  std::vector<std::string> out;
  std::vector<ast::ModelStatement> trees;
  std::vector<std::size_t> places;
  for (std::string const& statement : statements) {
    if (auto tree = model_statement(statement)) {
      trees.push_back(std::move(*tree));
      places.push_back(out.size());
    }
    out.push_back(fmt::format("<code>{}</code>", escape(statement)));
  }
  std::vector<std::optional<std::string>> const formulas = mathml(trees);
  for (std::size_t i = 0; i < formulas.size(); ++i)
    if (formulas[i]) out[places[i]] = *formulas[i];
  return out;
}

}  // namespace sysid
