"""Every reader of tachk: the files that it is given, how they are damaged, and the commands that read them."""

from __future__ import annotations

import gzip
import json
import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from random import Random

from tachk.base.resources import data_root
from tachk.cli.arguments import parse_size
from tests.fuzz import mutations, recordings
from tests.fuzz.mutations import Damage
from tests.fuzz.samples import (
    CSV,
    DIMMER,
    FORMULAS,
    LAMP,
    LINES,
    MODEL,
    PRESSED,
    PRESSED_LINES,
    QUERIES,
    QUEUE,
    REQUIREMENTS,
    RULES,
    RUN,
    RUNS,
    SHEET,
    SMALL,
    SMALL_QUERIES,
    SMALL_TEXT,
    STATISTICAL,
    STRINGS,
    TYPED,
    VCD,
)
from tests.fuzz.worker import Case, results
from tests.unit.xrce.proxy.test_counterexample import STALE

SECONDS, MEMORY = "1", "200M"
TIME = f"--max-seconds {SECONDS}"
LIMITS = f"--max-states 2000 {TIME} --max-memory {MEMORY}"
LARGEST = 2**30
"""So many bytes a command may take that has no limit on memory."""
_OWN_MEMORY = 2**26
"""A limit is on the memory of a search. So many bytes come to it that hold what is read and told."""
_EACH = "requirements"
"""Its limit is on each search."""
_DATA = Path(__file__).parents[1] / "data"
_LARGEST_SEED = 30_000

BESIDE = {
    "sound.ta": MODEL.encode(),
    "sound.stl": FORMULAS.encode(),
    "sound.csv": CSV.encode(),
    "small.xml": SMALL.encode(),
    "lamp.ta": LAMP.encode(),
    "dimmer.ta": DIMMER.encode(),
    "pressed.csv": PRESSED.encode(),
    "queue.ta": QUEUE.encode(),
    "m.ta": SMALL_TEXT.encode(),
    "lamp.run": RUN.encode(),
    "importing.ta": b'import "m.ta";\nsystem P, Q;\n',
}
"""Files that are sound, for commands to read together with one that is not."""


@dataclass(frozen=True, slots=True)
class Reader:
    """What reads a kind of file.

    Attributes:
        file: the name of the damaged file.
        uses: commands that read it, divided by lines; LIMITS and TIME stand for options, FILE for the file. Behind `<`
            is what the standard input is.
        damage: makes a damaged file of a sound one.
        written: sound files that are written here.
        made: commands that make further ones, into FILE.
        warms: whether its sound files may be read before any child begins: nothing that reads them starts threads.
    """

    name: str
    file: str
    uses: str
    damage: Damage = mutations.text
    written: Callable[[], Sequence[bytes]] = tuple
    made: str = ""
    beside: Mapping[str, bytes] = field(default_factory=lambda: BESIDE)
    warms: bool = False

    def case(self, random: Random, seeds: Sequence[bytes]) -> Case:
        """A command over a damaged file."""
        damaged = self.damage(random, random.choice(seeds))
        use = random.choice(_lines(self.uses))
        return self._case(use, damaged)

    def sound_cases(self, seeds: Sequence[bytes]) -> list[Case]:
        """Every use of every sound file."""
        return [self._case(use, seed) for use in _lines(self.uses) for seed in seeds]

    def _case(self, use: str, content: bytes) -> Case:
        words = tuple(shlex.split(self._filled(use)))
        seconds = float(SECONDS) if not use.startswith(_EACH) and ("TIME" in use or "LIMITS" in use) else None
        memory = _OWN_MEMORY + parse_size(MEMORY) if "LIMITS" in use else LARGEST
        if words[-1] == "<":
            return Case(words[:-1], self.beside, content, seconds, memory)
        return Case(words, {**self.beside, self.file: content}, b"", seconds, memory)

    def _filled(self, command: str) -> str:
        return command.replace("LIMITS", LIMITS).replace("TIME", TIME).replace("FILE", self.file)

    def seeds(self) -> tuple[bytes, ...]:
        """Its sound files. They are made in another process, as some libraries start threads."""
        return _seeds(self.name)


