"""A network that tachk has written for TChecker, as the files that TARZAN reads: one automaton a file.

TARZAN knows clocks of one automaton, integers that start at 0, urgent locations, and actions of one process or of a
sender and a receiver. `written` gives None for a network that needs more.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

_COMPARED = re.compile(r"(\w+) (<=|<|>=|>|==) (\d+)")
_NAMES = re.compile(r"[A-Za-z_]\w*")
_REMAINDER = re.compile(r"\((\w+|\([^()%]*\)) % (\d+)\)")


class _NotSaid(Exception):
    """TARZAN has no words for it."""


@dataclass(slots=True)
class _Process:
    name: str
    locations: dict[str, dict[str, str]] = field(default_factory=dict)
    edges: list[tuple[str, str, str, dict[str, str]]] = field(default_factory=list)


@dataclass(slots=True)
class _Network:
    clocks: list[str] = field(default_factory=list)
    integers: set[str] = field(default_factory=set)
    processes: dict[str, _Process] = field(default_factory=dict)


def written(network: Path, labels: str | None, folder: Path) -> tuple[str, ...] | None:
    """Writes the files into a folder that it makes.

    Args:
        labels: what TChecker looks for, as for its option -l; None: nothing, all states are gone through.

    Returns: what follows the folder on the command line of `tarzan_reach`: the goals.
    """
    try:
        read = _read(network.read_text(encoding="utf-8"))
        goals = _goals(read, labels.split(",") if labels else ())
        files = [_file(read, process) for process in read.processes.values()]
    except _NotSaid:
        return None
    same = Counter(body for _, body in files)
    groups = {body: number for number, body in enumerate(body for body, times in same.items() if times > 1)}
    folder.mkdir()
    for number, (name, body) in enumerate(files):
        symmetric = f" :: symm<{groups[body]}>" if body in groups else ""
        text = f"create automaton {name}{symmetric}\n{body}"
        (folder / f"{number:04}_{name}.txt").write_text(text, encoding="utf-8")
    return goals


def _read(text: str) -> _Network:
    network = _Network()
    for line in text.splitlines():
        kind, _, rest = line.partition(":")
        if kind == "clock":
            size, name = rest.split(":")
            _need(size == "1")
            network.clocks.append(name)
        elif kind == "int":
            size, _least, _most, first, name = rest.split(":")
            _need(size == "1" and first == "0")
            network.integers.add(name)
        elif kind == "process":
            network.processes[rest] = _Process(rest)
        elif kind == "location":
            (process,), name, attributes = _parts(rest, 2)
            _need("committed" not in attributes)
            network.processes[process].locations[name] = attributes
        elif kind == "edge":
            (process, source, target), event, attributes = _parts(rest, 4)
            network.processes[process].edges.append((source, target, event, attributes))
        elif kind == "sync":
            _need(re.fullmatch(r"\w+@\w+_send:\w+@\w+_receive", rest) is not None)
    return network


def _parts(rest: str, names: int) -> tuple[tuple[str, ...], str, dict[str, str]]:
    """Names, the last of them apart, and what stands in braces."""
    head, _, braces = rest.rstrip("}").partition("{")
    *before, last = head.split(":")
    _need(len(before) + 1 == names)
    attributes = (part.partition(":") for part in braces.split(" : "))
    return tuple(before), last, {key.strip(): value.strip() for key, _, value in attributes if key.strip()}


def _need(condition: bool) -> None:
    if not condition:
        raise _NotSaid


def _goals(network: _Network, labels: Sequence[str]) -> tuple[str, ...]:
    goals = []
    for label in labels:
        places = [
            f"{number}={name}"
            for number, process in enumerate(network.processes.values())
            for name, attributes in process.locations.items()
            if label in attributes.get("labels", "").split(",")
        ]
        _need(len(places) == 1)
        goals += places
    _need(len({goal.partition("=")[0] for goal in goals}) == len(goals))
    return tuple(goals)


def _file(network: _Network, process: _Process) -> tuple[str, str]:
    """The name, and the text after it, in which clocks have names that do not tell the process."""
    used = _used(process) & set(network.clocks)
    _need(not any(used & _used(other) for other in network.processes.values() if other is not process))
    local = {name: name.removeprefix(f"{process.name}_") for name in sorted(used, key=network.clocks.index)}
    _need(not set(local.values()) & network.integers)
    edges = [_edge(network, local, edge) for edge in process.edges]
    _need(bool(edges))
    places = []
    for name, attributes in process.locations.items():
        flags = ["ini: T" if "initial" in attributes else "ini: F", *(["urg: T"] if "urgent" in attributes else [])]
        invariant = _clock_conditions(network, local, attributes.get("invariant", ""))
        places.append(f"        {name} <{', '.join([*flags, *([f'inv: [{invariant}]'] if invariant else [])])}>")
    actions = sorted({re.sub(r"[!?]$", "", action) for action, _ in edges})
    clocks = f"{', '.join(local.values())};" if local else ""
    integers = f"    integers {{ {', '.join(sorted(network.integers))}; }}\n" if network.integers else ""
    return process.name, (
        f"{{\n    clocks {{ {clocks} }}\n    actions {{ {', '.join(actions)}; }}\n{integers}"
        f"    locations {{\n{(',' + chr(10)).join(places)};\n    }}\n"
        f"    transitions {{\n{(',' + chr(10)).join(text for _, text in edges)};\n    }}\n}}\n"
    )


def _used(process: _Process) -> set[str]:
    texts = [attributes.get("invariant", "") for attributes in process.locations.values()]
    texts += [attributes.get(key, "") for *_, attributes in process.edges for key in ("provided", "do")]
    return {name for text in texts for name in _NAMES.findall(text)}


def _edge(network: _Network, local: dict[str, str], edge: tuple[str, str, str, dict[str, str]]) -> tuple[str, str]:
    source, target, event, attributes = edge
    action = re.sub(r"_send$", "!", re.sub(r"_receive$", "?", event))
    clocks: list[str] = []
    others: list[str] = []
    for condition in _conjuncts(attributes.get("provided", "")):
        (clocks if _NAMES.search(condition) and _first_is_clock(network, condition) else others).append(condition)
    resets: list[str] = []
    updates: list[str] = []
    for update in filter(None, attributes.get("do", "").split("; ")):
        name, _, value = update.partition(" = ")
        if name in network.clocks:
            _need(name in local and value == "0")
            resets.append(local[name])
        else:
            _need(
                name in network.integers and not set(network.clocks) & set(_NAMES.findall(value)) and "?" not in value
            )
            updates.append(f"{name} = {_without_remainders(value)}")
    parts = [
        source,
        action,
        f"[{_clock_conditions(network, local, ' && '.join(clocks))}]",
        *([" && ".join(map(_on_integers, others))] if others else []),
        f"[{', '.join(resets)}]",
        *([f"[{', '.join(updates)}]"] if updates else []),
        target,
    ]
    return action, f"        ({', '.join(parts)})"


def _without_remainders(value: str) -> str:
    """The same value; TARZAN's grammar has no `%`, and the program goes on without a file that it cannot read."""
    found = _REMAINDER.sub(r"(\1 - (\2 * (\1 / \2)))", value)
    _need("%" not in found)
    return found


