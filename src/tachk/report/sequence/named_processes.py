"""The processes that a property names, and the locations of theirs: in a chart they say why it holds or fails."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

_MEMBER = re.compile(r"([A-Za-z_]\w*)((?:\s*[(\[][^()\[\]]*[)\]])*)\s*\.\s*([A-Za-z_]\w*)")
_VARIABLE = re.compile(r"[A-Za-z_]")
_BLANK = re.compile(r"\s+")


def named_members(query: str, processes: Iterable[str]) -> dict[str, frozenset[str]]:
    """The members of processes in a property, by process: locations, or variables.

    A name with a variable as its argument, as in ``forall (i : id_t) P(i).critical``, stands for all instances.
    """
    found: dict[str, set[str]] = {}
    wanted = list(_members(query))
    for process in processes:
        template = re.split(r"[(\[]", process)[0]
        for name, arguments, member in wanted:
            if name + arguments == process or (name == template and _VARIABLE.search(arguments)):
                found.setdefault(process, set()).add(member)
    return {process: frozenset(members) for process, members in found.items()}


def _members(query: str) -> Iterator[tuple[str, str, str]]:
    for name, arguments, member in _MEMBER.findall(query):
        yield name, _BLANK.sub("", arguments), member