@cache
def _seeds(name: str) -> tuple[bytes, ...]:
    reader = READERS[name]
    commands = [tuple(shlex.split(reader._filled(command))) for command in _lines(reader.made)]
    found = results(reader.written, commands, reader.beside, reader.file)
    assert all(found) and len(found) >= len(commands), f"{name}: a sound file is missing"
    return tuple(found)


def _lines(text: str) -> list[str]:
    return [line.strip() for line in text.splitlines() if line.strip()]


def _texts(*texts: str) -> Callable[[], Sequence[bytes]]:
    return lambda: [text.encode() for text in texts]


def _models() -> Sequence[bytes]:
    folder = data_root() / "models"
    found = [path.read_bytes() for place in ("classics", "lib") for path in sorted((folder / place).glob("*.ta"))]
    return [MODEL.encode(), LAMP.encode(), DIMMER.encode(), QUEUE.encode(), *found]


def _captures() -> Sequence[bytes]:
    paths = sorted((_DATA / "captures").glob("**/*.pcap"))
    return [content for content in (path.read_bytes() for path in paths) if len(content) <= _LARGEST_SEED]


def _serial() -> Sequence[bytes]:
    return [path.read_bytes() for path in sorted(_DATA.glob("serial*.pcap"))]


_OF_MODELS = """
check FILE
check --for uppaal-4.1 FILE
check --for uppaal-5.0 FILE
verify LIMITS FILE
verify LIMITS --format json FILE 'E<> deadlock'
convert TIME FILE out.ta
convert TIME FILE out.xml
convert TIME --fix FILE out.xta
convert TIME FILE out.json
export TIME -o out.tck FILE
export TIME -o out.xml --explain FILE
export TIME -o out.muntax FILE
export TIME -o out.dot FILE
draw TIME -o out.svg FILE
diff TIME FILE sound.ta
monitor TIME FILE sound.csv
simulate TIME --until 20 --max-steps 50 FILE -o out.jsonl
estimate TIME --runs 5 --max-steps 50 FILE
explain TIME FILE
"""
_OF_LOGS = """
monitor TIME 'G (x < 9)' FILE
monitor TIME 'G (x < 9)' FILE --interpolation linear --time-robustness
monitor TIME sound.stl FILE --format json
monitor TIME 'F s == "a"' FILE --all-violations
monitor TIME 'G[0, 2 s] (x < 9)' FILE --decimals 3
monitor TIME 'G (x < 9)' FILE sound.csv
monitor TIME 'G (x < 9)' FILE --run 0
plot TIME 'G (x < 9)' FILE -o out.svg
mine TIME 'G (x < V)' FILE --over V=-5..5
"""
_OF_EVENTS = """
conform TIME --max-states 2000 dimmer.ta FILE
conform TIME --max-states 2000 dimmer.ta FILE --coverage --explain full --tolerance auto
conform TIME --max-states 2000 dimmer.ta pressed.csv --application FILE
"""
_ONLINE = """
monitor TIME 'G (x < 9)' FILE --online
monitor TIME 'G[0, 2] (x < 9)' FILE --fail-fast
"""


def _named(*readers: Reader) -> dict[str, Reader]:
    return {reader.name: reader for reader in readers}


