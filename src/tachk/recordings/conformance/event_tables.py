"""Files of events: a table (CSV) with a row for each event, or JSON lines."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator, Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.exact_numbers import exact_number
from tachk.base.time_units import NANOSECONDS, SPELLINGS
from tachk.recordings.conformance.events import END, Cell, EventLog, RecordedEvent
from tachk.recordings.traces.compressed import COMPRESSED_SUFFIXES, open_bytes, plain_suffix, torn
from tachk.recordings.traces.csv_beginning import SEPARATORS, declared_separator
from tachk.recordings.traces.trace_files import CSV, FORMATS, JSON_LINES

TIME, NAME, ID, AFTER = "time", "event", "id", "after"
"""The columns with a meaning of their own. All others are what events say."""
_LONGEST = 100
"""So many characters a time has at most."""
"""Nothing that is measured has such a one, and numbers with it fill the memory."""


def read_events(path: Path, unit: str | None = None) -> EventLog:
    """The events of a file; the system is started at time 0 of the file.

    Args:
        unit: of the times; None: as the header says, ``time [ms]``, else units of the model.

    Raises UsageError, with the line, for what cannot be read.
    """
    rows = _json_rows(path, _text(path)) if _is_json(path) else _csv_rows(path, _text(path))
    events: list[RecordedEvent] = []
    known: dict[str, int] = {}
    for line, row in rows:
        place = f"line {line}"
        cells = {_bare(name)[0]: value for name, value in row.items()}
        given = next((_bare(name)[1] for name in row if _bare(name)[0] == TIME), "")
        unit = unit or given or None
        time = _number(cells.pop(TIME, ""), path, place)
        if events and time < events[-1].time:
            raise UsageError(f"{path}, {place}: time goes backwards", "sort the events by time")
        name = str(cells.pop(NAME, "")).strip()
        if not name:
            raise UsageError(f"{path}, {place}: the event has no name", f"the column `{NAME}` names what happened")
        own, after = str(cells.pop(ID, "")).strip(), str(cells.pop(AFTER, "")).strip()
        if after and after not in known:
            raise UsageError(f"{path}, {place}: no event before this one has the id `{after}`")
        if own:
            known[own] = len(events)
        events.append(RecordedEvent(time, name, cells, place, known[after] if after else None))
    end = events[-1].time if events else Fraction(0)
    return EventLog(str(path), tuple(events), _length(unit, path), Fraction(0), end)


def event_rows(recording: EventLog, nanoseconds: Fraction | None) -> Iterator[str]:
    """The lines of a file of events (.jsonl) that `read_events` reads as this recording.

    Args:
        nanoseconds: of a unit of the recording's times; None: the file has these units, too.
    """
    column, length = (TIME, Fraction(1)) if nanoseconds is None else (f"{TIME} [ns]", nanoseconds)

    def row(time: Fraction, name: str, cells: Mapping[str, Cell]) -> str:
        written = time * length
        exact = int(written) if written.denominator == 1 else float(written)
        return json.dumps({column: exact, NAME: name, **cells}) + "\n"

    for event in recording.events:
        yield row(event.time, event.name, event.cells)
    yield row(recording.end, END, {})


def _is_json(path: Path) -> bool:
    """True if a file of this name has JSON lines. Raises UsageError where it has neither these nor CSV."""
    suffix = plain_suffix(path)
    if suffix in JSON_LINES.suffixes:
        return True
    other = next((each for each in FORMATS if suffix in each.suffixes and each not in (CSV, JSON_LINES)), None)
    if other is None:
        return False
    known = ", ".join((*CSV.suffixes, *JSON_LINES.suffixes))
    raise UsageError(
        f"{path}: events are read from CSV, JSON lines and captures of packets that are not compressed",
        f"files of events end with {known}, and {' or '.join(COMPRESSED_SUFFIXES)} behind it where they are compressed",
    )


def _text(path: Path) -> str:
    """Raises UsageError. A missing end is an error: silence counts where events are held against a model."""
    try:
        with open_bytes(path) as stream:
            content = stream.read()
            reason = torn(stream)
        text = content.decode("utf-8-sig")
    except FileNotFoundError:
        raise UsageError(f"there is no file {path}") from None
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError as error:
        raise UsageError(f"{path} cannot be read: {error}") from None
    if reason is not None:
        raise UsageError(f"{path} is cut off: {reason}", "a recording without its end is not a run of the model")
    return text


def _bare(name: str) -> tuple[str, str]:
    """The name of a column, and the unit behind it: ``time [ms]``."""
    head, bracket, unit = name.partition("[")
    return head.strip(), unit.rstrip("] ").strip() if bracket else ""


def _length(unit: str | None, path: Path) -> Fraction | None:
    if unit is None:
        return None
    spelled = SPELLINGS.get(unit.lower())
    if spelled is None:
        raise UsageError(f"{path}: `{unit}` is not a unit of time", f"one of {', '.join(NANOSECONDS)}")
    return Fraction(NANOSECONDS[spelled])


def _number(cell: Cell, path: Path, place: str) -> Fraction:
    text = str(cell).strip()
    try:
        return exact_number(text)
    except ValueError:
        raise UsageError(
            f"{path}, {place}: `{text[:_LONGEST]}` is not a time", f"the column `{TIME}` has a number"
        ) from None


def _csv_rows(path: Path, text: str) -> Iterator[tuple[int, Mapping[str, Cell]]]:
    lines = text.splitlines()
    declared = declared_separator(lines[0]) if lines else None
    header = lines[0 if declared is None else 1 :]
    separator = declared or (max(SEPARATORS, key=header[0].count) if header else ",")
    reader = csv.reader(lines if declared is None else ["", *header], delimiter=separator)
    if declared is not None:
        next(reader)  # an empty line, so that lines keep their numbers
    try:
        yield from _rows(path, reader)
    except csv.Error as error:
        raise UsageError(f"{path}, line {reader.line_num}: {error}") from None


def _rows(path: Path, reader: Any) -> Iterator[tuple[int, Mapping[str, Cell]]]:
    header = next(reader, None)
    if header is None or TIME not in [_bare(name)[0] for name in header]:
        raise UsageError(f"{path} has no column `{TIME}`", f"the first line names the columns: {TIME},{NAME},...")
    for row in reader:
        if not row:
            continue
        if len(row) != len(header):
            message = f"{path}, line {reader.line_num}: {len(row)} cells, but the header names {len(header)} columns"
            raise UsageError(message)
        yield reader.line_num, dict(zip(header, row, strict=True))


def _json_rows(path: Path, text: str) -> Iterator[tuple[int, Mapping[str, Cell]]]:
    for line, content in enumerate(text.splitlines(), start=1):
        if not content.strip():
            continue
        try:
            row = json.loads(content)
        except json.JSONDecodeError as error:
            raise UsageError(f"{path}, line {line}: this is not a JSON: {error}") from None
        except (ValueError, RecursionError):
            message = f"{path}, line {line}: this has a number of too many digits, or too many brackets in each other"
            raise UsageError(message) from None
        if not isinstance(row, dict):
            raise UsageError(f"{path}, line {line}: an event is an object with the names of its columns")
        yield line, {name: _cell(value, path, line) for name, value in row.items()}


def _cell(value: object, path: Path, line: int) -> Cell:
    match value:
        case None:
            return ""
        case bool():
            return int(value)
        case int() | str():
            return value
        case float():
            return repr(value)
        case _:
            raise UsageError(f"{path}, line {line}: a column holds a number, a name or a truth value")
