#include "monitoring/online/online_rewriting.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "monitoring/monitor_cells.hpp"

namespace tachk::monitoring::online {
namespace {

struct Part {
  std::size_t node;
  bool negated;
};

class Rewriting {
 public:
  explicit Rewriting(const MonitorProgram& program) : program_(program) {}

  std::optional<MonitorProgram> run() {
    std::vector<Part> conjuncts;
    split({program_.nodes.size() - 1, false}, true, conjuncts);
    std::vector<std::size_t> rewritten;
    for (const Part& conjunct : conjuncts) {
      const MonitorNode node = program_.nodes[conjunct.node];
      const bool always = !conjunct.negated && node.kind == NodeKind::always;
      const bool never = conjunct.negated && node.kind == NodeKind::eventually;
      if (!(always || never) || node.lower != 0 || !node.lower_closed || node.upper != unbounded) {
        rewritten.push_back(plain(conjunct));
        continue;
      }
      std::vector<Part> guarded;
      split({node.operands[0], never}, true, guarded);
      for (const Part& part : guarded) {
        MonitorNode globally = node;
        globally.kind = NodeKind::always;
        globally.operands = {invariant(part)};
        rewritten.push_back(add(globally));
      }
    }
    if (!changed_) return std::nullopt;
    junction(NodeKind::logical_and, rewritten);  // a single one has been made last
    std::int64_t reach = 0;
    for (const MonitorNode& node : program_.nodes) reach += std::max(node.lower, node.upper);
    if (reach >= largest_tick / 2) return std::nullopt;
    return std::move(program_);
  }

 private:
  // The operands of a conjunction (or disjunction) whatever its form.
  void split(Part part, bool conjunction, std::vector<Part>& out) const {
    const MonitorNode& node = program_.nodes[part.node];
    const NodeKind wanted = conjunction != part.negated ? NodeKind::logical_and : NodeKind::logical_or;
    if (node.kind == NodeKind::logical_not) {
      split({node.operands[0], !part.negated}, conjunction, out);
    } else if (node.kind == wanted) {
      for (const std::size_t operand : node.operands) split({operand, part.negated}, conjunction, out);
    } else {
      out.push_back(part);
    }
  }

  // The formula that has to hold at every instant instead of `part`.
  std::size_t invariant(const Part& part) {
    std::vector<Part> alternatives;
    split(part, false, alternatives);
    std::size_t chosen = alternatives.size();
    for (std::size_t n = 0; n < alternatives.size(); ++n) {
      const MonitorNode& node = program_.nodes[alternatives[n].node];
      if (node.kind != (alternatives[n].negated ? NodeKind::eventually : NodeKind::always) || node.upper == unbounded ||
          node.upper < node.lower || (node.upper == node.lower && !(node.lower_closed && node.upper_closed)))
        continue;
      if (chosen == alternatives.size() || node.upper > program_.nodes[alternatives[chosen].node].upper) chosen = n;
    }
    if (chosen == alternatives.size()) return plain(part);
    changed_ = true;
    const Part window = alternatives[chosen];
    MonitorNode before = program_.nodes[window.node];
    const std::size_t inside = plain({before.operands[0], window.negated});
    std::vector<std::size_t> others;
    for (std::size_t n = 0; n < alternatives.size(); ++n)
      if (n != chosen) others.push_back(plain(alternatives[n]));
    if (others.empty()) {
      MonitorNode nothing;
      nothing.kind = NodeKind::always_false;
      others.push_back(add(nothing));
    }
    before.kind = NodeKind::historically;
    before.operands = {junction(NodeKind::logical_or, others)};
    return junction(NodeKind::logical_or, {add(before), inside});
  }

  std::size_t plain(const Part& part) {
    if (!part.negated) return part.node;
    MonitorNode negation;
    negation.kind = NodeKind::logical_not;
    negation.operands = {part.node};
    return add(negation);
  }
  std::size_t junction(NodeKind kind, const std::vector<std::size_t>& operands) {
    if (operands.size() == 1) return operands[0];
    MonitorNode node;
    node.kind = kind;
    node.operands = operands;
    return add(node);
  }
  std::size_t add(const MonitorNode& node) {
    program_.nodes.push_back(node);
    return program_.nodes.size() - 1;
  }

  MonitorProgram program_;
  bool changed_ = false;
};

}  // namespace

std::optional<MonitorProgram> falling_sooner(const MonitorProgram& program) { return Rewriting(program).run(); }

}  // namespace tachk::monitoring::online
