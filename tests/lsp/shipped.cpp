// The shipped models in an editor: every name renamed, mistakes planted, all by the server's own messages.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <map>
#include <random>
#include <set>

#include "assist/analysis.hpp"
#include "assist/rename.hpp"
#include "client.hpp"
#include "grammar/message/layout.hpp"
#include "load/load.hpp"
#include "replications.hpp"
#include "syntax/format.hpp"
#include "syntax/words.hpp"

using namespace sysid;
using namespace sysid::test;
using assist::SymbolKind;

namespace {

bool touch(Span a, Span b) { return a.begin <= b.end && b.begin <= a.end; }

bool renameable(SymbolKind kind) {
  return kind != SymbolKind::word && kind != SymbolKind::column && kind != SymbolKind::file && kind != SymbolKind::module;
}

std::string formatted_text(std::string const& text) {
  Diagnostics diagnostics;
  auto const result = formatted(Source("", text), diagnostics);
  REQUIRE(result);
  return *result;
}

}  // namespace

TEST_CASE(
    "each name of each shipped model can be renamed everywhere: the check still passes, the layout is stable, and back again") {
  int renamed = 0, library = 0, met = 0;
  for (std::filesystem::path const& path : shipped_models()) {
    std::string const text = content(path);
    auto const reading = assist::read(path.string(), text);
    REQUIRE(reading);
    CHECK(reading->complete);
    std::set<int> done;
    for (assist::Occurrence const& each : reading->names.occurrences) {
      if (reading->source.place(each.span.begin).file > 0) break;
      int const group = reading->names.group[static_cast<std::size_t>(each.symbol)];
      if (!renameable(reading->names.symbols[static_cast<std::size_t>(each.symbol)].kind) || !done.insert(group).second) continue;
      // Of each kind of name there are dozens: a kind that is not renamed everywhere is found by a third of them.
      if (++met % 3 != 0 && !full_size()) continue;
      CAPTURE(path.string());
      CAPTURE(reading->source.text(each.span));
      auto const result = assist::rename(path.string(), text, each.span.begin, "zz_renamed");
      if (result.refusal.find("standard library") != std::string::npos) {
        ++library;
        continue;
      }
      CHECK(result.refusal == "");
      REQUIRE(result.places.contains(path.string()));
      CHECK(result.places.size() == 1);
      std::string const changed = assist::renamed(text, result.places.at(path.string()), "zz_renamed");
      Source source(path.string(), changed);
      Diagnostics diagnostics;
      CHECK(load(source, diagnostics));
      CHECK_FALSE(diagnostics.has_errors());
      std::string const once = formatted_text(changed);
      CHECK(formatted_text(once) == once);
      // Every place is found again from the new text: what was renamed is one name there, too.
      auto const back = assist::rename(path.string(), changed, result.places.at(path.string()).front().begin,
                                       std::string(reading->source.text(each.span)));
      CHECK(back.refusal == "");
      CHECK(assist::renamed(changed, back.places.at(path.string()), std::string(reading->source.text(each.span))) == text);
      ++renamed;
    }
  }
  MESSAGE(renamed << " names renamed, " << library << " of the standard library refused");
  CHECK(renamed > (full_size() ? 300 : 100));
}

