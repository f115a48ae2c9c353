"""The names of the sources use the standard words of the field, not the words that were once invented for them."""

import ast
import functools
import re
from collections.abc import Iterator

from tests.packaging.test_structure import ROOT
from tests.support.sources import tree_of

SOURCES = (ROOT / "src" / "tachk", ROOT / "plugins")

REPLACED = {
    "spectator": "outside the cone of influence, frozen",
    "bystander": "process that only blocks",
    "unobtrusive": "liveness-preserving slice",
    "beat": "doubled edge, mark",
    "forgotten": "abstracted",
    "coarser": "abstraction, over-approximation",
    "relaxed": "over-approximation",
    "weaker": "over-approximation",
    "exchange": "transposition",
    "exchanged": "permuted",
    "team": "block, orbit",
    "ring": "cyclic orbit",
    "sketch": "coarse partition",
    "sight": "observable clocks",
    "queue": "event stream",
    "listener": "receiver",
    "crew": "thread pool",
    "harvest": "batch",
    "corridor": "path filter",
    "shelf": "hash-consed rows",
    "blueprint": "resource file",
    "asked": "arguments, request, query",
    "told": "shown, listed, reported",
    "tell": "report, print",
    "telling": "display options",
    "judging": "evaluation options",
    "offer": "enabled event, enabled step",
    "hear": "receive",
    "follower": "trace automaton, tracker",
    "twin": "counterpart, equivalent process",
    "stretch": "segment, interval",
    "course": "run, instance",
    "surrounding": "environment",
    "pace": "time-optimal trace",
    "station": "location",
    "outlook": "dependencies of a location",
    "reading": "interpretation, semantics, parse, decoder",
    "judged": "evaluated, replayed, counted",
    "carried": "payload, copied",
    "carry": "copy",
    "refusal": "rejection, diagnostic",
    "refused": "rejected, unsupported",
    "claim": "assertion, condition, clause, submitted value",
    "look": "analysis, inspection, poll",
    "looked": "explored, sampled",
    "apart": "separate, disjoint, decomposed",
    "attempt": "parse outcome, try, strategy of a portfolio",
    "heard": "received",
    "hearing": "receiving",
    "horizon": "time bound",
    "offered": "enabled, sent",
    "nobody": "no process, none",
    "somebody": "a process, some",
    "whoever": "the caller, the receiver",
    "deed": "action, effect",
    "kept": "retained, with the name of the things: rows, samples, ways",
}
"""Words that names do not contain, each with its standard words. docs/glossary.md lists those of the field."""

EXCEPTIONS = {
    "beat": "a heartbeat of DDS-XRCE",
    "beats": "heartbeats of DDS-XRCE",
    "by_beat": "heartbeats of DDS-XRCE",
    "forgotten": "samples that a client of DDS-XRCE has dropped",
    "_forgotten": "obligations that an observer drops",
    "coarser": "a parameter of a strategy: the function that makes a coarser network",
    "_exchange": "a request of DDS-XRCE and its reply",
    "SampleExchange": "a request of DDS-XRCE and its reply",
    "_exchanges": "the permutations of a certificate, whose format has this word",
    "exchanged": "a field of documented JSON",
    "_exchanged": "the image under a permutation of a certificate, whose format has this word",
    "ring": "a word of a documented output",
    "rings": "cyclic orbits of a certificate",
    "sketch": "a drawing of a template",
    "Sketch": "a drawing of a template",
    "SketchNode": "a drawing of a template",
    "SketchEdge": "a drawing of a template",
    "horizon": "how far a formula looks ahead",
    "_horizon": "how far a formula looks ahead",
    "HORIZON": "a word of a documented output",
    "listeners": "sockets, or processes behind a relay",
    "refusal": "a field of the documented Python API and of documented JSON",
    "refusals": "a field of the documented Python API",
    "asked_of_all": "a field of documented JSON",
    "Pace": "the type of a documented option",
    "pace": "a documented option, and the rate of a writer",
    "paces": "rates of writers",
}
"""Names that contain such a word with another meaning, or in a published format, each with the reason."""

