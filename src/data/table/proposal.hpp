// Rules that would read a file, for messages and for who looks at it first. What may be read in two ways is asked about.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "data/table/column_needs.hpp"
#include "data/table/layout.hpp"
#include "data/table/reading_rules.hpp"

namespace sysid {

/// Rules that read all columns of numbers of a text; where it may be read in two ways, both.
struct Proposal {
  std::vector<ReadingRules> rules;  // one, or several to choose from
  std::string question;             // what differs between them: "`1.234` may be 1.234 or 1234"
  std::string time;                 // the column with the time, where the one that was named is not it
  Layout layout;
};
/// current: what the block says already. Nothing where no rules help.
std::optional<Proposal> propose(std::string const& utf8, ReadingRules const& current, ColumnNeeds const& needs = {});

struct ProposalRequest {
  std::string const& bytes;  // UTF-8
  ReadingRules const& rules;
  ColumnNeeds const& needs;
  std::string column;  // that could not be read
  std::string code;    // of the message
};
/// "add this line to the data block: `read decimal = ","`"; empty where other rules do not help.
std::string proposed_help(ProposalRequest const& request);

/// Filled lines below this one; none where it is 0, the end of the file.
int lines_below(std::string const& utf8, int last);

/// The line in the middle of a table that is none of its rows, for which nothing is proposed; 0: there is none.
int broken_line(std::string const& utf8);

/// The encoding in which bytes that are no UTF-8 would be read as a record.
std::optional<std::string> proposed_encoding(std::string const& bytes, ReadingRules const& rules, ColumnNeeds const& needs);

/// Names that are there twice or empty get others.
std::vector<std::string> distinct_names(std::vector<std::string> const& names);

}  // namespace sysid
