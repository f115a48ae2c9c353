"""``python -m tests.mutation.run [IDS] [--area AREA]``: do the tests notice the mutants?

Each mutant is applied to a copy of the sources in ``build/mutation``; the checkout is never changed. A result stays
valid until the file that is changed, the mutant or one of its tests changes: a run that was stopped goes on where it
was.
"""

from __future__ import annotations

import argparse
import hashlib
import sys
import time
from collections.abc import Iterable, Sequence
from pathlib import Path

from tests.mutation.mutants import Mutant, MutantError, applies, load_mutants
from tests.mutation.places import ROOT
from tests.mutation.results import KILLED, SURVIVED, TIMEOUT, Result, read_results, summary, write_result
from tests.mutation.workspace import OutOfTimeError, Workspace, WorkspaceError


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.mutation.run", description=__doc__)
    parser.add_argument("ids", nargs="*", metavar="ID", help="these mutants only, or all whose id begins so")
    parser.add_argument("--area", action="append", default=[], help="the mutants of this area; may be repeated")
    parser.add_argument("--fresh", action="store_true", help="run mutants again whose result is still valid")
    parser.add_argument("--summary", action="store_true", help="only print the table of the results so far")
    parser.add_argument("--folder", type=Path, default=ROOT / "build" / "mutation", help="where copy and results are")
    given = parser.parse_args(arguments)
    mutants = load_mutants()
    chosen = [
        mutant
        for mutant in mutants
        if (not given.ids or any(mutant.id.startswith(name) for name in given.ids))
        and (not given.area or mutant.area in given.area)
    ]
    if not chosen:
        parser.error("there is no such mutant")
    folder = given.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    log = folder / "results.jsonl"
    stale = [mutant.id for mutant in chosen if not applies(mutant)]
    if stale:
        print(f"no longer applies: {' '.join(stale)}")
    chosen = [mutant for mutant in chosen if mutant.id not in stale]
    if given.summary:
        print(summary(chosen, read_results(log)))
        return 0
    try:
        found = _run(chosen, folder, log, fresh=given.fresh)
    except WorkspaceError as error:
        parser.error(str(error))
    print(f"\n{summary(chosen, found)}")
    unexpected = [m.id for m in chosen if (found[m.id].fate not in (KILLED, TIMEOUT)) != bool(m.equivalent)]
    if unexpected:
        print(f"\nnot as the list says: {' '.join(unexpected)}")
    return 1 if unexpected else 0


def _run(chosen: Sequence[Mutant], folder: Path, log: Path, *, fresh: bool) -> dict[str, Result]:
    before = read_results(log)
    found: dict[str, Result] = {}
    waiting: list[tuple[Mutant, str]] = []
    for mutant in chosen:
        digest = _digest(mutant)
        if not fresh and mutant.id in before and before[mutant.id].is_valid_for(digest):
            found[mutant.id] = before[mutant.id]
        else:
            waiting.append((mutant, digest))
    if not waiting:
        return found
    print(f"{len(found)} results are still valid, {len(waiting)} mutants to run", flush=True)
    # What takes seconds first, headers last, and one C++ file after the other, so that little is compiled twice.
    order = (".py", ".cpp", ".hpp")
    waiting.sort(key=lambda entry: (order.index(Path(entry[0].place().path).suffix), entry[0].place().path))
    trial = _Trial(Workspace(ROOT, folder / "tree"))
    while waiting:
        batch, waiting = waiting[:BATCH], waiting[BATCH:]
        results = [trial.run(mutant, digest) for mutant, digest in batch]
        trial.confirm(result.by for result in results if result.fate == KILLED)
        for entry, result in zip(batch, results, strict=True):
            if result.fate == KILLED and result.by in trial.failing:
                waiting.append(entry)
            else:
                found[result.id] = result
                write_result(log, result)
    return found


BATCH = 10
"""After so many mutants the tests that failed are run without a mutant: those that fail again do not count."""


class _Trial:
    """Tries mutants in a copy of the sources.

    Attributes:
        sound: tests that pass without a mutant.
        failing: tests that do not; they are left out.
    """

    def __init__(self, workspace: Workspace) -> None:
        self.workspace = workspace
        self.sound: set[str] = set()
        self.failing: set[str] = set()

    def run(self, mutant: Mutant, digest: str) -> Result:
        """What becomes of a mutant."""
        begin = time.monotonic()
        fate, by = self._fate(mutant)
        result = Result(mutant.id, digest, fate, by, round(time.monotonic() - begin, 1))
        print(f"{mutant.id:<6} {mutant.area:<14} {fate:<14} {result.seconds:6.1f} s  {by}", flush=True)
        return result

    def _fate(self, mutant: Mutant) -> tuple[str, str]:
        try:
            file = mutant.place().path
            text = mutant.apply((self.workspace.folder / file).read_text(encoding="utf-8"))
            with self.workspace.changed(file, text):
                programs = [name for name in mutant.programs if name not in self.failing]
                failed = self.workspace.programs(programs) if programs else []
                if not failed and mutant.paths:
                    failed = self.workspace.pytest(mutant.paths, self.failing)
        except MutantError as error:
            return "does not apply", str(error)
        except OutOfTimeError:
            return TIMEOUT, "the limit of time"
        except WorkspaceError as error:
            return "cannot run", str(error).replace("\n", " ")[-300:]
        return (KILLED, failed[0]) if failed else (SURVIVED, mutant.equivalent)

    def confirm(self, tests: Iterable[str]) -> None:
        """Notes which tests pass without a mutant."""
        new = sorted(set(tests) - self.sound - self.failing)
        paths = [name for name in new if "/" in name]
        failed = [name for name in new if name not in paths and self.workspace.programs([name])]
        failed += self.workspace.pytest(paths, to_the_end=True) if paths else []
        self.failing.update(failed)
        self.sound.update(name for name in new if name not in failed)
        for name in failed:
            print(f"fails without a mutant, does not count: {name}", flush=True)


def _digest(mutant: Mutant) -> str:
    """Of all that the result depends on in the first place."""
    file = mutant.place().path
    hashed = hashlib.sha256(repr((mutant.function, mutant.old, mutant.new, mutant.tests)).encode())
    for name in (file, *mutant.tests):
        path = ROOT / name.split("::")[0] if "/" in name else next((ROOT / "tests" / "core").rglob(f"{name}.cpp"))
        for file in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
            hashed.update(file.read_bytes() if file.is_file() else b"")
    return hashed.hexdigest()[:16]


if __name__ == "__main__":
    sys.exit(main())
