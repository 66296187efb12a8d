// Passes over lists: targets read, terms written out and made nodes, equal ones merged, exclusions applied.
#include <algorithm>

#include "check/dictionary/dictionary_checker.hpp"
#include "check/message/errors.hpp"
#include "syntax/unparse.hpp"

namespace sysid {
namespace {

constexpr std::size_t most_terms = 1000;

}  // namespace

bool DictionaryChecker::refuse_list(ast::DictionaryListKind kind, ast::Expression const& item) const {
  if (!std::holds_alternative<ast::Box<ast::List>>(item.node)) return false;
  diagnostics_.add(errors::list_of_terms(kind == ast::DictionaryListKind::target  ? "target"
                                         : kind == ast::DictionaryListKind::terms ? "terms"
                                                                                  : "exclude",
                                         item));
  return true;
}

void DictionaryChecker::targets() {
  each_item(ast::DictionaryListKind::target, [&](ast::Expression const& tree) {
    auto const value = scope_.expression(tree);
    if (!value) return;
    for (Target const& before : targets_)
      if (before.value.node == value->node) {
        diagnostics_.add(errors::target_twice(tree.span, before.tree->span, unparse(tree)));
        return;
      }
    targets_.push_back({&tree, with_own_unit(*value)});
  });
  if (targets_.empty() && !failed()) diagnostics_.add(errors::no_target(tree_.name));
}

void DictionaryChecker::terms() {
  bool any = false;
  each<ast::DictionaryList>([&](ast::DictionaryList const& list) { any = any || list.kind == ast::DictionaryListKind::terms; });
  each_item(ast::DictionaryListKind::terms, [&](ast::Expression const& item) {
    for (WrittenTerm& written : writer_.write(item, free_)) {
      auto made = candidate(std::move(written));
      if (!made) return;  // the next of the same family has the same mistake
      if (made->factors.constant == 0) {
        out_.excluded.push_back({ExcludedTerm::Why::zero, made->written.text, {}});
        continue;
      }
      // One with a name before it and one without are told apart: the name asks for a unit.
      auto const same = std::find_if(terms_.begin(), terms_.end(), [&](Candidate const& each) {
        return each.factors.proportional(made->factors) && each.written.coefficient == made->written.coefficient;
      });
      if (same != terms_.end()) {
        out_.excluded.push_back({ExcludedTerm::Why::same, made->written.text, same->written.text});
      } else {
        terms_.push_back(std::move(*made));
      }
      if (terms_.size() > most_terms) {
        diagnostics_.add(errors::too_many_terms(item.span, most_terms));
        return;
      }
    }
  });
  if (!any) diagnostics_.add(errors::no_terms(tree_.name));
}

void DictionaryChecker::exclude() {
  each_item(ast::DictionaryListKind::exclude, [&](ast::Expression const& item) {
    bool any = false;
    for (WrittenTerm& written : writer_.write(item, {})) {
      auto const made = candidate(std::move(written));
      if (!made) return;
      auto const same = std::find_if(terms_.begin(), terms_.end(),
                                     [&](Candidate const& each) { return each.factors.proportional(made->factors); });
      if (same == terms_.end()) continue;
      any = true;
      out_.excluded.push_back({ExcludedTerm::Why::excluded, same->written.text, {}});
      terms_.erase(same);
    }
    if (any || failed()) return;
    errors::Names known;
    for (Candidate const& each : terms_) known.push_back(each.written.text);
    diagnostics_.add(errors::excludes_nothing(item.span, unparse(item), known));
  });
}

std::optional<DictionaryChecker::Candidate> DictionaryChecker::candidate(WrittenTerm written) {
  std::size_t const before = diagnostics_.all().size();
  auto value = scope_.expression(written.tree);
  if (!value || diagnostics_.has_errors(before)) return std::nullopt;
  *value = with_own_unit(*value);
  Candidate made;
  made.node = with_values(value->node);
  if (out_.numbers.graph.depends(made.node, [&](Node const& node) {
        return is_parameter(node) && !parameters_[static_cast<std::size_t>(node.index)].inner;
      })) {
    diagnostics_.add(errors::coefficient_inside(written.tree.span, unparse(written.tree)));
    return std::nullopt;
  }
  if (value->kind == Typed::Kind::known) made.unit = value->unit;
  if (value->kind == Typed::Kind::literal) made.unit = Unit{};
  made.factors = factors_of(out_.numbers.graph, made.node);
  made.written = std::move(written);
  if (!bends(made)) return std::nullopt;
  return made;
}

bool DictionaryChecker::bends(Candidate const& made) {
  for (InnerParameter const& each : out_.inner) {
    if (!made.factors.powers.contains(each.leaf)) continue;
    bool const elsewhere = std::any_of(made.factors.powers.begin(), made.factors.powers.end(), [&](auto const& power) {
      return power.first != each.leaf && depends_on(power.first, each.leaf);
    });
    if (elsewhere) continue;
    diagnostics_.add(errors::inner_scales(made.written.tree.span, made.written.text, each.quantity.name,
                                          declared_text(parameter_of(each.quantity.name))));
    return false;
  }
  return true;
}

std::string DictionaryChecker::declared_text(ParameterInfo const& parameter) {
  ast::Declared const& name = parameter.tree->name;
  return name.name.text + (name.unit ? " [" + unparse(*name.unit) + "]" : "");
}

bool DictionaryChecker::depends_on(NodeId root, NodeId leaf) const {
  std::vector<NodeId> const below = out_.numbers.graph.reachable({&root, 1});
  return std::find(below.begin(), below.end(), leaf) != below.end();
}

NodeId DictionaryChecker::with_values(NodeId root) {
  return out_.numbers.graph.substitute(root, [&](NodeId leaf) -> std::optional<NodeId> {
    Node const node = out_.numbers.graph[leaf];
    if (node.leaf_kind != LeafKind::parameter) return std::nullopt;
    auto const& value = parameters_[static_cast<std::size_t>(node.index)].value;
    return value ? std::optional(out_.numbers.graph.constant(*value)) : std::nullopt;
  });
}

}  // namespace sysid
