// The check that a set of symbolic states is closed: it covers the initial state and every successor of its states, and
// none of them satisfies a goal. Then no reachable state does (Wimmer and von Mutius 2020). Or that each run meets the
// goal, from the initial state or from the states of a second goal on: successors of ranked elements have smaller ranks
// or satisfy it, and nothing can stay in one for ever (Wimmer, Herbreteau and van de Pol 2020).
//
// network.hpp says what the checker shares with the engine. tachk.certify.closed_set is the same check in Python, which
// does without the compiler as well.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "program/program.hpp"

namespace tachk {

// What is wrong with a set, and where: the discrete state, the zone among those of this discrete state, and the edges
// of the action that leads out of the set.
struct Objection {
  std::string reason;
  std::vector<std::int32_t> discrete;
  std::size_t zone = 0;
  std::vector<std::uint32_t> edges;
};

enum class Claim { unreachable, inevitable };

// Discrete states with their zones, as tachk.certify.certificate.Columns.
struct CertificateColumns {
  std::span<const std::int64_t> changes, positions, differences, zones, ranks, shapes, constraints, places, bounds;
};

class ClosedSet final {
 public:
  ClosedSet(Program program, Claim claim);
  ~ClosedSet();

  // Adds discrete states with their zones. Throws std::invalid_argument for what is no state of the program.
  void add(CertificateColumns columns);
  // Checks at most so many more discrete states; true once there is nothing left to check, or an objection.
  bool check(std::size_t states);
  const std::optional<Objection>& objection() const;

 private:
  class Checker;
  std::unique_ptr<Checker> checker_;
};

}  // namespace tachk
