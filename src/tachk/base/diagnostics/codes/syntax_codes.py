"""Explanations of what reading and parsing report."""

from __future__ import annotations

from tachk.base.diagnostics.codes.formula_codes import FORMULA_CODES
from tachk.base.diagnostics.explanation import Explanation

SYNTAX_CODES: dict[str, Explanation] = {
    **FORMULA_CODES,
    "E0001": Explanation(
        "not a text",
        "The file contains bytes that are not text, or its encoding is neither UTF-8 nor Latin-1. A model is plain "
        "text or UPPAAL's XML.",
    ),
    "E0002": Explanation(
        "unknown character",
        "Names consist of the letters A to Z, digits and the underscore. Anything else outside comments and strings is "
        "an operator, a bracket or a mistake. Signs of mathematics and of word processors are written with ASCII: >= "
        "for ≥, && for ∧, A[] for ∀□, quotation marks as on a typewriter.",
        "int höhe;",
        "int hoehe;",
    ),
    "E0003": Explanation(
        "unclosed comment",
        "A comment that begins with /* ends at the first */. Comments do not nest.",
        "int a; /* the level",
        "int a; /* the level */",
    ),
    "E0004": Explanation(
        "unclosed string",
        'A string ends with " on the line on which it begins.',
        'import "library.ta;',
        'import "library.ta";',
    ),
    "E0005": Explanation(
        "number too large",
        "Integers of a model have 32 bits.",
        "const int N = 5000000000;",
        "const int N = 2000000000;",
    ),
    "E0006": Explanation("empty text", "The text contains only blanks and comments."),
    "E0101": Explanation(
        "unexpected word",
        "The text before this word is legal, but this word cannot follow it. The message lists what could stand here "
        "instead.",
        "int a b;",
        "int a, b;",
    ),
    "E0102": Explanation(
        "something is missing",
        "A semicolon, a bracket or a parenthesis is missing. With it, the text up to here would be legal.",
        "clock x\nint a;",
        "clock x;\nint a;",
    ),
    "E0103": Explanation(
        "keyword used as a name",
        "The word is reserved and cannot name anything. The words that tachk adds to UPPAAL's language are not "
        "reserved: location, property, signal, to and the like remain free.",
        "int state;",
        "int level;",
    ),
    "E0104": Explanation(
        "misspelt keyword",
        "The word stands where only certain keywords can stand, and resembles one of them.",
        "process P() {\n    init location A { to A { gaurd true; } }\n}",
        "process P() {\n    init location A { to A { guard true; } }\n}",
    ),
    "E0105": Explanation(
        "clauses out of order",
        "The clauses of an edge stand in the order select, guard, sync, assign: the order in which they take effect.",
        "process P() {\n    clock x;\n    init location A { to A { assign x = 0; guard x > 1; } }\n}",
        "process P() {\n    clock x;\n    init location A { to A { guard x > 1; assign x = 0; } }\n}",
    ),
    "E0106": Explanation(
        "declaration after a statement",
        "As in UPPAAL, the variables of a block are declared before its first statement.",
        "void f() { g(); int i; }",
        "void f() { int i; g(); }",
    ),
    "E0107": Explanation(
        "clause given twice",
        "Each clause occurs at most once in an edge or a location.",
        "process P() {\n    clock x;\n    init location A { invariant x < 3; invariant x < 4; }\n}",
        "process P() {\n    clock x;\n    init location A { invariant x < 3 && x < 4; }\n}",
    ),
    "E0108": Explanation(
        "two forms of a body in one template",
        "A template is written either with location blocks or with the lines state, commit, urgent, init and trans of "
        "UPPAAL's XTA, never with both.",
        "process P() {\n    state A;\n    init A;\n    location B { to B; }\n}",
        "process P() {\n    init location A;\n    location B { to B; }\n}",
    ),
    "E0109": Explanation(
        "line about an unknown location",
        "The lines init, commit and urgent give properties to locations that a state line of the template declares.",
        "process P() { state A; init B; }",
        "process P() { state A, B; init B; }",
    ),
    "E0110": Explanation(
        "edge without a source",
        "In a trans line an edge may leave out its source if the edge before it has the same one; the first cannot.",
        "process P() { state A; init A; trans -> A { }; }",
        "process P() { state A; init A; trans A -> A { }; }",
    ),
    "E0111": Explanation(
        "nested too deeply",
        "Expressions and statements may be nested 250 levels deep. A chain, such as `a - b - c` or `else if`, may have "
        "thousands of parts, up to 4,000 where the thread has a stack of 8 MB. A longer one is better split with "
        "functions, arrays or quantifiers.",
    ),
    "E0112": Explanation(
        "not plain XTA",
        "`tachk check --strict-xta` accepts only the language of UPPAAL itself, without what tachk adds to it. "
        "`tachk convert` writes a model with additions in UPPAAL's formats.",
        "process P() { init location A; }",
        "process P() { state A; init A; }",
    ),
    "E0113": Explanation(
        "unbalanced brackets",
        "Every (, [ and { has its closing counterpart, and brackets close in the reverse order of opening.",
        "void f() { int i;",
        "void f() { int i; }",
    ),
    "E0114": Explanation(
        "reserved word without meaning",
        "UPPAAL reserves switch, break, continue and enum and gives them no meaning.",
        "void f() { while (true) { break; } }",
        "void f() { bool done = false; while (!done) { done = true; } }",
    ),
    "E0115": Explanation(
        "no query",
        "A query begins with one of A[], E<>, A<>, E[], sup, inf, bounds, or has the form p --> q.",
    ),
    "W0101": Explanation(
        "old syntax",
        "The text is not modern XTA but legal for UPPAAL 2.x and 3.x, where a comma in guards and invariants means "
        "'and', constants have no type, and parameters are separated by semicolons. It is read that way as a whole.",
        "process P() { clock x, y; state A; init A; trans A -> A { guard x > 1, y > 1; }; }",
        "process P() { clock x, y; state A; init A; trans A -> A { guard x > 1 && y > 1; }; }",
    ),
    "W0102": Explanation(
        "grouped in another way by early versions",
        "A text of UPPAAL 3.x may have been written when not, and, or and imply bound weaker than every symbol. Today "
        "they bind as !, && and || do: `not a == b` is `(not a) == b`. Parentheses make the meaning plain.",
        "const N 5;\nprocess P() { int a; state s; init s; trans s -> s { guard not a == N; }; }\nsystem P;",
        "const int N = 5;\nprocess P() { int a; state s; init s; trans s -> s { guard not (a == N); }; }\nsystem P;",
    ),
}
