"""Contextual keywords: words that are keywords in one place and ordinary names everywhere else.

UPPAAL reserves few words, and models use the rest as names. Everything tachk adds to the language, and everything that
UPPAAL itself added late, is therefore decided here by its neighbours, in one pass over the tokens with a stack of the
open braces. A name that the text defines as a type is never taken for a keyword where a declaration could begin.
"""

from __future__ import annotations

from enum import Enum, auto
from itertools import pairwise

from tachk.base.records import dataclass
from tachk.base.span import Span
from tachk.syntax.formulas.tokens import is_sentence, is_temporal, resolve_formula
from tachk.syntax.parsing.tokens import END, Token
from tachk.syntax.parsing.unchecked import unchecked_family, words_of

SPELLING = {
    "SUM": "sum",
    "FOREACH": "foreach",
    "SPAWN": "spawn",
    "HYBRID": "hybrid",
    "ASSERT": "assert",
    "DEADLOCK": "deadlock",
    "SUP": "sup",
    "INF": "inf",
    "BOUNDS": "bounds",
    "EXPECT": "expect",
    "HOLDS": "holds",
    "FAILS": "fails",
    "PROGRESS": "progress",
    "GANTT": "gantt",
    "IMPORT": "import",
    "TIME_UNIT": "time_unit",
    "PROPERTY": "property",
    "HIDE": "hide",
    "SIGNAL": "signal",
    "PRIORITY": "priority",
    "BEFORE_UPDATE": "before_update",
    "AFTER_UPDATE": "after_update",
    "DYNAMIC": "dynamic",
    "BRANCHPOINT": "branchpoint",
    "URGENT_LOCATIONS": "urgent",
    "LOCATION": "location",
    "INIT_FLAG": "init",
    "URGENT_FLAG": "urgent",
    "COMMITTED_FLAG": "committed",
    "INVARIANT": "invariant",
    "EXPONENTIAL_RATE": "exponential_rate",
    "TO": "to",
    "UNCONTROLLABLE": "uncontrollable",
    "PROBABILITY": "probability",
    "RECORDING": "recording",
    "REPLACES": "replaces",
    "VISIBLE": "visible",
    "AS": "as",
    "PER": "per",
    "HIDDEN": "hidden",
    "TOLERANCE": "tolerance",
    "LATE": "late",
    "INPUT": "input",
    "OUTPUT": "output",
    "SCENARIO": "scenario",
    "WITH": "with",
    "NOTHING": "nothing",
    "OBSERVES": "observes",
    "WITHIN": "within",
    "AFTER": "after",
    "FROM": "from",
}
"""The spelling of each contextual keyword."""

CONTEXTUAL_KEYWORDS = frozenset(SPELLING.values())

_WITHOUT_MEANING = {"break": ";", "continue": ";", "switch": "(", "enum": "{"}
"""Words of C that UPPAAL reserves and gives no meaning, with what follows them in C. Old models use them as names."""

PATHS = {"AG": "A[]", "AF": "A<>", "EG": "E[]", "EF": "E<>"}
"""Path quantifiers as other tools write them."""

_FLAGS = {"init": "INIT_FLAG", "urgent": "URGENT_FLAG", "committed": "COMMITTED_FLAG"}
_CLAUSES = ("replaces", "visible", "hidden", "tolerance", "late", "import")
_BOUNDS = ("within", "after", "from")
_OUTCOMES = ("holds", "fails")
_ARROWS = ("->", "-u->")
_OPENING = {"{", "(", "["}
_CLOSING = {"}", ")", "]"}


class _Inside(Enum):
    """The construct to which the innermost open brace belongs."""

    TOP = auto()
    PROCESS = auto()
    LOCATION = auto()
    EDGE = auto()
    RECORDING = auto()
    SCENARIO = auto()
    OTHER = auto()


def resolve_document(tokens: list[Token], types: frozenset[str] = frozenset()) -> list[Token]:
    """The tokens of a model with its contextual keywords marked.

    Args:
        tokens: of the whole text.
        types: words that name types defined in other files.
    """
    return _NameResolver(tokens, _Inside.TOP, types).run()


def resolve_fragment(tokens: list[Token]) -> list[Token]:
    """The tokens of an expression, a label or a block of declarations."""
    return _NameResolver(tokens, _Inside.TOP).run()