TEST_CASE("mistakes planted in every shipped model appear at the right range, and go when they are taken back") {
  struct Tally {
    int planted = 0, covered = 0, exact = 0;
  };
  std::map<std::string, Tally> tallies;
  std::map<std::string, int> met;
  std::mt19937 random(20260);
  for (std::filesystem::path const& path : shipped_models()) {
    std::string const text = content(path);
    CAPTURE(path.string());
    auto const reading = assist::read(path.string(), text);
    Source const source("", text);
    Diagnostics none;
    auto const tokens = grammar::lay_out(source, none, 1).tokens;
    std::set<std::string> words;
    for (auto const& token : tokens) words.insert(std::string(token.text.substr(0, token.text.find('\''))));
    Client client;
    client.open(path.string(), text);
    for (Json const& each : client.diagnostics) CHECK(each.at("severity") != 1);
    Json const sound = client.diagnostics;

    // What is said of the sound text reads the data as well, and so takes most of the time: it is asked for after every tenth
    // mistake and the last. The mistakes between are taken back while the next one is typed.
    int in_text = 0;
    auto const taken_back = [&] {
      client.settle();
      CHECK(client.diagnostics == sound);
    };
    // place: where the message may stand, in the new text; exact: where it must stand to count as such.
    auto const plant = [&](std::string const& kind, Span span, std::string const& spelling, std::vector<Span> const& places,
                           Span exact) {
      if (++met[kind] % 3 != 0 && !full_size()) return;
      std::string changed = text;
      changed.replace(span.begin, span.end - span.begin, spelling);
      client.edit(text, span, spelling);
      Tally& tally = tallies[kind];
      ++tally.planted;
      bool covered = false, is_exact = false;
      for (Json const& each : client.diagnostics) {
        if (each.at("severity") != 1) continue;
        std::vector<Span> said = {span_of(changed, each.at("range"))};
        if (each.contains("relatedInformation"))
          for (Json const& related : each.at("relatedInformation"))
            said.push_back(span_of(changed, related.at("location").at("range")));
        is_exact = is_exact || said.front() == exact;
        for (Span const one : said)
          covered = covered || std::any_of(places.begin(), places.end(), [&](Span place) { return touch(one, place); });
      }
      tally.covered += covered ? 1 : 0;
      tally.exact += is_exact ? 1 : 0;
      if (!covered && std::getenv("SYSID_MUTANTS") != nullptr)
        fmt::print("{} {} `{}` -> `{}`\n{}\n", path.filename().string(), kind, text.substr(span.begin, span.end - span.begin),
                   spelling, client.diagnostics.dump(1));
      Span const inserted{span.begin, span.begin + static_cast<std::uint32_t>(spelling.size())};
      client.type(changed, inserted, text.substr(span.begin, span.end - span.begin));
      if (++in_text % 10 == 0) taken_back();
    };
    auto const statement_of = [&](std::uint32_t offset) {
      Span whole{offset, offset};
      for (std::size_t i = 0; i < tokens.size(); ++i)
        if (tokens[i].span.begin <= offset && offset < tokens[i].span.end)
          for (auto const& token : tokens)
            if (token.statement == tokens[i].statement) whole = cover(whole, token.span);
      return whole;
    };

    for (assist::Occurrence const& each : reading->names.occurrences) {
      if (reading->source.place(each.span.begin).file > 0) break;
      assist::Symbol const& symbol = reading->names.symbols[static_cast<std::size_t>(each.symbol)];
      std::string const name(reading->source.text(each.span));
      Span const here = each.span;
      if (symbol.kind == SymbolKind::word && text[here.end] == '(') {
        std::string const wrong = name + "q";
        plant("unknown function", here, wrong, {{here.begin, here.end + 1}}, {here.begin, here.end + 1});
      } else if (renameable(symbol.kind) && !each.declares && name.size() > 2) {
        std::size_t const letter = random() % (name.size() - 1);
        std::string const wrong = name.substr(0, letter + 1) + name.substr(letter + 2);
        if (words.contains(wrong)) continue;
        Span const there{here.begin, here.end - 1};
        plant("letter deleted", here, wrong, {there}, there);
      } else if (each.declares && symbol.unit && symbol.kind != SymbolKind::channel && symbol.owner >= 0) {
        // Where it is declared, or where it meets others.
        Span const unit = symbol.unit->span;
        std::string const wrong = "[mol^7]";
        Span const old{unit.begin - 1, unit.end + 1};
        REQUIRE(text[old.begin] == '[');
        auto const shift = static_cast<std::int64_t>(wrong.size()) - (old.end - old.begin);
        std::vector<Span> places = {{old.begin, old.begin + static_cast<std::uint32_t>(wrong.size())}};
        for (assist::Occurrence const& use : reading->names.all_of(each.symbol)) {
          if (reading->source.place(use.span.begin).file > 0) continue;
          Span at = statement_of(use.span.begin);
          if (at.begin >= old.end) at = {static_cast<std::uint32_t>(at.begin + shift), static_cast<std::uint32_t>(at.end + shift)};
          places.push_back(at);
        }
        plant("wrong unit", old, wrong, places, places.front());
      }
    }
    for (std::size_t i = 0; i < tokens.size(); ++i) {
      if (tokens[i].kind != grammar::TokenKind::symbol || std::string_view("(){}]").find(tokens[i].text) == std::string_view::npos)
        continue;
      Span const at = tokens[i].span;
      Span statement = statement_of(at.begin);
      // What a bracket without its partner is reported at: itself, or the partner, in the same block.
      if (tokens[i].is("{") || tokens[i].is("}"))
        for (assist::Block const& block : reading->names.blocks)
          if (touch(block.span, at)) statement = cover(statement, block.span);
      if (i + 1 < tokens.size()) statement.end = std::max(statement.end, tokens[i + 1].span.end);
      plant("bracket dropped", at, "", {statement}, {});
    }
    taken_back();
  }
  for (auto const& [kind, tally] : tallies) {
    MESSAGE(kind << ": " << tally.planted << " planted, " << tally.covered << " at the place, " << tally.exact << " exactly");
    CHECK(tally.planted > 50);
  }
  for (char const* kind : {"unknown function", "letter deleted", "bracket dropped"}) {
    CAPTURE(kind);
    CHECK(tallies[kind].covered == tallies[kind].planted);
  }
  // The rest is said of the words around it: `mh` in place of a selector, a path as a whole.
  for (char const* kind : {"unknown function", "letter deleted"}) {
    CAPTURE(kind);
    CHECK(tallies[kind].exact >= 0.95 * tallies[kind].planted);
  }
}
