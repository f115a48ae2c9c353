"""The part of docs/performance.md that a stored run gives: tables and curves of families, and where tachk loses."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

from bench.curves import drawn
from bench.families import GROUPS
from bench.side_by_side import FAILED, GIVEN_UP, ONCE, OUT_OF_MEMORY, OUT_OF_TIME, Row
from bench.stored_runs import NOTICED, StoredRun, best_peer, growth, is_won, losses, per_state, undecided, wins_from

PEERS = ("TChecker", "TARZAN")


def picture_name(title: str) -> str:
    words = title.lower().replace("'s", "").split()
    return f"families_{words[0] if words[0] != 'models' else 'own'}.svg"


def pictures(run: StoredRun) -> dict[str, str]:
    """The curves of each group: file names and SVG."""
    return {picture_name(title): drawn(run, _varied(run, group)) for title, group in _measured(run).items()}


def _measured(run: StoredRun) -> dict[str, list[str]]:
    """The groups with their families, as far as the run has them."""
    found = {title: [family for family in group if run.sizes(family)] for title, group in GROUPS.items()}
    return {title: families for title, families in found.items() if families}


def _varied(run: StoredRun, families: Sequence[str]) -> list[str]:
    return [family for family in families if len(run.sizes(family)) > 1]


def blocks(run: StoredRun) -> dict[str, str]:
    """By name what stands between `<!-- NAME: begin -->` and `<!-- NAME: end -->`."""
    return {"families": "\n".join(_overview(run)), "sizes": "\n".join(_all_sizes(run))}


def replaced(text: str, new: dict[str, str]) -> str:
    """A page with new blocks. Raises ValueError if a marker is missing."""
    for name, block in new.items():
        begin, end = f"<!-- {name}: begin -->\n", f"<!-- {name}: end -->"
        start = text.index(begin) + len(begin)
        text = f"{text[:start]}\n{block}\n\n{text[text.index(end) :]}"
    return text


def write(run: StoredRun, path: Path) -> None:
    path.write_text(replaced(path.read_text(encoding="utf-8"), blocks(run)), encoding="utf-8")
    for name, svg in pictures(run).items():
        (path.parent / "images" / name).write_text(svg, encoding="utf-8")


def _overview(run: StoredRun) -> Iterator[str]:
    measured = [family for group in _measured(run).values() for family in group]
    cap = f"{run.seconds:g} s of CPU time" + (f" and {run.gigabytes:g} GB of address space" if run.gigabytes else "")
    yield f"Measured on {run.date[:10]} at commit {run.commit}, on an {run.machine}: {', '.join(run.names())}."
    yield f"Each run may take {cap}; medians of {run.repeat}, single runs where one takes more than {ONCE:g} s."
    for title, group in _measured(run).items():
        yield from ("", f"### {title}", "")
        yield from _summary(run, group)
        if _varied(run, group):
            yield from ("", f"![CPU seconds over sizes]({'images/' + picture_name(title)})")
    yield from ("", "### Where tachk loses", "")
    yield from _losses(run, measured)
    yield from ("", "### CPU time a state", "")
    yield from _growth(run, measured)


def _all_sizes(run: StoredRun) -> Iterator[str]:
    yield "`>` stands before the CPU time at which a run was ended, `memory` where it wanted too much, and `error`"
    yield "where it ended without an answer: TChecker asks for much memory at once."
    for title, group in _measured(run).items():
        yield from ("", f"### {title}, size by size", "")
        yield from _instances(run, group)


def _summary(run: StoredRun, families: Sequence[str]) -> Iterator[str]:
    yield "| family | sizes | tachk wins from | tachk up to | TChecker up to | TARZAN up to | largest that two decide |"
    yield "|---|---|---|---|---|---|---|"
    for family in families:
        sizes = run.sizes(family)
        first = wins_from(run, family)
        decided = [_largest(run, family, program) for program in ("tachk", *PEERS)]
        told = f"{sizes[0]} to {sizes[-1]}" if len(sizes) > 1 else f"{sizes[0]}"
        cells = (family, told, "-" if first is None else first, *decided, _at_largest(run, family))
        yield "| " + " | ".join(str(cell) for cell in cells) + " |"


def _largest(run: StoredRun, family: str, program: str) -> str:
    """The largest size that a program decides."""
    curve = run.curve(family, program)
    if not curve:
        return "no words"
    done = [size for size, row in curve if row.finished]
    return f"{done[-1]}" if done else "none"


def _at_largest(run: StoredRun, family: str) -> str:
    """The CPU times where both tachk and another program decide."""
    for size in reversed(run.sizes(family)):
        rows = run.of(family, size)
        best, ours = best_peer(rows), rows.get("tachk")
        if best is not None and ours is not None and ours.finished:
            return f"{size}: {_seconds(ours)} s, {best.program.split()[0]} {_seconds(best)} s"
    return ""


def _losses(run: StoredRun, families: Sequence[str]) -> Iterator[str]:
    if open_rows := undecided(run, families):
        told = ", ".join(f"{row.family} {row.size} ({row.answer})" for row in open_rows)
        yield f"tachk does not decide {told}."
        yield ""
    found = losses(run, families)
    if not found:
        yield f"Nowhere where it takes more than {NOTICED:g} s."
        return
    yield f"Instances in which tachk takes more than {NOTICED:g} s of CPU time, and another program less than tachk."
    yield from ("", "| family | size | tachk, CPU s | the best other | CPU s | times |", "|---|---|---|---|---|---|")
    for loss in sorted(found, key=lambda loss: -loss.factor):
        factor = "" if math.isinf(loss.factor) else f"{loss.factor:.1f}"
        other = f"{loss.best.program.split()[0]} {loss.best.setting}"
        cells = (loss.family, loss.size, _seconds(loss.ours), other, _seconds(loss.best), factor)
        yield "| " + " | ".join(str(cell) for cell in cells) + " |"


def _growth(run: StoredRun, families: Sequence[str]) -> Iterator[str]:
    yield "CPU microseconds of the whole process a stored state: at the largest size, and at the size whose number of"
    yield "states is nearest to a tenth."
    yield from ("", "| family | size | stored | CPU µs / stored | smaller | stored | CPU µs / stored | factor |")
    yield "|---|---|---|---|---|---|---|---|"
    for family in families:
        if (found := growth(run, family)) is None:
            continue
        cells = (
            family, found.large.size, f"{found.large.stored:,}", _micro(found.large), found.small.size,
            f"{found.small.stored:,}", _micro(found.small), f"{found.factor:.2f}",
        )  # fmt: skip
        yield "| " + " | ".join(str(cell) for cell in cells) + " |"


def _micro(row: Row) -> str:
    return f"{1e6 * per_state(row):,.0f}"


def _instances(run: StoredRun, families: Sequence[str]) -> Iterator[str]:
    heads = ["family", "size", "answer", "tachk s", "MB", "states", "TChecker s", "MB", "states", "algorithm"]
    heads += ["TARZAN s", "MB", "regions", "best other / tachk"]
    yield "| " + " | ".join(heads) + " |"
    yield "|---" * len(heads) + "|"
    for family in families:
        for size in run.sizes(family):
            rows = run.of(family, size)
            answers = [row.answer for row in rows.values() if row.finished]
            tchecker = rows.get("TChecker")
            cells = [family, f"{size}", answers[0] if answers else "", *_cells(rows.get("tachk")), *_cells(tchecker)]
            cells += [
                tchecker.setting if tchecker is not None and tchecker.finished else "",
                *_cells(rows.get("TARZAN")),
            ]
            best, ours = best_peer(rows), rows.get("tachk")
            ratio = ""
            if best is not None and ours is not None and ours.finished:
                ratio = f"{best.cpu_seconds / ours.cpu_seconds:.2g}"
                ratio = ratio if is_won(rows) else f"**{ratio}**"
            yield "| " + " | ".join([*cells, ratio]) + " |"


def _cells(row: Row | None) -> tuple[str, str, str]:
    """CPU seconds, MB and states of one program."""
    if row is None:
        return "", "", ""
    megabytes = f"{row.memory / 1e6:.0f}" if row.memory else ""
    return _seconds(row), megabytes, f"{row.stored:,}" if row.finished else ""


def _seconds(row: Row) -> str:
    if row.answer in (OUT_OF_TIME, GIVEN_UP):
        return f"> {math.floor(row.cpu_seconds)}"
    if row.answer == OUT_OF_MEMORY:
        return "memory"
    return f"{row.cpu_seconds:.2f}" if row.finished else "error" if row.answer == FAILED else row.answer
