// Operators on streams. Each reads what has become known of its inputs and makes known what follows of its output.
//
// Every operator is amortised O(1) for a piece of input. What they keep is bounded by the number of pieces in their
// window; without a window, by what is undecided until the trace ends.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "monitoring/offline/monitor_graph.hpp"
#include "monitoring/offline/monitor_stream.hpp"

namespace tachk::monitoring::offline {

// The knowledge about the end of the trace.
struct TraceEnd {
  Cell reached = 0;       // this cell is certainly not after the end
  bool finished = false;  // and it is the last one
  // After the end, values count as false (least) or as true (greatest), or the leaves go on as they are (held);
  // they speak about it only if that is settled.
  enum class Beyond { unknown, least, greatest, held } beyond = Beyond::unknown;
};

template <class Value>
class StreamOperator {
 public:
  using Inputs = std::span<const Stream<Value>* const>;

  StreamOperator() = default;
  StreamOperator(const StreamOperator&) = default;
  StreamOperator& operator=(const StreamOperator&) = delete;
  virtual ~StreamOperator() = default;

  // Extends the output as far as the inputs and the end of the trace allow, or by some thousand pieces: then it has to
  // be called again.
  virtual void advance(Inputs inputs, const TraceEnd& end, Stream<Value>& out) = 0;
  // The number of the first piece of an input that will be read again.
  virtual std::size_t needed(std::size_t input) const = 0;
  virtual std::unique_ptr<StreamOperator> clone() const = 0;
  virtual std::size_t bytes() const { return 0; }
};

template <class Value>
std::unique_ptr<StreamOperator<Value>> make_operator(const StreamNode& node);

}  // namespace tachk::monitoring::offline
