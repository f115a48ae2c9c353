#include "program/program.hpp"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace tachk::program {

using zones::ClockReset;
using zones::Raw;

namespace {

class Reader {
 public:
  explicit Reader(std::span<const std::int64_t> image) : image_(image) {}

  std::int64_t wide() {
    if (position_ >= image_.size()) throw std::invalid_argument("program image is too short");
    return image_[position_++];
  }
  std::int32_t number() {
    const std::int64_t value = wide();
    if (value < INT32_MIN || value > INT32_MAX) throw std::invalid_argument("number beyond 32 bits in image");
    return static_cast<std::int32_t>(value);
  }
  std::uint32_t count() {
    const std::int32_t value = number();
    if (value < 0 || static_cast<std::size_t>(value) > image_.size()) throw std::invalid_argument("bad count in image");
    return static_cast<std::uint32_t>(value);
  }
  std::uint32_t below(std::size_t limit, const char* what) {
    const std::int32_t value = number();
    if (value < 0 || static_cast<std::size_t>(value) >= limit)
      throw std::invalid_argument(std::string("bad ") + what + " in image");
    return static_cast<std::uint32_t>(value);
  }
  bool flag() { return number() != 0; }
  template <class Read>
  auto sequence(Read read) {
    std::vector<decltype(read())> items(count());
    for (auto& item : items) item = read();
    return items;
  }
  void finish() const {
    if (position_ != image_.size()) throw std::invalid_argument("program image is too long");
  }

 private:
  std::span<const std::int64_t> image_;
  std::size_t position_ = 0;
};

class Decoder {
 public:
  explicit Decoder(std::span<const std::int64_t> image) : in_(image) {}

  Program decode() {
    program_.clocks = static_cast<int>(in_.below(60000, "number of clocks"));
    program_.state_slots = in_.count();
    program_.slots = in_.sequence([this] { return Slot{in_.number(), in_.number(), in_.number(), in_.flag()}; });
    if (program_.state_slots > program_.slots.size()) throw std::invalid_argument("more state slots than slots");
    program_.code = in_.sequence([this] { return in_.number(); });
    program_.channels = in_.sequence([this] { return Channel{in_.flag(), in_.flag(), in_.number()}; });
    program_.processes =
        in_.sequence([this] { return Process{in_.number(), in_.sequence([this] { return location(); })}; });
    program_.edges = in_.sequence([this] { return edge(); });
    program_.goals = in_.sequence([this] { return goal(); });
    program_.measures = in_.sequence([this] { return measure(); });
    program_.default_priority = in_.number();
    program_.maximum_constants = in_.sequence([this] { return note(in_.wide()); });
    program_.diagonals = in_.sequence([this] {
      const auto left = clock();
      const auto right = clock();
      const Raw raw = in_.wide();
      note(zones::raw_value(raw));
      return zones::Atom{left, right, raw};
    });
    program_.has_priorities = in_.flag();
    program_.has_stopwatches = in_.flag();
    program_.copies_clocks = in_.flag();
    note(in_.number());
    program_.computed_unit = in_.wide();
    if (program_.computed_unit < 0) throw std::invalid_argument("negative unit in image");
    program_.interchangeable = in_.sequence([this] { return interchangeable(); });
    program_.starts = in_.sequence([this] {
      const std::uint16_t started = clock();
      return ClockReset{started, static_cast<std::int32_t>(note(in_.number()))};
    });
    in_.finish();
    return std::move(program_);
  }

 private:
  std::uint16_t clock() {
    return static_cast<std::uint16_t>(in_.below(static_cast<std::size_t>(program_.dimension()), "clock"));
  }
  std::uint32_t slot() { return in_.below(program_.slots.size(), "slot"); }
  std::int32_t code() {
    const std::int32_t position = in_.number();
    if (position != no_code && (position < 0 || static_cast<std::size_t>(position) >= program_.code.size()))
      throw std::invalid_argument("bad code position in image");
    return position;
  }
  Raw note(Raw constant) {
    program_.largest_constant = std::max(program_.largest_constant, std::abs(constant));
    return constant;
  }

