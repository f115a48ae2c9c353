"""Ways to damage a file: in its octets, its words and lines, or what it tells where it has a structure of its own."""

from __future__ import annotations

import gzip
import json
import re
import sqlite3
import tempfile
import zlib
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from random import Random

import numpy as np

from tachk.meaning.judge.certificate import encoded
from tests.fuzz import reports

Damage = Callable[[Random, bytes], bytes]

WORDS = """
process location to guard sync assign init urgent committed branchpoint { } ( ) [ ] ; , : = == ! ? -> -u-> A[] E<> -->
forall exists sum property signal import gantt "x" " /* */ // /// \\ ' é € 99999999999 -1 0 1.5e3 1e999 nan inf const
int struct typedef state trans commit system < <= := =< << >> ** % / ? : chan priority default expect holds if else for
while return void clock bool meta broadcast select i:int[0,3] int[0,1000000000] a[1000000] deadlock time_unit x' imply
G F[0,5] U S W O H (1,inf) 5 s rise( change( fall( whenever must within `a b` true false 2147483647 -2147483648 not and
#0 $end $var b1x r1e5 $timescale <label <!DOCTYPE &lt; &#0; </ <nta> kind="guard" id="id0" event: edge:P:A:B:e{ sync:
""".split()  # noqa: SIM905
WORDS += ["\0", "\a", "\r", "\t", "\n", "\r\n", "\ufeff", "\u2028"]

NUMBERS = """
0 1 2 3 5 7 9 40 255 1000 -1 -5 1.5 0.1 1e3 1e308 1e309 1e-12 32767 32768 65536 1000000 1073741823 1073741824
2147483647 2147483648 4294967296 9223372036854775808 99999999999999999999 0x10 1_000 007
""".split()  # noqa: SIM905
_OPERATORS = "+ - * / % < <= == != >= > && || ! = += ? : , ; . ( ) [ ] { } & | ^ << >> imply and not -> '".split()  # noqa: SIM905
_TOKEN = re.compile(r"\d+|[A-Za-z_]\w*|[^\s\w]+")
_NUMBER = re.compile(r"\d+(\.\d+)?")

_ODD_OCTETS = [
    word.encode() for word in ("inf", "1e999", "0.30000000000000004", "1e99999999", "2" * 4400, '"', "\n", "é", ",")
]
_ODD_OCTETS += [bytes(4), bytes(8), b"\xff" * 4, b"\xff" * 8, b"\xff\xff\xff\x7f", b"\x7f\xff\xff\xff", b"\0\0\0\x80"]
_ODD_OCTETS += [b"\xff" * 7 + b"\x7f", b"\xef\xbb\xbf", b"\x01" + 7 * b"\0", b"\xff\xfe", b"\x80"]

_OPENING = ("(", "[", "{", "!", "-", "a[", "f(", "x ? 1 : ", "G (", "<a>", "{ ", '{"a": ', "not ", "1 + (")
_MANY = (300, 3000, 30_000)
_SPELLINGS = ("é", "ﬁ", "Ω", "𝕏", "٣", "\u200b", "\u202e", "\U0001f600", "\ud800", "İ", "ß", "\u0301")


# ---- octets ---------------------------------------------------------------------------------------------------------


def octets(random: Random, content: bytes) -> bytes:
    """With some octets changed, added, repeated, or left out, or cut off."""
    found = bytearray(content)
    for _ in range(random.choice((1, 1, 1, 2, 4, 8))):
        at = random.randrange(len(found) + 1)
        match random.randrange(9):
            case 0 | 1 if at < len(found):
                found[at] = random.randrange(256)
            case 2 if at < len(found):
                found[at] ^= 1 << random.randrange(8)
            case 3:
                found[at:at] = random.choice(_ODD_OCTETS)
            case 4:
                odd = random.choice(_ODD_OCTETS)
                found[at : at + len(odd)] = odd
            case 5:
                del found[at : at + random.choice((1, 4, 30))]
            case 6:
                found[at:at] = found[at : at + random.choice((8, 20, 200))]
            case 7:
                found[at:at] = random.randbytes(random.choice((1, 4, 30)))
            case 8 if random.random() < 0.5:
                del found[at:]
    return bytes(found) if random.random() < 0.998 else b""


# ---- words and lines ------------------------------------------------------------------------------------------------


def text(random: Random, content: bytes) -> bytes:
    """With some words, numbers or lines changed, or a part only; now and then with some octets changed."""
    if random.random() < 0.04:
        return octets(random, content)
    found = content.decode(errors="replace")
    if random.random() < 0.08:
        begin = random.randrange(len(found) + 1)
        found = found[begin : begin + random.randrange(1, 1500)]
    for _ in range(random.choice((1, 1, 1, 1, 1, 1, 2, 4))):
        found = random.choices(_DAMAGES, (4, 10, 3, 2, 1, 1, 0.3, 0.3, 0.1))[0](random, found) if found else found
    return found.encode(errors="surrogatepass" if random.random() < 0.5 else "replace")


def _other_word(random: Random, text: str) -> str:
    """A number becomes another one, a name another name of the text, an operator another operator."""
    tokens = list(_TOKEN.finditer(text))
    if not tokens:
        return text
    token = random.choice(tokens)
    if token[0].isdigit():
        new = random.choice(NUMBERS)
    elif token[0][0].isalpha():
        new = random.choice([other[0] for other in tokens if other[0][0].isalpha()])
    else:
        new = random.choice(_OPERATORS)
    return text[: token.start()] + new + text[token.end() :]