READERS = _named(
    # ---- models and queries
    Reader("models", "m.ta", _OF_MODELS + "fmt TIME --stdout FILE\nverify LIMITS importing.ta", written=_models),
    Reader(
        "UPPAAL XML",
        "m.xml",
        _OF_MODELS + "verifyta -u FILE\nverifyta -t0 -y FILE",
        written=_texts(SMALL),
        made="convert sound.ta FILE\nconvert lamp.ta FILE\nconvert dimmer.ta FILE\nconvert queue.ta FILE",
    ),
    Reader(
        "UPPAAL XTA",
        "m.xta",
        _OF_MODELS + "fmt TIME --stdout FILE",
        made="convert sound.ta FILE\nconvert lamp.ta FILE\nconvert small.xml FILE\nconvert queue.ta FILE",
    ),
    Reader(
        "TChecker",
        "m.tck",
        _OF_MODELS,
        made="export -o FILE small.xml\nexport -o FILE lamp.ta\nexport -o FILE dimmer.ta",
    ),
    Reader(
        "queries",
        "m.q",
        """
        verify LIMITS -q FILE sound.ta
        verify LIMITS -q FILE --format json sound.ta
        verifyta small.xml FILE
        verifyta -t0 -y -u small.xml FILE
        convert TIME FILE out.q
        convert TIME -q FILE sound.ta out.ta
        fmt --stdout FILE
        """,
        written=_texts(QUERIES, SMALL_QUERIES),
    ),
    Reader(
        "statistical queries",
        "s.q",
        """
        estimate TIME --runs 20 --max-steps 200 -q FILE queue.ta
        verify LIMITS -q FILE queue.ta
        estimate TIME --splitting --effort 20 --max-steps 200 -q FILE queue.ta
        """,
        written=_texts(STATISTICAL),
    ),
    Reader(
        "layouts",
        "m.layout.json",
        "draw TIME -o out.svg m.ta\nconvert TIME m.ta out.xml\nconvert TIME --force m.ta out.ta",
        damage=mutations.report,
        made="convert --force small.xml m.ta",
    ),
    # ---- formulas
    Reader(
        "formulas",
        "m.stl",
        """
        monitor TIME FILE sound.csv
        monitor TIME --interpolation linear FILE sound.csv
        monitor TIME --online FILE sound.csv
        monitor TIME --constants N=3 FILE sound.csv
        explain TIME FILE
        replay TIME lamp.ta --monitor FILE lamp.run
        simulate TIME --until 20 --max-steps 50 lamp.ta --monitor FILE -o out.csv
        requirements TIME FILE
        """,
        written=_texts(FORMULAS, REQUIREMENTS),
    ),
    Reader(
        "requirements",
        "r.stl",
        "requirements TIME FILE\nrequirements TIME FILE --format json\nexplain TIME FILE",
        written=_texts(REQUIREMENTS),
    ),
    # ---- recordings
    Reader("CSV", "m.csv", _OF_LOGS + _ONLINE + "monitor TIME 'G (x < 9)' - <", written=_texts(CSV, RUNS, SHEET)),
    Reader("CSV, compressed", "m.csv.gz", _OF_LOGS, mutations.compressed, lambda: [gzip.compress(CSV.encode())]),
    Reader("JSON lines", "m.jsonl", _OF_LOGS + _ONLINE, written=_texts(LINES)),
    Reader("VCD", "m.vcd", _OF_LOGS, written=_texts(VCD, STRINGS)),
    Reader(
        "MCAP",
        "m.mcap",
        _OF_LOGS.replace("x <", "a.x <") + "monitor TIME 'G (s.level != ERROR)' FILE",
        mutations.octets,
        lambda: [recordings.mcap(kind, chunked) for kind in ("NONE", "ZSTD") for chunked in (True, False)],
    ),
    Reader("Parquet", "m.parquet", _OF_LOGS, mutations.octets, lambda: [recordings.parquet()]),
    Reader(
        "HDF5",
        "m.h5",
        _OF_LOGS + "monitor TIME 'F mode == FAST' FILE\nmonitor TIME 'G (imu.gyro[0] > 0)' FILE",
        mutations.octets,
        lambda: [recordings.hdf5()],
    ),
    Reader("bags", "m.bag", _OF_LOGS.replace("x <", "x.data <"), mutations.octets, lambda: [recordings.bag()]),
    Reader(
        "captures",
        "m.pcap",
        """
        decode TIME FILE
        decode TIME --format jsonl FILE
        decode TIME --signals out.csv FILE
        decode TIME -<
        measure TIME FILE
        measure TIME --format json FILE
        monitor TIME 'G (messages < 9)' FILE
        chart TIME FILE -o out.svg
        monitor TIME 'G (lost == 0)' --live -<
        """.replace("-<", "- <"),
        mutations.octets,
        _captures,
    ),
    Reader(
        "serial lines",
        "m.serial",
        "decode TIME --serial FILE\ndecode TIME --serial --format jsonl FILE",
        mutations.octets,
        _serial,
    ),
    Reader(
        "events",
        "m.csv",
        _OF_EVENTS,
        written=_texts(PRESSED),
    ),
    Reader(
        "events in JSON lines",
        "m.jsonl",
        _OF_EVENTS,
        written=_texts(PRESSED_LINES),
    ),
    # ---- what tachk has written
    Reader(
        "runs",
        "m.run",
        """
        replay TIME lamp.ta FILE
        replay TIME --clocks lamp.ta FILE --monitor 'G (n < 3)' -o out.vcd
        simulate TIME --policy script lamp.ta FILE
        step TIME --load FILE lamp.ta
        """,
        made="simulate lamp.ta --until 20 --seed 1 -o FILE\nsimulate lamp.ta --until 30 --policy latest -o FILE",
    ),
    Reader(
        "reports of verify",
        "m.json",
        """
        replay TIME lamp.ta FILE
        step TIME --load FILE lamp.ta
        chart TIME FILE -o out.svg
        report TIME FILE -o out.html
        proxy --listen 9001 --from-trace FILE --show
        """,
        mutations.report,
        made="verify lamp.ta --format json -o FILE\nverify small.xml --format json -o FILE",
    ),
    Reader(
        "other reports",
        "m.json",
        "report TIME FILE -o out.html\nchart TIME FILE -o out.svg\nreplay TIME lamp.ta FILE",
        mutations.report,
        made="""
        sweep lamp.ta -D LIMIT=1..3 -j 1 --property few --format json -o FILE
        synthesize lamp.ta --over LIMIT=1..3 --property few --format json -o FILE
        simulate lamp.ta --until 20 --runs 3 --format json -o FILE
        estimate lamp.ta 'Pr[<=20](<> n == 2)' --runs 20 --format json -o FILE
        monitor sound.stl sound.csv --format json -o FILE
        conform dimmer.ta pressed.csv --coverage --format json -o FILE
        mine 'G (x < V)' sound.csv --over V=-5..5 --format json -o FILE
        time lamp.ta --from press! --to lit --format json -o FILE
        check --format json sound.ta -o FILE
        """,
    ),
    Reader(
        "coverage",
        "m.json",
        "draw TIME --coverage FILE dimmer.ta -o out.svg",
        mutations.report,
        made="conform dimmer.ta pressed.csv --coverage --format json -o FILE",
    ),
    Reader(
        "traces for the proxy",
        "m.json",
        "proxy --listen 9001 --listen 9002 --from-trace FILE --show",
        mutations.report,
        lambda: [json.dumps(STALE).encode()],
    ),
    Reader(
        "certificates",
        "m.cert",
        """
        certify TIME lamp.ta FILE
        certify TIME --checker native lamp.ta FILE
        certify TIME --format json lamp.ta FILE
        """,
        mutations.certificate,
        made="verify lamp.ta --certificate FILE\nverify lamp.ta 'A[] n <= 3' 'A<> n <= 3' --certificate FILE",
    ),
    Reader(
        "stores",
        "m.sqlite",
        """
        sweep TIME lamp.ta -D LIMIT=1..3 -j 1 --property few --store FILE
        sweep TIME lamp.ta -D LIMIT=1..3 -j 1 --property few --store other.sqlite --merge FILE
        sweep TIME lamp.ta -D LIMIT=1..3 -j 1 --property few --store FILE --format json
        """,
        mutations.database,
        made="sweep lamp.ta -D LIMIT=1..3 -j 1 --property few --store FILE",
    ),
    # ---- what is typed
    Reader(
        "rules of the proxy", "m.txt", "proxy --listen 9001 --listen 9002 --script FILE --show", written=_texts(RULES)
    ),
    Reader("commands of step", "typed", "step TIME lamp.ta <\nstep TIME sound.ta <", written=_texts(TYPED)),
)
"""By name."""
