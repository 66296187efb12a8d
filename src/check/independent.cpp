// An item with an unreadable part is damaged, and so is what is made of a damaged one. Names and units of what can be read hold in
// damaged models as elsewhere; what is missing there may stand in the unreadable part.
#include "check/independent.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <string>

namespace sysid {
namespace {

/// In a damaged model these ask for the equations as a whole, or for the kind of a name.
constexpr std::array<std::string_view, 3> of_the_whole{"E2007", "E2010", "E2113"};
/// Said of a data block by itself, whatever model it serves.
constexpr std::array<std::string_view, 7> of_a_block{"E4101", "E4103", "E4104", "E4106", "E4107", "E4108", "E4114"};

bool is_letter(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

std::set<std::string> words_in(std::string_view text) {
  std::set<std::string> words;
  for (std::size_t begin = 0; begin < text.size();) {
    std::size_t end = begin;
    while (end < text.size() && is_letter(text[end])) ++end;
    if (end > begin) words.emplace(text.substr(begin, end - begin));
    begin = std::max(end, begin + 1);
  }
  return words;
}

Span span_of(ast::Item const& item) {
  return std::visit([](auto const& each) { return each.span; }, item);
}

class Damage {
 public:
  Damage(ast::File const& tree, std::span<Span const> unread, Source const& source) : tree_(tree), items_(tree.items.size()) {
    for (Span const span : unread) {
      words_.merge(words_in(source.text(span)));
      bool inside = false;
      for (std::size_t i = 0; i < items_.size(); ++i) {
        Span const item = span_of(tree.items[i]);
        if (item.begin <= span.begin && span.begin < item.end) {
          items_[i] = true;
          inside = true;
        }
      }
      beside_items_ = beside_items_ || !inside;
    }
    names_ = words_;
    for (bool more = true; more;) {
      more = false;
      for (std::size_t i = 0; i < items_.size(); ++i) {
        if (!items_[i]) items_[i] = std::visit([&](auto const& each) { return made_of_damaged(each); }, tree.items[i]);
        if (items_[i]) more = std::visit([&](auto const& each) { return spread(each); }, tree.items[i]) || more;
      }
    }
  }

  bool bears_on(Diagnostic const& diagnostic) const {
    if (!diagnostic.primary || std::any_of(diagnostic.names.begin(), diagnostic.names.end(),
                                           [&](std::string const& name) { return has_word(name, words_); }))
      return true;
    std::string const& code = diagnostic.code;
    if (code.starts_with("E1")) return false;  // in a module
    // What could not be read among the items may be a model, a function or a module under any name.
    if (beside_items_ && (code == "E2003" || code == "E6001" || code.starts_with("E28") || code.starts_with("E29"))) return true;
    bool const names_and_units = code.starts_with("E20") || code.starts_with("E21") || code.starts_with("E22");
    for (std::size_t i = 0; i < items_.size(); ++i) {
      Span const span = span_of(tree_.items[i]);
      if (diagnostic.primary->span.begin < span.begin || diagnostic.primary->span.begin >= span.end) continue;
      if (std::holds_alternative<ast::Data>(tree_.items[i]))
        return !names_and_units && (items_[i] || std::find(of_a_block.begin(), of_a_block.end(), code) == of_a_block.end());
      if (!items_[i]) return false;
      return !std::holds_alternative<ast::Model>(tree_.items[i]) || !names_and_units ||
             std::find(of_the_whole.begin(), of_the_whole.end(), code) != of_the_whole.end();
    }
    return !names_and_units;  // in a module
  }

 private:
  static bool has_word(std::string_view text, std::set<std::string> const& words) {
    std::set<std::string> const here = words_in(text);
    return std::any_of(here.begin(), here.end(), [&](std::string const& each) { return words.contains(each); });
  }

  bool made_of_damaged(ast::Model const& model) const {
    if (names_.contains(model.name.text)) return true;
    return std::any_of(model.statements.begin(), model.statements.end(), [&](ast::ModelStatement const& statement) {
      auto const* part = std::get_if<ast::Part>(&statement);
      return part != nullptr && (beside_items_ || names_.contains(part->model.function.text));
    });
  }
  bool made_of_damaged(ast::Task const& task) const {
    return names_.contains(task.subject.text) || (task.name && names_.contains(task.name->text)) ||
           std::any_of(task.others.begin(), task.others.end(), [&](ast::Name const& each) { return names_.contains(each.text); }) ||
           std::any_of(task.data.begin(), task.data.end(),
                       [&](ast::DataReference const& each) { return names_.contains(each.data.text); });
  }
  bool made_of_damaged(ast::Candidates const& set) const {
    return names_.contains(set.name.text) ||
           std::any_of(set.statements.begin(), set.statements.end(), [&](ast::CandidateStatement const& statement) {
             auto const* candidate = std::get_if<ast::Candidate>(&statement);
             return candidate != nullptr && names_.contains(candidate->model.text);
           });
  }
  bool made_of_damaged(ast::Dictionary const& dictionary) const { return names_.contains(dictionary.name.text); }
  bool made_of_damaged(ast::Data const& data) const { return names_.contains(data.name.text); }
  bool made_of_damaged(ast::FunctionDefinition const&) const { return false; }
  bool made_of_damaged(ast::Use const&) const { return false; }

  // Whether a name was added.
  bool spread(ast::Model const& model) { return names_.insert(model.name.text).second; }
  bool spread(ast::Data const& data) { return names_.insert(data.name.text).second; }
  bool spread(ast::Candidates const& set) { return names_.insert(set.name.text).second; }
  bool spread(ast::Dictionary const& dictionary) { return names_.insert(dictionary.name.text).second; }
  bool spread(ast::Task const& task) { return names_.insert(task.called()).second; }
  bool spread(ast::FunctionDefinition const& function) { return names_.insert(function.name.text).second; }
  bool spread(ast::Use const&) { return false; }

  ast::File const& tree_;
  std::vector<bool> items_;      // which are damaged
  std::set<std::string> words_;  // in what could not be read
  std::set<std::string> names_;  // those, and of damaged items
  bool beside_items_ = false;    // something between the items could not be read
};

}  // namespace

void keep_independent(ast::File const& tree, std::span<Span const> unread, Source const& source, Diagnostics& found) {
  Damage const damage(tree, unread, source);
  std::vector<Diagnostic> all = found.all();
  std::erase_if(all, [&](Diagnostic const& each) { return each.severity != Severity::error || damage.bears_on(each); });
  found.replace(std::move(all));
}

}  // namespace sysid