def resolve_query(tokens: list[Token]) -> list[Token]:
    """The tokens of one query, ended by `END`."""
    resolver = _NameResolver(tokens, _Inside.OTHER)
    resolver.query(len(tokens) - 1, expectation=True)
    resolver.output.append(tokens[-1])
    return resolver.output


@dataclass(slots=True)
class _NameResolver:
    tokens: list[Token]
    inside: _Inside
    output: list[Token]
    position: int
    types: frozenset[str]

    def __init__(self, tokens: list[Token], inside: _Inside, types: frozenset[str] = frozenset()) -> None:
        self.tokens = tokens
        self.inside = inside
        self.output = []
        self.position = 0
        self.types = types | _type_names(tokens)

    def text(self, ahead: int) -> str:
        index = self.position + ahead
        return self.tokens[index].text if 0 <= index < len(self.tokens) else ""

    def type(self, ahead: int) -> str:
        index = self.position + ahead
        return self.tokens[index].type if 0 <= index < len(self.tokens) else END

    def run(self) -> list[Token]:
        stack: list[_Inside] = []
        tokens = self.tokens
        before_process = False
        while self.position < len(tokens):
            token = tokens[self.position]
            kind = token.type
            if kind in ("PROCESS", "SYSTEM"):
                # Only braces that were never closed can be open here.
                stack.clear()
                self.inside = _Inside.TOP
                before_process = kind == "PROCESS"
            elif token.text == "{" and kind != "STRING":
                stack.append(self.inside)
                self.inside = self.opened_by(before_process)
                before_process = False
            elif token.text == "}" and stack:
                self.inside = stack.pop()
            elif kind in ("NAME", "INIT", "URGENT"):
                if self.at_start() and self.start_of_item(token):
                    continue
                if token.type == kind:
                    self.within(token)
            self.output.append(token)
            self.position += 1
        return self.output

    def at_start(self) -> bool:
        """True if an item, a clause or a statement can begin here."""
        if not self.output:
            return True
        last = self.output[-1]
        return last.text in (";", "{", "}") or last.type in _FLAGS.values() or last.type == "OPAQUE_BLOCK"

    def opened_by(self, before_process: bool) -> _Inside:
        if before_process and self.inside is _Inside.TOP:
            return _Inside.PROCESS
        if self.output and self.output[-1].type == "RECORDING":
            return _Inside.RECORDING
        if any(token.type == "SCENARIO" for token in self.output[-3:-1]):
            return _Inside.SCENARIO
        keyword = self.output[-2] if len(self.output) > 1 and self.output[-1].type == "NAME" else None
        if keyword is not None and self.inside is _Inside.PROCESS:
            if keyword.type in ("LOCATION", "BRANCHPOINT"):
                return _Inside.LOCATION
            if keyword.text in _ARROWS:
                return _Inside.EDGE
        if keyword is not None and keyword.type == "TO":
            return _Inside.EDGE
        return _Inside.OTHER

    def start_of_item(self, token: Token) -> bool:
        """Mark a word where an item may begin. True if it consumed tokens itself."""
        word, following, third = token.text, self.type(1), self.type(2)
        if self.inside is _Inside.EDGE:
            if word == "probability":
                token.type = "PROBABILITY"
            return False
        if self.inside is _Inside.LOCATION:
            if word in ("to", "invariant", "exponential_rate") or (word == "uncontrollable" and self.text(1) == "to"):
                token.type = word.upper()
            return False
        if self.inside is _Inside.RECORDING:
            if word in _CLAUSES:
                token.type = word.upper()
            return False
        if self.inside is _Inside.SCENARIO:
            self.start_of_scenario_clause(token, following, third)
            return False
        if self.inside is _Inside.OTHER:
            self.statement_word(token)
            return False
        if word in self.types:
            return False
        if word == "enum" and "{" in (self.text(1), self.text(2)):
            token.type = "RESERVED"
        elif word == "hybrid" and following == "CLOCK":
            token.type = "HYBRID"
        elif word in ("before_update", "after_update") and self.text(1) == "{":
            token.type = word.upper()
        elif word == "signal" and following == "NAME" and self.text(2) in ("=", ":="):
            token.type = "SIGNAL"
        elif word == "import" and following == "STRING":
            token.type = "IMPORT"
            if self.text(2) == "{":
                self.output += [token, self.tokens[self.position + 1]]
                self.position += 2
                self.opaque_block()
                return True
        elif self.inside is _Inside.TOP:
            return self.start_of_top_item(token, following, third)
        elif self.inside is _Inside.PROCESS:
            self.start_of_body_item(token, following)
        return False

    def start_of_top_item(self, token: Token, following: str, third: str) -> bool:
        word = token.text
        if (
            word.lower() == "system"
            and following == "NAME"
            and self.text(2) in (",", ";", "<")
            and self.names_no_type(word)
        ):
            token.type = "RESERVED"
        elif word in ("progress", "recording") and self.text(1) == "{":
            token.type = word.upper()
        elif word == "scenario" and following == "NAME" and "{" in (self.text(2), third == "STRING" and self.text(3)):
            token.type = "SCENARIO"
        elif word == "gantt" and self.text(1) == "{":
            token.type = "GANTT"
            self.output.append(token)
            self.position += 1
            self.opaque_block()
            return True
        elif word == "dynamic" and following == "NAME" and self.text(2) == "(" and self.declares():
            token.type = "DYNAMIC"
        elif word == "time_unit" and self.text(1) in ("=", ":=") and third == "INTEGER":
            token.type = "TIME_UNIT"
        elif word == "expect" and following == "NAME" and (third == "NAME" or self.text(2) == ","):
            self.expectation(token)
        elif word == "hide" and following == "NAME" and self.text(2) in (",", ";"):
            token.type = "HIDE"
        elif word == "property" and following == "NAME" and (third == "STRING" or self.text(2) == ":"):
            token.type = "PROPERTY"
            length = 4 if third == "STRING" else 3
            self.output += self.tokens[self.position : self.position + length]
            self.position += length
            self.query(self.end_of_property(), expectation=True)
            return True
        return False

    def start_of_scenario_clause(self, token: Token, following: str, third: str) -> None:
        """Mark ``within 5 ms``, ``after D``, ``from 2 to 5``, ``nothing 5 ms`` and ``observes c``; these words may name
        channels, too."""
        word = token.text
        if word == "observes" and following == "NAME":
            token.type = "OBSERVES"
        elif word == "nothing" and (following == "INTEGER" or (following == "NAME" and self.text(2) == ";")):
            token.type = "NOTHING"
            self.unit(2)
        elif word in _BOUNDS and (following == "INTEGER" or (following == "NAME" and third == "NAME")):
            token.type = word.upper()
            self.unit(2)

    def unit(self, ahead: int) -> None:
        """Mark the unit of a time: a name behind a number, unless an event begins there."""
        if self.type(ahead - 1) == "INTEGER" and self.type(ahead) == "NAME":
            of_silence = self.tokens[self.position + ahead - 2].type == "NOTHING"
            if of_silence or (self.type(ahead + 1) == "NAME" and self.text(ahead + 1) != "with"):
                self.tokens[self.position + ahead].type = "UNIT"

    def within_scenario(self, token: Token, last: Token) -> None:
        """Mark ``to`` between two times, and ``with`` behind an event."""
        if token.text == "to" and (last.type in ("INTEGER", "UNIT") or self.output[-2].type == "FROM"):
            token.type = "TO"
            self.unit(2)
        elif token.text == "with" and (last.text in ("]", "!") or last.type == "NAME"):
            token.type = "WITH"

    def names_no_type(self, word: str) -> bool:
        """True if nothing in the text can define a word as a type."""
        tokens = self.tokens
        places = [place for place, token in enumerate(tokens) if token.text == word]
        return not any(tokens[place + 1].text in (";", ",", "[") and place > 0 for place in places)

    def expectation(self, token: Token) -> None:
        """Mark ``expect A, B holds;``, and leave a declaration ``expect x;`` with a type of that name alone."""
        ahead = 2
        while self.text(ahead) == "," and self.type(ahead + 1) == "NAME":
            ahead += 2
        if self.text(ahead) in _OUTCOMES and self.text(ahead + 1) in (";", "if"):
            token.type = "EXPECT"
            self.outcomes(self.position + ahead, self.end_of_property())

    def outcomes(self, start: int, end: int) -> None:
        """Mark the words ``holds`` and ``fails`` of ``fails if e else holds``."""
        for index in range(start, end):
            token = self.tokens[index]
            if token.text in _OUTCOMES and (index == start or self.tokens[index - 1].text == "else"):
                token.type = token.text.upper()

    def declares(self) -> bool:
        """True if a name and parentheses, but no function body, follow."""
        depth = 0
        for index in range(self.position + 2, len(self.tokens) - 1):
            depth += (self.tokens[index].text == "(") - (self.tokens[index].text == ")")
            if depth == 0:
                return self.tokens[index + 1].text != "{"
        return True

    def start_of_body_item(self, token: Token, following: str) -> None:
        word = token.text
        if word == "branchpoint" and following == "NAME":
            token.type = "BRANCHPOINT"
        elif word == "urgent" and following == "NAME" and self.text(2) in (",", ";") and not self.flagged_location():
            token.type = "URGENT_LOCATIONS"
        elif self.flagged_location():
            token.type = "LOCATION" if word == "location" else _FLAGS[word]

    def flagged_location(self) -> bool:
        """True if flags, then ``location NAME``, then ``{`` or ``;`` follow."""
        ahead = 0
        while self.text(ahead) in _FLAGS and ahead < 8:
            ahead += 1
        return self.text(ahead) == "location" and self.type(ahead + 1) == "NAME" and "location" not in self.types

    def statement_word(self, token: Token) -> None:
        word, following = token.text, self.type(1)
        if word in self.types:
            return
        if _WITHOUT_MEANING.get(word) == self.text(1):
            token.type = "RESERVED"
            return
        if word == "assert" and (self.text(1) in ("(", "!", "-") or following in _BEGINS_OPERAND):
            token.type = "ASSERT"
        elif word == "hybrid" and following == "CLOCK":
            token.type = "HYBRID"

    def within(self, token: Token) -> None:
        """Mark a word that is a keyword by its neighbours alone."""
        if self.resumes_after_omission(token):
            return
        if token.text in ("sum", "foreach") and [self.text(1), self.type(2), self.text(3)] == ["(", "NAME", ":"]:
            token.type = token.text.upper()
            return
        if token.text == "spawn" and self.type(1) == "NAME" and self.text(2) == "(" and "spawn" not in self.types:
            token.type = "SPAWN"
            return
        if not self.output:
            return
        last = self.output[-1]
        if token.text == "hybrid" and self.type(1) == "CLOCK":
            token.type = "HYBRID"
        elif self.inside is _Inside.SCENARIO:
            self.within_scenario(token, last)
        elif self.inside is _Inside.RECORDING:
            self.within_recording(token, last)
        elif token.text == "priority" and last.type == "CHAN" and self.type(1) == "NAME":
            token.type = "PRIORITY"
        elif last.text in (")", "else", "do") or last.type == "DO":
            self.statement_word(token)

    def within_recording(self, token: Token, last: Token) -> None:
        """Mark ``as`` behind a channel, ``per`` behind the columns, and ``input`` or ``output`` behind ``late``."""
        match token.text:
            case "as":
                found = last.text in ("]", "!", "?") or last.type == "NAME"
            case "per":
                found = last.text == ")"
            case "input" | "output":
                found = last.type == "LATE"
            case _:
                return
        if found:
            token.type = token.text.upper()

    def resumes_after_omission(self, token: Token) -> bool:
        """Mark a word that can only begin a block although the ``;`` before it was forgotten, for better messages."""
        if self.type(1) != "NAME":
            return False
        if self.inside is _Inside.PROCESS and token.text == "location" and self.text(2) == "{":
            token.type = "LOCATION"
        elif self.inside is _Inside.LOCATION and token.text in ("to", "uncontrollable"):
            token.type = token.text.upper()
        else:
            return False
        return True

    def opaque_block(self) -> None:
        """Take a balanced pair of braces as one token; one that is never closed stays as it is, an error."""
        depth = 0
        for end in range(self.position, len(self.tokens) - 1):
            text = self.tokens[end].text
            depth += (text == "{") - (text == "}")
            if depth == 0:
                span = self.tokens[self.position].span.to(self.tokens[end].span)
                self.output.append(Token("OPAQUE_BLOCK", span.text, span))
                self.position = end + 1
                return

    def end_of_property(self) -> int:
        """The index of the ``;`` that ends the formula at the current position."""
        depth = 0
        index = self.position
        while index < len(self.tokens) - 1:
            text = self.tokens[index].text
            if text in _OPENING:
                depth += 1
            elif text in _CLOSING:
                depth -= 1
                if depth < 0:
                    break
            elif text == ";" and depth == 0:
                break
            index += 1
        return index

    def query(self, end: int, expectation: bool) -> None:
        """Mark the words of a query that ends before the token ``end``."""
        tokens = self.tokens
        suffix = self.suffix(end) if expectation else end
        if suffix < end:
            tokens[suffix].type = "EXPECT"
            self.outcomes(suffix + 1, end)
        formula = tokens[self.position : suffix]
        if formula and unchecked_family(words_of(" ".join(token.text for token in formula))):
            self.output.append(_joined("UNCHECKED", formula))
        elif is_sentence(formula):
            self.output.append(_joined("SENTENCE", formula))
        elif not _is_query(formula) and is_temporal(marked := resolve_formula(formula)):
            start = formula[0].span
            self.output += [Token("FORMULA", "", Span(start.source, start.start, start.start)), *marked]
        else:
            self.symbolic(formula)
        self.output += tokens[suffix:end]
        self.position = end

    def suffix(self, end: int) -> int:
        """The beginning of ``expect holds`` or ``expect fails if ...`` after a query; its end if there is none."""
        for index in range(end - 2, self.position, -1):
            first, second, third = self.tokens[index : index + 3]
            if first.text == "expect" and second.text in _OUTCOMES and (index + 2 == end or third.text == "if"):
                return index
        return end

    def symbolic(self, formula: list[Token]) -> None:
        index = 0
        if len(formula) > 1 and formula[0].text in ("sup", "inf", "bounds") and formula[1].text in ("{", ":"):
            formula[0].type = formula[0].text.upper()
        elif len(formula) > 2 and (word := "".join(token.text for token in formula[:3])) in PATHS.values():
            self.output.append(Token("QUANTIFIER", word, formula[0].span.to(formula[2].span)))
            index = 3
        elif index := _path(formula):
            word = "".join(token.text for token in formula[:index])
            self.output.append(Token("QUANTIFIER", PATHS[word], formula[0].span.to(formula[index - 1].span)))
        for place in range(index, len(formula)):
            token = formula[place]
            if token.type == "NAME":
                following = formula[place + 1 : place + 4]
                if token.text == "deadlock":
                    if place == 0 or formula[place - 1].text != ".":
                        token.type = "DEADLOCK"
                elif token.text == "sum" and [t.text for t in following[:1]] == ["("] and following[-1].text == ":":
                    token.type = "SUM"
            self.output.append(token)