  Condition condition() {
    Condition result;
    result.tests = in_.sequence([this] {
      const std::uint32_t s = slot();
      const auto comparison = static_cast<Comparison>(in_.below(6, "comparison"));
      return Test{s, comparison, in_.number()};
    });
    result.code = code();
    for (std::uint32_t n = in_.count(); n > 0; --n) {
      const std::uint16_t left = clock();
      const std::uint16_t right = clock();
      const bool strict = in_.flag();
      const std::int32_t bound = in_.number();
      const std::int32_t bound_code = code();
      const std::int32_t when = code();
      const std::int32_t left_code = code();
      const std::int32_t right_code = code();
      note(bound);
      if (bound_code == no_code && when == no_code && left_code == no_code && right_code == no_code)
        result.atoms.push_back({left, right, zones::raw_bound(bound, strict)});
      else
        result.computed.push_back({left, right, strict, bound, bound_code, when, left_code, right_code});
    }
    result.flow = in_.sequence([this] {
      const auto kind = static_cast<FlowTest::Kind>(in_.below(7, "kind of condition"));
      const bool affine = in_.flag();
      const std::int32_t left = code();
      const std::int32_t right = code();
      if (left == no_code || (right == no_code) != (kind == FlowTest::Kind::truth))
        throw std::invalid_argument("bad condition on hybrid clocks in image");
      return FlowTest{kind, affine, left, right};
    });
    return result;
  }

  Update update() {
    Update result;
    result.stores = in_.sequence([this] {
      const std::uint32_t s = slot();
      return Update::Store{s, in_.number()};
    });
    result.resets = in_.sequence([this] {
      const std::uint16_t c = clock();
      const std::int32_t value = in_.number();
      note(value);
      return ClockReset{c, value, clock()};
    });
    result.code = code();
    return result;
  }

  std::vector<ClockBound> clock_bounds() {
    return in_.sequence([this] {
      const std::uint16_t c = clock();
      return ClockBound{c, note(in_.wide())};
    });
  }

  Location location() {
    Location result;
    result.invariant = condition();
    result.has_invariant = !result.invariant.trivial();
    result.urgent = in_.flag();
    result.committed = in_.flag();
    result.observes = in_.flag();
    result.stopped = in_.sequence([this] {
      const std::uint16_t c = clock();
      return Location::Stop{c, code()};
    });
    result.lower = clock_bounds();
    result.upper = clock_bounds();
    return result;
  }

  Edge edge() {
    Edge result;
    result.process = in_.below(program_.processes.size(), "process");
    const std::size_t locations = program_.processes[result.process].locations.size();
    result.source = static_cast<std::int32_t>(in_.below(locations, "location"));
    result.target = static_cast<std::int32_t>(in_.below(locations, "location"));
    result.guard = condition();
    result.channel = in_.number();
    result.channels = in_.count();
    if (result.channel >= 0 && static_cast<std::size_t>(result.channel) + result.channels > program_.channels.size())
      throw std::invalid_argument("bad channel in image");
    result.channel_code = code();
    result.sends = in_.flag();
    result.update = update();
    return result;
  }

  Goal goal() {
    const bool decides = in_.flag();
    return Goal{in_.sequence([this] {
                  const auto deadlock = static_cast<DeadlockLiteral>(in_.number());
                  return Disjunct{condition(), deadlock};
                }),
                decides};
  }

  Measure measure() {
    Measure result;
    result.where = goal();
    result.largest = in_.flag();
    result.clock = clock();
    result.code = code();
    if ((result.clock == 0) == (result.code == no_code)) throw std::invalid_argument("bad measure in image");
    return result;
  }

  Interchangeable interchangeable() {
    Interchangeable group;
    group.slots = in_.sequence([this] { return in_.sequence([this] { return slot(); }); });
    group.clocks = in_.sequence([this] { return in_.sequence([this] { return clock(); }); });
    group.tables = in_.sequence([this] { return in_.sequence([this] { return in_.number(); }); });
    group.names = in_.sequence([this, &group] {
      const std::uint32_t where = slot();
      return Interchangeable::Name{where, in_.below(group.tables.size(), "table")};
    });
    group.cyclic = in_.flag();
    const auto differ = [](const auto& items, std::size_t size) {
      return std::any_of(items.begin(), items.end(), [size](const auto& item) { return item.size() != size; });
    };
    const std::size_t members = group.slots.size();
    if (members < 2 || group.clocks.size() != members || differ(group.slots, group.slots.front().size()) ||
        differ(group.clocks, group.clocks.front().size()) || differ(group.tables, members))
      throw std::invalid_argument("bad group of processes in image");
    return group;
  }

