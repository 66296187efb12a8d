// A model in the user's text, beside the flat one that is checked and run.
#pragma once
#include <functional>
#include <string>

#include "app/session/session.hpp"

namespace sysid {

/// As the user wrote it; null when it stands in a module. tree: of the user's file, not flat.
ast::Model const* as_written(ast::File const& tree, Span span);

/// Whether the text of the model reads a parameter, in a term that arguments may have taken out. Of a parameter of a part, and of a
/// model of a module, the text is not at hand, and the answer is yes. Null: the model has no arguments.
std::function<bool(std::string const& parameter)> switched_off_by_arguments(Session const& session, std::string const& model);

}  // namespace sysid
