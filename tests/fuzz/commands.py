"""Random command lines: the options that each command declares, with legal values and with illegal ones."""

from __future__ import annotations

from collections.abc import Mapping
from random import Random

import click

from tachk.cli.main import COMMANDS, load_command
from tests.fuzz.mutations import NUMBERS, WORDS
from tests.fuzz.readers import LIMITS, READERS, TIME
from tests.fuzz.samples import CSV, FORMULAS, MODEL, QUERIES, SMALL, SMALL_QUERIES, VCD
from tests.fuzz.worker import Case

_NUMBERS = (*NUMBERS, "nan", "inf", "-inf", "٣", "1,5", "--")
_SIZES = ("1", "1k", "10M", "2G", "1T", "9999999999T", "-1G", "1.5M", "G", "nan")
_TEXTS = ("", " ", "x", "n", "N", "safe", "dead", "P", "p", "é", "\\", "a\nb", "%s", "{}", "x" * 3000, "-", "--", "\t")
_PATHS = (
    "m.ta",
    "m.xml",
    "m.q",
    "m.csv",
    "m.vcd",
    "m.stl",
    "out.svg",
    "out.xml",
    "out",
    "gone.ta",
    "folder/out.ta",
    ".",
    "",
)
_QUERIES = (
    "E<> n == 2",
    "A[] n < 3",
    "G F[0,5] n > 0",
    "E<> deadlock",
    "A<> n",
    "sup: n",
    "E<>",
    "n = 1",
    "true",
    "E<> t[9] > 0",
)
_DEFINITIONS = ("N=2", "N=-1", "N=1/0", "N", "=3", "M=1", "N=2147483648", "N=n", "N=é", "N=1 2", "n=1", "N=N", "t={1}")
_FORMULAS = (
    "G p",
    "F[0,3] q",
    "G (x < 2 -> F[0,1] y > 0)",
    "p U[1,2] q",
    "sound",
    "E0214",
    "E9999",
    "G[5,1] p",
    "rise(",
)
_WITHOUT_TIME = frozenset({"verify", "verifyta", "models", "completion"})
"""Commands that have `LIMITS`, or nothing that takes long."""

_OF_VERIFYTA = """
-t0 -t1 -t2 -t9 -t -y -Y -u -q -s -o0 -o1 -o2 -o5 -o7 -r1 -rx -n0 -n1 -n2 -n4 -n7 -T -S0 -S2 -A -C -H10 -Z -Ocsv -v -h
-qyt0 -uqs --version --help --summary --sum --no --query-index --query-index=0 --query-index=7 --diagnostic=1 --seed=2
--nonsense --delta-l 0 1 -fout -Xout -f -X -
""".split()  # noqa: SIM905


def random_command(random: Random) -> Case:
    """A command with some of its options; now and then with one of another command, or with words at random."""
    name = random.choice([name for name in COMMANDS if name != "xrce proxy"])  # which waits for packets
    if name == "verifyta":
        asked = random.choices(_OF_VERIFYTA, k=random.choice((0, 1, 1, 2, 3, 5)))
        words = [
            *asked,
            *random.choice((["small.xml"], ["small.xml"], ["small.xml", "small.q"], ["small.q"], ["gone.xml"])),
        ]
        if random.random() < 0.3:
            random.shuffle(words)
        return Case((name, *words), _files(), SMALL_QUERIES.encode())
    command = load_command(name)
    words: list[str] = []
    parameters = [parameter for parameter in command.params if isinstance(parameter, click.Option)]
    chosen = random.sample(parameters, min(len(parameters), random.choice((0, 1, 1, 2, 3, 5))))
    required = [parameter for parameter in parameters if parameter.required and parameter not in chosen]
    for parameter in [*chosen, *(required if random.random() < 0.9 else ())]:
        flags = [*parameter.opts, *parameter.secondary_opts]
        words.append(random.choice(flags))
        if not parameter.is_flag and random.random() < 0.95:
            words.append(_value(random, parameter))
    arguments = [parameter for parameter in command.params if isinstance(parameter, click.Argument)]
    count = sum(parameter.nargs if parameter.nargs > 0 else random.choice((1, 1, 2, 3)) for parameter in arguments)
    words += [_argument(random, name, place) for place in range(count)]
    if name == "verify" and random.random() < 0.9:
        words = [*LIMITS.split(), *words]  # the last value of an option counts
    elif name not in _WITHOUT_TIME and random.random() < 0.9:
        words = [*TIME.split(), *words]
    if random.random() < 0.08:
        words.insert(random.randrange(len(words) + 1), random.choice((*WORDS, *_TEXTS, "--help", "-x", "--nonsense=1")))
    if random.random() < 0.05:
        random.shuffle(words)
    words = [word.replace("\0", "") for word in words if word != "--follow"]
    return Case((*name.split(), *words), _files(), CSV.encode() if random.random() < 0.5 else b"")


def _files() -> Mapping[str, bytes]:
    return {
        "m.ta": MODEL.encode(),
        "small.xml": SMALL.encode(),
        "small.q": SMALL_QUERIES.encode(),
        "m.xml": READERS["UPPAAL XML"].seeds()[1],
        "m.q": QUERIES.encode(),
        "m.csv": CSV.encode(),
        "m.vcd": VCD.encode(),
        "m.stl": FORMULAS.encode(),
        "sound": b"",
    }


def _value(random: Random, option: click.Option) -> str:
    kind = option.type
    if random.random() < 0.06:
        return random.choice((*_TEXTS, *_NUMBERS))
    if isinstance(kind, click.Choice):
        return str(random.choice(list(kind.choices)))
    if kind.name in ("integer", "float", "integer range", "float range"):
        return random.choice(_NUMBERS) if random.random() < 0.5 else random.choice(("1", "2", "100", "5000"))
    if isinstance(kind, click.Path):
        return random.choice(_PATHS)
    label = (option.metavar or option.name or "").upper()
    if "SIZE" in label:
        return random.choice(_SIZES)
    if "FILE" in label or "DIR" in label:
        return random.choice(_PATHS)
    if "EXPR" in label:
        return random.choice(_DEFINITIONS)
    return random.choice((*_TEXTS, *_NUMBERS))


def _argument(random: Random, command: str, place: int) -> str:
    if random.random() < 0.06:
        return random.choice((*_TEXTS, *_PATHS))
    if command == "verify":
        return random.choice(("m.ta", "m.ta", "m.ta", "m.xml", *_QUERIES)) if place else "m.ta"
    if command in ("monitor", "plot"):
        return random.choice((*_FORMULAS, "m.stl", "m.ta") if place == 0 else ("m.csv", "m.csv", "m.vcd", "-"))
    if command in ("models", "completion"):
        return random.choice(("fischer", "classics", "bash", "zsh", "fish", "out", *_TEXTS))
    if command == "sentences":
        return random.choice(("within", "always", "never", *_TEXTS))
    return random.choice((*_FORMULAS, "m.stl", "m.ta") if command == "explain" else ("m.ta", "m.ta", "m.xml", *_PATHS))
