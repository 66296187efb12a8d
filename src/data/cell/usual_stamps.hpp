// Patterns of dates and times that cells seem to have, for proposals.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

/// The usual patterns that fit all of these cells; where day, month and year may stand in several orders, or `00:01` may be minutes
/// or seconds, all of them: those first under which the cells follow each other without gaps. name: of the column, which may say
/// what two numbers are: `Zeit (min:sec)`.
std::vector<std::string> patterns_of(std::vector<std::string> const& cells, std::string_view name = {});

/// What differs between several of them: "`24.05.01` may have the day or the year first".
std::string question_of(std::vector<std::string> const& patterns, std::vector<std::string> const& cells);

}  // namespace sysid
