// What became of a term of a discovery: the words of results, written and read.
#include <doctest/doctest.h>

#include "example.hpp"
#include "report/file/report_cbor.hpp"
#include "result/discovery.hpp"

using namespace sysid;

TEST_CASE("the words for the fate of a term are those of results, and are read again") {
  using Kind = TermFate::Kind;
  CHECK(word({Kind::known}) == "known");
  CHECK(word({Kind::kept}) == "kept");
  CHECK(word({Kind::dropped}) == "dropped");
  CHECK(word({Kind::dropped, 12}) == "dropped in round 12");
  CHECK(word({Kind::left_out}) == "left out");
  for (TermFate const fate : {TermFate{Kind::known}, {Kind::kept}, {Kind::dropped}, {Kind::dropped, 12}, {Kind::left_out}})
    CHECK(term_fate(word(fate)) == fate);
  for (char const* none : {"", "Kept", "dropped in round ", "dropped in round 0", "dropped in round 2x", "left  out"})
    CHECK_FALSE(term_fate(none).has_value());
}

TEST_CASE("the record of a result keeps the fate of its terms, and the headline alone of an older record's verdict") {
  Report report = example::duffing(10);
  report.verdict = "use with care: 1 warning\n  warning[second_mode]: a second mode";
  report.discovery.emplace();
  report.discovery->equations.resize(1);
  report.discovery->equations[0].terms.resize(2);
  report.discovery->equations[0].terms[0].fate = {TermFate::Kind::dropped, 3};
  report.discovery->equations[0].terms[1].fate = {TermFate::Kind::left_out};
  Report const read = read_record(record_bytes(report), "report.cbor");
  CHECK(read.discovery->equations[0].terms[0].fate == TermFate{TermFate::Kind::dropped, 3});
  CHECK(read.discovery->equations[0].terms[1].fate == TermFate{TermFate::Kind::left_out});
  CHECK(read.verdict == "use with care: 1 warning");
}