ROOMS_WITHOUT_CELLS = (
    "analysis/", "engine/", "frontend/", "meaning/", "model/", "transform/", "formats/tchecker/", "formats/uppaal/",
)  # fmt: skip
"""Where scalar components of variables are slots. Cells are those of tables and sweeps, and of time in monitors."""

WITH_CELLS = {"model/grid.py": "of sweeps", "model/random_language.py": "the name of an array"}

WORD = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")


def names(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        match node:
            case (
                ast.FunctionDef(name=name)
                | ast.AsyncFunctionDef(name=name)
                | ast.ClassDef(name=name)
                | ast.arg(arg=name)
            ):
                yield name
            case ast.Name(id=name, ctx=ast.Store()) | ast.Attribute(attr=name, ctx=ast.Store()):
                yield name
            case _:
                pass


@functools.cache
def names_of_sources() -> dict[str, set[str]]:
    """The names in each file, its own among them."""
    return {
        path.relative_to(ROOT).as_posix(): {path.stem, *names(tree_of(path))}
        for folder in SOURCES
        for path in sorted(folder.rglob("*.py"))
    }


def offenders() -> Iterator[str]:
    for own, found in names_of_sources().items():
        for name in found:
            words = {word.lower().removesuffix("s") for word in WORD.findall(name)}
            has_cells = "cell" in words and own.startswith(ROOMS_WITHOUT_CELLS) and own not in WITH_CELLS
            if name not in EXCEPTIONS and (has_cells or not words.isdisjoint(REPLACED)):
                yield f"{own}: {name}"


CORE = ROOT / "src" / "core"

REPLACED_IN_CORE = {
    "ask", "asked", "attempt", "beat", "blueprint", "budget", "bystander", "carried", "corridor", "course", "crew",
    "follower", "forgotten", "harvest", "hear", "heard", "judged", "judging", "kept", "listener", "look", "looked",
    "offer", "outlook", "pace", "reading", "reception", "refusal", "refuse", "refused", "relaxed", "ring", "shelf",
    "shelves", "sight", "sketch", "somebody", "spectator", "station", "stretch", "surrounding", "team", "tell",
    "told", "twin", "unite", "united", "weaker",
}  # fmt: skip
"""Words that names of the core do not contain."""

NO_CODE = re.compile(r'//[^\n]*|"(?:\\.|[^"\\\n])*"|#include[^\n]*')


def core_offenders() -> Iterator[str]:
    for path in sorted((*CORE.rglob("*.hpp"), *CORE.rglob("*.cpp"))):
        code = NO_CODE.sub("", path.read_text(encoding="utf-8"))
        for name in {path.stem, *re.findall(r"[A-Za-z_]\w*", code)}:
            if not REPLACED_IN_CORE.isdisjoint(word.lower().removesuffix("s") for word in WORD.findall(name)):
                yield f"{path.relative_to(CORE).as_posix()}: {name}"


REPLACED_IN_TESTS = {"hear", "looked", "refusal", "refuse", "refused", "stretch", "stretche", "tell", "told", "united"}
"""Words that names of tests and of their files do not contain."""


def offenders_in_tests() -> Iterator[str]:
    for path in sorted((ROOT / "tests").rglob("*.py")):
        for name in {path.stem, *re.findall(r"^ *def (test_\w+)", path.read_text(encoding="utf-8"), re.MULTILINE)}:
            if not REPLACED_IN_TESTS.isdisjoint(word.removesuffix("s") for word in name.split("_")):
                yield f"{path.relative_to(ROOT).as_posix()}: {name}"


def test_names_use_the_words_of_the_field() -> None:
    assert sorted(offenders()) == []
    assert sorted(core_offenders()) == []
    assert sorted(offenders_in_tests()) == []


def test_every_exception_occurs() -> None:
    assert EXCEPTIONS.keys() <= set().union(*names_of_sources().values())
