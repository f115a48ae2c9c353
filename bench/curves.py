"""Curves of CPU time over sizes, one small chart for each family, both axes logarithmic, as SVG."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from bench.side_by_side import FAILED
from bench.stored_runs import StoredRun

COLOURS = {"tachk": "#1f5fbf", "TChecker": "#c4630a", "TARZAN": "#2b8a5a"}
COLUMNS, WIDTH, HEIGHT = 4, 210, 150
LEFT, RIGHT, TOP, BOTTOM = 34, 12, 24, 24
LEGEND = 26
APART = 18
LOW, TICKS = 0.004, (0.01, 0.1, 1, 10)


def drawn(run: StoredRun, families: Sequence[str]) -> str:
    """The charts of some families in rows. A hollow mark is a run that did not finish: it took at least so long."""
    rows = math.ceil(len(families) / COLUMNS)
    width, height = COLUMNS * WIDTH, LEGEND + rows * HEIGHT
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif">',
        f'<rect width="{width}" height="{height}" fill="#ffffff"/>',
        *_legend([program for program in COLOURS if any(run.curve(family, program) for family in families)]),
    ]
    for number, family in enumerate(families):
        x, y = number % COLUMNS * WIDTH, LEGEND + number // COLUMNS * HEIGHT
        parts += [f'<g transform="translate({x} {y})">', *_chart(run, family), "</g>"]
    return "\n".join([*parts, "</svg>", ""])


def _text(x: float, y: float, text: str, anchor: str = "start") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="#555555" font-size="9.5">{text}</text>'


def _legend(programs: Sequence[str]) -> Iterator[str]:
    for number, program in enumerate(programs):
        x, colour = LEFT + 90 * number, COLOURS[program]
        yield f'<line x1="{x}" y1="13" x2="{x + 18}" y2="13" stroke="{colour}" stroke-width="2"/>'
        yield f'<circle cx="{x + 9}" cy="13" r="2.5" fill="{colour}"/>'
        yield _text(x + 23, 16.5, program)
    x = LEFT + 90 * len(programs)
    yield f'<circle cx="{x}" cy="13" r="3" fill="#ffffff" stroke="#555555" stroke-width="1.3"/>'
    yield _text(x + 8, 16.5, "ended unfinished")
    yield _text(x + 110, 16.5, "CPU seconds over size, both logarithmic")


def _chart(run: StoredRun, family: str) -> Iterator[str]:
    sizes = run.sizes(family)
    shift = 1 if sizes[0] < 1 else 0
    low, high = math.log(sizes[0] + shift), math.log(sizes[-1] + shift)
    top = math.log(run.seconds * 1.3)
    bottom = math.log(LOW)

    def across(size: int) -> float:
        return LEFT + (WIDTH - LEFT - RIGHT) * (math.log(size + shift) - low) / (high - low)

    def up(seconds: float) -> float:
        share = (math.log(min(max(seconds, LOW), run.seconds * 1.3)) - bottom) / (top - bottom)
        return HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * share

    yield f'<text x="{LEFT}" y="16" fill="#222222" font-size="11" font-weight="bold">{family}</text>'
    for tick in TICKS:
        height = f"{up(tick):.1f}"
        yield f'<line x1="{LEFT}" y1="{height}" x2="{WIDTH - RIGHT}" y2="{height}" stroke="#e2e2e2"/>'
        yield _text(LEFT - 5, up(tick) + 3.5, f"{tick:g}", "end")
    last = -math.inf
    for size in sizes:
        x = across(size)
        if size == sizes[-1] or (x - last >= APART and WIDTH - RIGHT - x >= APART):
            last = x
            yield _text(x, HEIGHT - BOTTOM + 13, f"{size}", "middle")
    for program, colour in reversed(COLOURS.items()):
        measured = [(size, row) for size, row in run.curve(family, program) if row.answer != FAILED]
        points = [(across(size), up(row.cpu_seconds), row.finished) for size, row in measured]
        if len(points) > 1:
            line = " ".join(f"{x:.1f},{y:.1f}" for x, y, _ in points)
            yield f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="1.8"/>'
        for x, y, done in points:
            fill = colour if done else "#ffffff"
            yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.7" fill="{fill}" stroke="{colour}" stroke-width="1.3"/>'