def _other_number(random: Random, text: str) -> str:
    numbers = list(_NUMBER.finditer(text))
    if not numbers:
        return text
    number = random.choice(numbers)
    return text[: number.start()] + random.choice(NUMBERS) + text[number.end() :]


def _other_lines(random: Random, text: str) -> str:
    lines = text.splitlines(keepends=True)
    first, second = random.randrange(len(lines)), random.randrange(len(lines))
    kind = random.randrange(3)
    if kind == 0:
        lines[first], lines[second] = lines[second], lines[first]
    elif kind == 1:
        lines.insert(first, lines[second])
    else:
        del lines[first]
    return "".join(lines) or text


def _more_words(random: Random, text: str) -> str:
    place = random.randrange(len(text) + 1)
    if random.random() < 0.7:  # at the edge of a word, so that more of it can be read
        place = next((n for n in range(place, len(text)) if not text[n].isalnum()), place)
    return f"{text[:place]} {random.choice(WORDS)} {text[place:]}"


def _less(random: Random, text: str) -> str:
    place = random.randrange(len(text))
    return text[:place] + text[place + random.choice((1, 1, 3, 20)) :] or text


def _again(random: Random, text: str) -> str:
    begin, place = random.randrange(len(text)), random.randrange(len(text) + 1)
    return text[:place] + text[begin : begin + random.choice((5, 30, 200))] + text[place:]


_DAMAGES = (_other_word, _other_number, _other_lines, _more_words, _less, _again)


def _other_spelling(random: Random, text: str) -> str:
    """A letter that is none of ASCII, or none at all."""
    place = random.randrange(len(text) + 1)
    return text[:place] + random.choice(_SPELLINGS) + text[place:]


def _nested(random: Random, text: str) -> str:
    """Many brackets that open, or operators without end."""
    place = random.randrange(len(text) + 1)
    return text[:place] + random.choice(_OPENING) * random.choice(_MANY) + text[place:]


def _many(random: Random, text: str) -> str:
    """A line or a word many times over, or a number of many digits."""
    place = random.randrange(len(text) + 1)
    lines, words = text.splitlines(keepends=True) or [text], text.split() or [text]
    repeated = random.choice((random.choice(lines), f"{random.choice(words)} ", "9", "a", " ", "\n", "0."))
    times = max(1, min(random.choice(_MANY), 200_000 // len(repeated)))
    return text[:place] + repeated * times + text[place:]


_DAMAGES = (
    _other_word,
    _other_number,
    _other_lines,
    _more_words,
    _less,
    _again,
    _other_spelling,
    _nested,
    _many,
)


# ---- structures -----------------------------------------------------------------------------------------------------


def report(random: Random, content: bytes) -> bytes:
    """JSON with other values, or without some; now and then damaged as a text."""
    if random.random() < 0.15:
        return text(random, content)
    return json.dumps(reports.damaged(random, json.loads(content)), ensure_ascii=random.random() < 0.5).encode(
        errors="surrogatepass"
    )


def compressed(random: Random, content: bytes) -> bytes:
    """With the text that was compressed damaged, or what is compressed."""
    if random.random() < 0.4:
        return octets(random, content)
    return gzip.compress(text(random, gzip.decompress(content)), 1)


def database(random: Random, content: bytes) -> bytes:
    """An SQLite file with a value, a row or a table that is wrong, or with other octets."""
    if random.random() < 0.5:
        return octets(random, content)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "store"
        path.write_bytes(content)
        database = sqlite3.connect(path)
        tables = [row[0] for row in database.execute("select name from sqlite_master where type = 'table'")]
        for _ in range(random.choice((1, 1, 2))):
            with suppress(sqlite3.DatabaseError):
                _changed(random, database, random.choice(tables))
        database.commit()
        database.close()
        return path.read_bytes()


_CELLS = (None, 0, -1, 2.5, 1e308, 2**63 - 1, "", "x", "[1", "[]", "{}", "null", "[1e999]", "[" * 3000, b"\xff", "é")


def _changed(random: Random, database: sqlite3.Connection, table: str) -> None:
    columns = [row[1] for row in database.execute(f"pragma table_info({table})")]
    column = random.choice(columns or ["none"])  # the table may have gone
    match random.randrange(6):
        case 0:
            database.execute(f"drop table {table}")
        case 1:
            database.execute(f'alter table {table} drop column "{column}"')
        case 2:
            database.execute(f"delete from {table} where random() % 2 = 0")
        case 3:
            database.execute(f'alter table {table} rename column "{column}" to other')
        case _:
            value = random.choice(_CELLS)
            database.execute(f'update {table} set "{column}" = ? where random() % 2 = 0', (value,))


def certificate(random: Random, content: bytes) -> bytes:
    """A certificate with a damaged header or block, whose lengths are right again, or with other octets."""
    if random.random() < 0.3:
        return octets(random, content)
    begin = content.index(b"\n") + 1
    parts, at = [content[:begin]], begin
    length, at = _number(content, at)
    chosen = random.randrange(4)
    header = content[at : at + length]
    header = report(random, header) if chosen == 0 else header
    parts += [encoded(np.array([len(header)])), header]
    at += length
    while True:
        length, at = _number(content, at)
        if not length:
            break
        block = content[at : at + length]
        at += length
        if random.random() < 0.7 and chosen:
            block = zlib.compress(octets(random, zlib.decompress(block)))
        parts += [encoded(np.array([len(block)])), block]
    return b"".join((*parts, b"\0", content[at:]))


def _number(content: bytes, at: int) -> tuple[int, int]:
    """A number of variable length, and where it ends."""
    value = shift = 0
    while True:
        digit = content[at]
        value += (digit & 127) << shift
        shift, at = shift + 7, at + 1
        if digit < 128:
            return value, at
