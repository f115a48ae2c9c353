"""The list of mutants: small changes of meaning that some test should notice, kept in TOML files beside this module."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
FOLDER = Path(__file__).parent
_KEYS = {"id", "file", "after", "old", "new", "why", "tests", "equivalent"}


class MutantError(Exception):
    """A mutant that cannot be read, or that does not apply to the sources."""


@dataclass(frozen=True, slots=True)
class Mutant:
    """One change of one file.

    Attributes:
        area: the part of the program, the name of the file that lists the mutant.
        file: what is changed, relative to the root of the repository.
        after: a text that occurs exactly once in the file; the first ``old`` behind it is meant. Empty if ``old``
            occurs exactly once.
        why: what a user would see of such a mistake.
        tests: the nearest tests: paths for pytest, and names of C++ test programs.
        equivalent: why no test can notice it; empty if one should.
    """

    id: str
    area: str
    file: str
    after: str
    old: str
    new: str
    why: str
    tests: tuple[str, ...]
    equivalent: str

    @property
    def programs(self) -> tuple[str, ...]:
        """The C++ test programs among the tests."""
        return tuple(test for test in self.tests if "/" not in test)

    @property
    def paths(self) -> tuple[str, ...]:
        """The Python tests among the tests."""
        return tuple(test for test in self.tests if "/" in test)

    def apply(self, text: str) -> str:
        """The text with the change.

        Raises:
            MutantError: the place is not there, or not just once.
        """
        if self.after and text.count(self.after) != 1:
            raise MutantError(f"{self.id}: `after` occurs {text.count(self.after)} times in {self.file}")
        begin = text.index(self.after) + len(self.after) if self.after else 0
        place = text.find(self.old, begin)
        if place < 0 or (not self.after and text.count(self.old) != 1):
            raise MutantError(f"{self.id}: `old` occurs {text.count(self.old, begin)} times in {self.file}")
        if self.old == self.new:
            raise MutantError(f"{self.id} changes nothing")
        return text[:place] + self.new + text[place + len(self.old) :]


def load_mutants() -> list[Mutant]:
    """All mutants, area by area.

    Raises:
        MutantError: a file of the list is wrong.
    """
    found = [mutant for path in sorted(FOLDER.glob("*.toml")) for mutant in _read(path)]
    seen: set[str] = set()
    for mutant in found:
        if mutant.id in seen:
            raise MutantError(f"two mutants are called {mutant.id}")
        seen.add(mutant.id)
    return found


def _read(path: Path) -> Iterator[Mutant]:
    for entry in tomllib.loads(path.read_text(encoding="utf-8"))["mutant"]:
        unknown = entry.keys() - _KEYS
        missing = {"id", "file", "old", "new", "why", "tests"} - entry.keys()
        if unknown or missing:
            raise MutantError(f"{path.name}: {entry.get('id')}: unknown {sorted(unknown)}, missing {sorted(missing)}")
        yield Mutant(
            entry["id"],
            path.stem,
            entry["file"],
            entry.get("after", ""),
            entry["old"],
            entry["new"],
            entry["why"],
            tuple(entry["tests"]),
            entry.get("equivalent", ""),
        )
