// tachk._core.CoverSearch and ClosedSet; used through tachk.engine.cover and tachk.engine.closed_set.
#include "certificates.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "certificates/closed_set.hpp"
#include "reachability/cover_search.hpp"
#include "reachability/pruning/traps.hpp"
#include "searching/patiently.hpp"

namespace tachk::bind {

namespace nb = nanobind;
using reachability::CoverParts;
using reachability::CoverSearch;

namespace {

using Column = nb::ndarray<const std::int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

using Rows = nb::ndarray<const std::int32_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

std::span<const std::int64_t> span_of(const Column& column) { return {column.data(), column.shape(0)}; }

std::vector<std::int64_t> widened(const std::vector<std::int32_t>& numbers) { return {numbers.begin(), numbers.end()}; }

// (slot, clock, values with the first and the last number of an interval, -1: none)
using GivenTrap = std::tuple<std::uint32_t, std::uint16_t, std::vector<std::array<std::int64_t, 3>>>;
using Clauses = std::vector<std::vector<std::size_t>>;

std::vector<GivenTrap> traps_of(const std::vector<std::int64_t>& image) {
  std::vector<GivenTrap> given;
  for (const auto& [slot, clock, outside] : reachability::pruning::traps_of(program::decode_program(image))) {
    auto& parts = std::get<2>(given.emplace_back(slot, clock, std::vector<std::array<std::int64_t, 3>>{}));
    for (const auto& [value, first, last] : outside)
      parts.push_back({value, first, last == reachability::pruning::Outside::for_ever ? -1 : last});
  }
  return given;
}

std::vector<reachability::pruning::Trap> traps_of_search(const std::vector<GivenTrap>& given) {
  std::vector<reachability::pruning::Trap> traps;
  for (const auto& [slot, clock, outside] : given) {
    auto& parts = traps.emplace_back(reachability::pruning::Trap{slot, clock, {}}).outside;
    for (const auto& [value, first, last] : outside)
      parts.push_back(
          {static_cast<std::int32_t>(value), first, last < 0 ? reachability::pruning::Outside::for_ever : last});
  }
  return traps;
}

// Values that a slot never has are left out.
certificates::Traps traps_of_checker(const program::Program& program, const std::vector<GivenTrap>& given,
                                     const Clauses& clauses) {
  std::vector<certificates::IndexedTrap> traps;
  for (const auto& [slot, clock, outside] : given) {
    if (slot >= program.state_slots || clock > program.clocks) throw std::invalid_argument("a trap that cannot be");
    const std::int32_t low = program.slots[slot].low, high = program.slots[slot].high;
    certificates::IndexedTrap& trap = traps.emplace_back(certificates::IndexedTrap{slot, low, {}});
    trap.outside.resize(static_cast<std::size_t>(std::int64_t{high} - low + 1));
    for (const auto& [value, first, last] : outside) {
      if (value < low || value > high) continue;
      certificates::Constraints& part = trap.outside[static_cast<std::size_t>(value - low)].emplace_back();
      if (clock == 0) continue;
      part.push_back({0, clock, zones::raw_bound(-(first / 2), first % 2 != 0)});
      if (last >= 0) part.push_back({clock, 0, zones::raw_bound((last + 1) / 2, last % 2 != 0)});
    }
  }
  for (const auto& clause : clauses)
    for (const std::size_t number : clause)
      if (number >= traps.size()) throw std::invalid_argument("a trap that there is not");
  return {std::move(traps), clauses};
}

void bind_closed_set(nb::module_& m) {
  using certificates::ClosedSet;
  nb::class_<ClosedSet>(m, "ClosedSet", "The check that a set of symbolic states is closed.")
      .def(nb::new_(
               [](const std::vector<std::int64_t>& image, const std::vector<GivenTrap>& traps, const Clauses& clauses) {
                 program::Program program = program::decode_program(image);
                 if (program.goals.empty()) throw std::invalid_argument("nothing to meet");
                 certificates::Traps made = traps_of_checker(program, traps, clauses);
                 return std::make_unique<ClosedSet>(std::move(program), std::move(made));
               }),
           nb::arg("image"), nb::arg("traps"), nb::arg("clauses"))
      .def(
          "add",
          [](ClosedSet& self, const Rows& discretes, const Column& zones, const Column& ranks, const Column& shapes,
             const Column& bounds) {
            const auto elements =
                static_cast<std::size_t>(std::accumulate(zones.data(), zones.data() + zones.size(), std::int64_t{0}));
            if (zones.size() != discretes.shape(0) || ranks.size() != elements || shapes.size() != elements)
              throw std::invalid_argument("columns of different lengths");
            self.add({{discretes.data(), discretes.size()},
                      span_of(zones),
                      span_of(ranks),
                      span_of(shapes),
                      span_of(bounds)});
          },
          nb::arg("discretes"), nb::arg("zones"), nb::arg("ranks"), nb::arg("shapes"), nb::arg("bounds"),
          "Adds discrete states as rows, with the numbers of their zones, and the bounds of zones that are new.")
      .def("check", &ClosedSet::check, nb::arg("states"), nb::call_guard<nb::gil_scoped_release>(),
           "Checks so many more discrete states; whether there is nothing left to check.")
      .def(
          "objection",
          [](const ClosedSet& self) {
            const auto& found = self.objection();
            using Answer = std::tuple<std::string, std::vector<std::int32_t>, std::size_t, std::vector<std::uint32_t>>;
            return found ? std::optional(Answer{found->reason, found->discrete, found->zone, found->edges})
                         : std::nullopt;
          },
          "(reason, discrete state, number of the zone, edges of the action), or None.");
}

}  // namespace

void bind_certificates(nb::module_& m) {
  nb::class_<CoverParts>(m, "CoverParts", "Symbolic states, grouped by discrete state.")
      .def("groups", &CoverParts::groups, "How many groups there are.")
      .def("zones", &CoverParts::zones, "How many zones.")
      .def(
          "part",
          [](CoverParts& self, std::size_t first, std::size_t zones) {
            reachability::CoverPart part = self.part(first, zones);
            return nb::make_tuple(as_array(widened(part.discretes)), as_array(std::move(part.zones)),
                                  as_array(std::move(part.ranks)), as_array(std::move(part.constraints)),
                                  as_array(std::move(part.places)), as_array(std::move(part.bounds)));
          },
          nb::arg("first"), nb::arg("zones"),
          "The groups from `first` on with about so many zones: discrete states, numbers of zones, ranks, numbers of "
          "constraints, left * (clocks + 1) + right, raw bounds.");
  nb::class_<CoverSearch>(m, "CoverSearch", "The search for a small closed set of symbolic states.")
      .def(nb::new_([](const std::vector<std::int64_t>& image, const reachability::Options& options,
                       const reachability::Limits& limits, bool hulls, const std::vector<GivenTrap>& traps,
                       const Clauses& clauses) {
             return std::make_unique<CoverSearch>(program::decode_program(image), options, limits, hulls,
                                                  traps_of_search(traps), clauses);
           }),
           nb::arg("image"), nb::arg("options"), nb::arg("limits"), nb::kw_only(), nb::arg("hulls"), nb::arg("traps"),
           nb::arg("clauses"))
      .def("run", &run_patiently<CoverSearch>, nb::arg("expansions"), nb::arg("seconds") = nb::none(),
           nb::arg("poll") = nb::none(),
           "Explores up to this many states; TIME_LIMIT if it was given up in the midst of one.")
      .def("reached", &CoverSearch::reached, "True if a goal is reached, and there is no such set.")
      .def(
          "statistics",
          [](const CoverSearch& self) {
            const reachability::Statistics s = self.statistics();
            return std::make_tuple(s.explored, s.stored, s.transitions, s.bytes);
          },
          "(explored, stored, transitions, bytes)")
      .def("cover", &CoverSearch::cover, nb::rv_policy::reference_internal,
           "The symbolic states that cover all reachable ones, of a finished search.");
  m.def("traps_of", &traps_of, nb::arg("image"),
        "The traps in which the goal cannot be reached: (slot, clock, [(value, first, last or -1)]).");
  bind_closed_set(m);
}

}  // namespace tachk::bind
