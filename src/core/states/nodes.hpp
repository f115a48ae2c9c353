// The nodes of a search by number: each is a state, a discrete part and a zone, by the numbers that these have.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "states/memory.hpp"

namespace tachk {

inline constexpr std::uint32_t no_node = UINT32_MAX;

struct Node {
  std::uint32_t link;  // the next in a short antichain; for the last one and others, the discrete state and the mark
  std::uint32_t zone;  // of a covered node with the mark: if its zone may be gone, what else fits of the hash of that
};

class Nodes final {
 public:
  static constexpr std::uint32_t mark = std::uint32_t{1} << 31;

  std::uint32_t size() const { return records_.size(); }
  std::uint32_t append() { return records_.append(); }
  Node& operator[](std::uint32_t number) { return *reinterpret_cast<Node*>(records_[number]); }
  const Node& operator[](std::uint32_t number) const { return *reinterpret_cast<const Node*>(records_[number]); }

  bool covered(std::uint32_t number) const { return ((*this)[number].zone & mark) != 0; }
  std::uint32_t zone(std::uint32_t number) const { return (*this)[number].zone & ~mark; }
  std::uint32_t discrete(std::uint32_t number) const {
    std::uint32_t link = (*this)[number].link;
    while ((link & mark) == 0) link = (*this)[link].link;
    return link & ~mark;
  }
  // The next in a short antichain; no_node behind the last.
  std::uint32_t next(std::uint32_t number) const {
    const std::uint32_t link = (*this)[number].link;
    return (link & mark) != 0 ? no_node : link;
  }

  // From now on these nodes, whose numbers rise, and those from `first` to `last`, without it, are not covered by
  // others.
  void protect(std::vector<std::uint32_t> nodes, std::uint32_t first, std::uint32_t last) {
    protected_ = {std::move(nodes), first, last - first};
  }
  bool is_protected(std::uint32_t number) const {
    return number - protected_.first < protected_.count ||
           std::binary_search(protected_.nodes.begin(), protected_.nodes.end(), number);
  }

  std::size_t bytes() const { return records_.bytes(); }

 private:
  RecordPool records_{sizeof(Node)};
  struct {
    std::vector<std::uint32_t> nodes;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  } protected_;
};

}  // namespace tachk