def _first_is_clock(network: _Network, condition: str) -> bool:
    names = _NAMES.findall(condition)
    found = [name for name in names if name in network.clocks]
    _need(not found or names == found[:1])
    return bool(found)


def _conjuncts(condition: str) -> list[str]:
    """Its parts between `&&` outside of all parentheses."""
    parts, depth, start = [], 0, 0
    for index, letter in enumerate(condition):
        depth += (letter == "(") - (letter == ")")
        if depth == 0 and condition.startswith(" && ", index):
            parts.append(condition[start:index])
            start = index + 4
    return [part for part in [*parts, condition[start:]] if part]


def _clock_conditions(network: _Network, local: dict[str, str], condition: str) -> str:
    """Bounds as TARZAN writes them; a lower and an upper one that leave one moment become `==`, on which it is good."""
    bounds: list[tuple[str, str, str]] = []
    for part in _conjuncts(condition):
        match = _COMPARED.fullmatch(part)
        _need(match is not None and match[1] in local)
        assert match is not None
        bounds.append((local[match[1]], match[2], match[3]))
    exact = {(clock, value) for clock, sign, value in bounds if sign == "<=" and (clock, ">=", value) in bounds}
    told = [bound for bound in bounds if (bound[0], bound[2]) not in exact or bound[1] not in ("<=", ">=")]
    told += sorted((clock, "==", value) for clock, value in exact)
    return ", ".join(f"({clock}, {sign}, {value})" for clock, sign, value in told)


def _on_integers(condition: str) -> str:
    """A condition in TARZAN's grammar, which has no `!=` and takes what begins with a parenthesis for a condition."""
    _need(not re.search(r"[!%?&|]", condition.replace("!=", "")))
    if " != " in condition:
        left, right = condition.split(" != ")
        return f"({left} < {right} || {left} > {right})"
    _need(re.search(r" (<=|<|>=|>|==) ", condition) is not None)
    return f"0 + {condition}" if condition.startswith("(") else condition
