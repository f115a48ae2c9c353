"""Readable names for the locations of an observer."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from tachk.logic.observer.goals import Everywhere, HeldFor, Sometime, Throughout, Was
from tachk.logic.observer.states import Seen, Settling, State, TableauTask
from tachk.syntax.rewrite import fresh_name


def location_names(states: Sequence[State], idle: State | None, taken: Collection[str]) -> dict[State, str]:
    """A name for each state that is none of the taken ones."""
    used = {*taken, "Bad"}
    names: dict[State, str] = {}
    for state in states:
        names[state] = fresh_name("Idle" if state == idle else _wanted_name(state), used)
        used.add(names[state])
    return names


def _wanted_name(state: State) -> str:
    tasks = [item for item in state if isinstance(item, TableauTask)]
    is_settling = any(isinstance(item, Settling) for item in state)
    watched = sorted((item for item in state if isinstance(item, Seen)), key=repr)
    if not tasks:
        return "Violated"
    if is_settling:
        return "Triggered"
    if watched:
        return "".join(_past_name(item) for item in watched)
    return _task_name(min(tasks, key=repr))


def _task_name(item: TableauTask) -> str:
    match item:
        case TableauTask(goal=Sometime()):
            return "Waiting"
        case TableauTask(phase="ahead"):
            return "Ahead"
        case TableauTask(phase="gap"):
            return "Gap"
        case TableauTask(phase="met"):
            return "Met"
        case TableauTask(goal=Throughout()):
            return "Waiting"
        case TableauTask(goal=Everywhere()):
            return "Holding"
        case _:
            return "Holding"


def _past_name(item: Seen) -> str:
    if isinstance(item.past, Was):
        return "After" if item.phase == "since" else "During"
    return "Held" if isinstance(item.past, HeldFor) else "Before"