  Reader in_;
  Program program_;
};

void renumber_members(std::vector<Interchangeable>& groups, const std::vector<std::uint16_t>& numbers) {
  // Exchanging processes means nothing where a clock of only one of them is compared.
  std::erase_if(groups, [&numbers](const Interchangeable& group) {
    for (const std::vector<std::uint16_t>& clocks : group.clocks)
      for (std::size_t role = 0; role < clocks.size(); ++role)
        if ((numbers[clocks[role]] == 0) != (numbers[group.clocks.front()[role]] == 0)) return true;
    return false;
  });
  for (Interchangeable& group : groups)
    for (std::vector<std::uint16_t>& clocks : group.clocks) {
      for (std::uint16_t& clock : clocks) clock = numbers[clock];
      std::erase(clocks, 0);
    }
}

// A clock that is not compared has no bound anywhere, so no constraint mentions it. One that is measured is needed also
// where no state counts, so that it has no bound.
std::vector<bool> compared_clocks(const Program& program) {
  std::vector<bool> compared(static_cast<std::size_t>(program.dimension()), false);
  for (const Process& process : program.processes)
    for (const Location& location : process.locations)
      for (const std::vector<ClockBound>* bounds : {&location.lower, &location.upper})
        for (const ClockBound& bound : *bounds) compared[bound.clock] = true;
  for (const Measure& measure : program.measures) compared[measure.clock] = true;
  return compared;
}

}  // namespace

Program decode_program(std::span<const std::int64_t> image) { return Decoder(image).decode(); }

Program without_idle_clocks(Program program) {
  const std::vector<bool> compared = compared_clocks(program);
  if (std::find(compared.begin() + 1, compared.end(), false) == compared.end()) return program;

  std::vector<std::uint16_t> numbers(compared.size(), 0);
  std::uint16_t last = 0;
  for (std::size_t clock = 1; clock < compared.size(); ++clock)
    if (compared[clock]) numbers[clock] = ++last;
  const auto mentioned = [&](auto& clock) {
    const auto old = static_cast<std::size_t>(clock);
    if (old != 0 && numbers[old] == 0) throw std::invalid_argument("a clock that is compared has no bound");
    clock = numbers[old];
  };
  const auto renumber = [&](auto& items) {
    for (auto& item : items) {
      mentioned(item.left);
      mentioned(item.right);
    }
  };
  const auto renumber_condition = [&](Condition& condition) {
    renumber(condition.atoms);
    renumber(condition.computed);
  };
  // For anything that has a clock and means nothing if that is idle.
  const auto renumber_each = [&](auto& items) {
    std::erase_if(items, [&](const auto& item) { return numbers[item.clock] == 0; });
    for (auto& item : items) item.clock = numbers[item.clock];
  };
  for (Process& process : program.processes)
    for (Location& location : process.locations) {
      renumber_condition(location.invariant);
      renumber_each(location.stopped);
      renumber_each(location.lower);
      renumber_each(location.upper);
    }
  for (Edge& edge : program.edges) {
    renumber_condition(edge.guard);
    renumber_each(edge.update.resets);
    for (ClockReset& reset : edge.update.resets) reset.source = numbers[reset.source];
  }
  for (Goal& goal : program.goals)
    for (Disjunct& disjunct : goal.disjuncts) renumber_condition(disjunct.condition);
  for (Measure& measure : program.measures) {
    for (Disjunct& disjunct : measure.where.disjuncts) renumber_condition(disjunct.condition);
    mentioned(measure.clock);
  }
  renumber_each(program.starts);
  renumber_members(program.interchangeable, numbers);
  renumber(program.diagonals);
  for (std::size_t clock = 1; clock < numbers.size(); ++clock)
    if (numbers[clock] != 0) program.maximum_constants[numbers[clock]] = program.maximum_constants[clock];
  program.maximum_constants.resize(std::size_t{last} + 1);
  program.clocks = last;
  program.clock_numbers = std::move(numbers);
  return program;
}

}  // namespace tachk::program
