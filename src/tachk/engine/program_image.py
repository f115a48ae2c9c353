"""The flat form of a program, in which it goes to the core: the fields of the dataclasses in order, each sequence
preceded by its length."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tachk.engine.compiler.program import ClockConstraint, Condition, Goal, Measure, Program, ProgramLocation, Update


def encode(program: Program, goals: Sequence[Goal], measures: Sequence[Measure] = ()) -> list[int]:
    """The numbers that `src/core/program/program.cpp` reads."""
    image = [program.clocks, program.state_slots, len(program.slots)]
    for slot in program.slots:
        image += (slot.low, slot.high, slot.initial, int(slot.meta))
    image += (len(program.code), *program.code)
    image.append(len(program.channels))
    for channel in program.channels:
        image += (int(channel.broadcast), int(channel.urgent), channel.priority)
    image.append(len(program.locations))
    for priority, locations in zip(program.process_priorities, program.locations, strict=True):
        image += (priority, len(locations))
        for location in locations:
            image.extend(_location(location))
    image.append(len(program.edges))
    for edge in program.edges:
        image += (edge.process, edge.source, edge.target)
        image.extend(_condition(edge.guard))
        image += (edge.channel, edge.channels, edge.channel_code, int(edge.sends))
        image.extend(_update(edge.update))
    image.append(len(goals))
    for goal in goals:
        image.extend(_goal(goal))
    image.append(len(measures))
    for measure in measures:
        image += (*_goal(measure.where), int(measure.largest), measure.clock, measure.code)
    image.append(program.default_priority)
    image += (len(program.maximum_constants), *program.maximum_constants)
    image += (len(program.diagonals), *(number for diagonal in program.diagonals for number in diagonal))
    image += (int(program.has_priorities), int(program.has_stopwatches), int(program.copies_clocks))
    image += (program.largest_reset, program.computed_unit)
    image.append(len(program.interchangeable))
    for group in program.interchangeable:
        for rows in (group.slots, group.clocks, group.tables, group.names):
            image.append(len(rows))
            for row in rows:
                image += row if rows is group.names else (len(row), *row)
        image.append(int(group.cyclic))
    image += (len(program.starts), *(number for start in program.starts for number in start))
    return image


def _goal(goal: Goal) -> Iterator[int]:
    yield from (int(goal.decides), len(goal.disjuncts))
    for disjunct in goal.disjuncts:
        yield int(disjunct.deadlock)
        yield from _condition(disjunct.condition)


def _location(location: ProgramLocation) -> Iterator[int]:
    yield from _condition(location.invariant)
    yield from (int(location.urgent), int(location.committed), int(location.observes))
    for pairs in (location.stopped, location.lower, location.upper):
        yield len(pairs)
        for pair in pairs:
            yield from pair


def _condition(condition: Condition) -> Iterator[int]:
    yield len(condition.tests)
    for test in condition.tests:
        yield from (test.slot, int(test.comparison), test.constant)
    yield condition.code
    yield len(condition.constraints)
    for constraint in condition.constraints:
        yield from _constraint(constraint)
    yield len(condition.flow)
    for test_of_flow in condition.flow:
        yield from (int(test_of_flow.kind), int(test_of_flow.affine), test_of_flow.left, test_of_flow.right)


def _constraint(c: ClockConstraint) -> tuple[int, ...]:
    return (c.left, c.right, int(c.strict), c.bound, c.bound_code, c.condition, c.left_code, c.right_code)


def _update(update: Update) -> Iterator[int]:
    for entries in (update.stores, update.resets):
        yield len(entries)
        for entry in entries:
            yield from entry
    yield update.code
