"""The list of mutants: small changes of meaning that some test should notice, kept in TOML files beside this module."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tests.mutation.places import ROOT, Place, functions, spans

FOLDER = Path(__file__).parent
_KEYS = {"id", "function", "old", "new", "why", "tests", "equivalent"}


class MutantError(Exception):
    """A mutant that cannot be read, or that does not apply to the sources."""


@dataclass(frozen=True, slots=True)
class Mutant:
    """One change of one function.

    Attributes:
        area: the part of the program, the name of the file that lists the mutant.
        function: what is changed: ``function``, ``Class.method`` or, in C++, ``Class::method``, in whichever file.
        old: tokens that occur once in the functions of that name.
        why: what a user would see of such a mistake.
        tests: the nearest tests: paths for pytest, and names of C++ test programs.
        equivalent: why no test can notice it; empty if one should.
    """

    id: str
    area: str
    function: str
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

    def place(self) -> Place:
        """Where the tokens stand.

        Raises:
            MutantError: the function is not there, or the tokens are not, or not just once.
        """
        found = []
        for whole in functions().get(self.function, ()):
            text = (ROOT / whole.path).read_text(encoding="utf-8")[whole.begin : whole.end]
            for begin, end in spans(text, Path(whole.path).suffix, self.old):
                found.append(Place(whole.path, whole.begin + begin, whole.begin + end))
        if len(found) != 1:
            raise MutantError(f"{self.id}: `old` occurs {len(found)} times in {self.function}")
        return found[0]

    def apply(self, text: str) -> str:
        """The text of the file with the change.

        Raises:
            MutantError: it does not apply.
        """
        place = self.place()
        return text[: place.begin] + self.new + text[place.end :]


def applies(mutant: Mutant) -> bool:
    """Whether the sources still have what a mutant changes."""
    try:
        mutant.place()
    except MutantError:
        return False
    return True


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
        missing = _KEYS - {"equivalent"} - entry.keys()
        if unknown or missing:
            raise MutantError(f"{path.name}: {entry.get('id')}: unknown {sorted(unknown)}, missing {sorted(missing)}")
        yield Mutant(
            entry["id"],
            path.stem,
            entry["function"],
            entry["old"],
            entry["new"],
            entry["why"],
            tuple(entry["tests"]),
            entry.get("equivalent", ""),
        )