def _is_query(formula: list[Token]) -> bool:
    """True if this begins as only a query can, or is ``p --> q``."""
    first, second, third = ([token.text for token in formula[:3]] + [""] * 3)[:3]
    if first in ("A", "E") and second + third in ("[]", "<>"):
        return True
    if first in ("sup", "inf", "bounds") and second in ("{", ":"):
        return True
    if _path(formula):
        return True
    return any(token.text == "-->" for token in formula)


def _path(formula: list[Token]) -> int:
    """The number of tokens that spell a path quantifier as in other tools, ``AG`` or ``A G``, at the start of a query.

    Elsewhere such a word is a name: before ``-->`` and in formulas.
    """
    if any(token.text in ("-->", "->") for token in formula):
        return 0
    for length in (1, 2):
        word = "".join(token.text for token in formula[:length])
        if word in PATHS and len(formula) > length:
            following = formula[length]
            if following.type in _BEGINS_OPERAND or following.text in ("(", "!", "-"):
                return length
    return 0


_BEGINS_OPERAND = {"NAME", "INTEGER", "FLOAT", "TRUE", "FALSE", "NOT", "FORALL", "EXISTS"}


def _joined(kind: str, tokens: list[Token]) -> Token:
    """Several tokens as one; its text has single blanks where there was any gap. Without comments, the text has also
    what is not a token."""
    span = tokens[0].span.to(tokens[-1].span)
    if "//" not in span.text and "/*" not in span.text:
        return Token(kind, " ".join(span.text.split()), span)
    parts = [tokens[0].text]
    for before, token in pairwise(tokens):
        parts.append(" " * (before.span.end < token.span.start) + token.text)
    return Token(kind, "".join(parts), span)


def _type_names(tokens: list[Token]) -> frozenset[str]:
    """Contextual keywords that the text defines as types."""
    found: set[str] = set()
    for index, token in enumerate(tokens):
        if token.type != "TYPEDEF":
            continue
        depth = 0
        for place in range(index + 1, len(tokens)):
            text = tokens[place].text
            depth += (text in _OPENING) - (text in _CLOSING)
            if depth <= 0 and text in CONTEXTUAL_KEYWORDS and tokens[place + 1].text in (";", ",", "["):
                found.add(text)
            if (depth <= 0 and text == ";") or tokens[place].type == "TYPEDEF":
                break
    return frozenset(found)
