"""The report for people on the conformance of a recording."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction

from tachk.base.time_units import unit_in_text
from tachk.model.quantity import grouped
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform import Conformance
from tachk.recordings.conformance.coverage import Covered
from tachk.recordings.conformance.edits import Edit
from tachk.recordings.conformance.events import Cell, RecordedEvent
from tachk.recordings.conformance.rejection import PossibleEvent


def moment(found: Conformance, units: int | Fraction) -> str:
    """A time of the model as a time of the recording."""
    return recorded_time(found, Fraction(units) / found.streams.scale + found.streams.origin)


def recorded_time(found: Conformance, time: Fraction) -> str:
    """A time of the recording as a person reads it; nanoseconds of a capture as milliseconds."""
    if found.recording.unit == 1:
        return f"{float(time) / 1e6:.3f} ms"
    return f"{float(time):.6f}".rstrip("0").rstrip(".")


def event_text(event: RecordedEvent) -> str:
    """``light(on=1, level=7)``"""
    cells = ", ".join(f"{name}={value}" for name, value in event.cells.items() if value != "")
    return f"{event.name}({cells})"


def enabled_event_text(found: Conformance, enabled_event: PossibleEvent) -> str:
    """``sent(link=0, kind=HEARTBEAT)``: with the words that the recording has for values."""
    return _said(found, enabled_event.name, enabled_event.cells)


def _said(found: Conformance, event: str, cells: Iterable[tuple[str, Cell]]) -> str:
    names = found.streams.names
    said = ((name, names.get(name, {}).get(cell, cell) if isinstance(cell, int) else cell) for name, cell in cells)
    return f"{event}({', '.join(f'{name}={value}' for name, value in said)})"


def edit_text(found: Conformance, edit: Edit) -> str:
    """``line 4, light(on=0), had come 15 ms later``"""
    event = found.recording.events[edit.event]
    name = f"{event.place}, {event_text(event)},"
    match edit.what:
        case "lost":
            return f"{name} had been lost"
        case "doubled":
            return f"{name} had come twice"
        case "changed":
            return f"{event.place} had been {_said(found, event.name, edit.cells)}"
        case "added":
            time = event.time + edit.by / found.streams.scale
            return f"{_said(found, edit.name, edit.cells)} had come, too, at {recorded_time(found, time)}"
        case _:
            later = "later" if edit.by > 0 else "earlier"
            return f"{name} had come {units_text(Fraction(abs(edit.by)), found.time_unit)} {later}"


def units_text(amount: Fraction, unit: str) -> str:
    """An amount of units of the model."""
    factor, name = unit_in_text(unit)
    return f"{float(amount * factor):.10g} {name}".rstrip()


def uncertainty_text(uncertainty: TimestampUncertainty, unit: str) -> str:
    """``tolerance 5 ms, late 20 ms``, or ``tolerance 5 ms, late input 1 ms, late output 20 ms``"""
    amounts = {"tolerance": uncertainty.tolerance}
    if uncertainty.input_late == uncertainty.output_late:
        amounts |= {"late": uncertainty.late}
    else:
        amounts |= {"late input": uncertainty.input_late, "late output": uncertainty.output_late}
    return ", ".join(f"{name} {units_text(amount, unit)}" for name, amount in amounts.items())


def conformance_to_text(found: Conformance, model: str) -> str:
    """The answer, and where the recording leaves the model."""
    return "\n".join(_lines(found, model)) + "\n"


def _lines(found: Conformance, model: str) -> Iterator[str]:
    recording = found.recording
    count = len(recording.events) - found.streams.other
    yield f"{recording.source}: {grouped(count)} {'event' if count == 1 else 'events'} of {model}"
    if found.streams.other:
        other = found.streams.other
        yield f"{grouped(other)} other {'event is' if other == 1 else 'events are'} of no kind that the model contains"
    unit = found.time_unit
    allowed = uncertainty_text(found.uncertainty, unit)
    match found.accepted:
        case True:
            yield f"a run of the model, with {allowed}"
        case False:
            yield f"not a run of the model, with {allowed}"
            yield from rejection_lines(found)
            if found.edit is not None:
                yield f"it would be a run if {edit_text(found, found.edit)}"
            elif found.refusal is not None and found.refusal.event is not None and not found.left_out:
                tried = f"; {grouped(found.untried)} were not tried, see --explain full" if found.untried else ""
                yield f"no edit of a single event near it was found that would make it a run{tried}"
            if found.left_out:
                yield f"the time limit was over before it was known {found.left_out}"
        case None:
            yield f"undecided, with {allowed}: {found.reason}"
            yield from rejection_lines(found)
    yield f"{grouped(found.statistics.states_stored)} states in {found.statistics.seconds:.2f} s"


def coverage_to_text(covered: Sequence[Covered]) -> str:
    """For each process how many of its edges were taken, and which were not."""
    lines = []
    for process in dict.fromkeys(each.process for each in covered):
        own = [each for each in covered if each.process == process]
        lines.append(f"{process}: {sum(each.times > 0 for each in own)} of {len(own)} edges taken")
        never = (each for each in own if not each.times)
        lines += [f"  never {e.source} -> {e.target}" + (f" · {e.doc}" if e.doc else "") for e in never]
    return "\n".join(lines) + "\n"


def rejection_lines(found: Conformance) -> Iterator[str]:
    rejection = found.refusal
    if rejection is None:
        return
    happened = rejection.happened
    yield f"the longest run goes along with {grouped(happened)} of them"
    if rejection.event is None:
        yield "after the last event the model does something that was not recorded"
    else:
        event = found.recording.events[rejection.event]
        yield f"it leaves the model at {event.place}, at {recorded_time(found, event.time)}: {event_text(event)}"
    if rejection.state:
        yield f"  there the model is in {rejection.state}"
    for enabled_event in rejection.enabled_events:
        window = f"from {moment(found, enabled_event.earliest)}"
        if enabled_event.latest is not None:
            window += f" to {moment(found, enabled_event.latest)}"
        yield f"  the model allows {enabled_event_text(found, enabled_event)}, {window}"
    if not rejection.enabled_events and rejection.enabled_complete:
        yield "  the model allows no event there"
    if not rejection.enabled_complete:
        yield "  there may be other events that the model allows: it can go on in too many ways to look at all"
