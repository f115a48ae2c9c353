"""The page as one HTML file that needs no other file and no network."""

from __future__ import annotations

import json
from base64 import b64encode

from jinja2 import Environment, FunctionLoader, StrictUndefined
from markupsafe import Markup

from tachk.drawing.svg import STYLE
from tachk.properties.verdict import Answer
from tachk.report.json_report import Json
from tachk.report.page.content import Page
from tachk.report.quantity import bytes_, grouped, seconds
from tachk.resources import template_text

_MARKS = {Answer.HOLDS.value: "✓", Answer.FAILS.value: "✗", Answer.UNKNOWN.value: "?"}
_CLASSES = {**{answer: answer for answer in _MARKS}, "true": "holds", "false": "fails", "undetermined": "unknown"}
"""How answers and verdicts are coloured."""


def page_to_html(page: Page) -> str:
    """The text of the file. Everything that comes from the model is escaped."""
    environment = Environment(
        loader=FunctionLoader(template_text), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    environment.filters |= {"count": grouped, "seconds": seconds, "bytes": bytes_, "image": _image, "data": _data}
    template = environment.get_template("report/page.html.j2")
    style, script = (Markup(template_text(f"report/page.{ending}")) for ending in ("css", "js"))
    rules = STYLE.splitlines()
    return template.render(page=page, marks=_MARKS, classes=_CLASSES, style=style, script=script, rules=rules)


def _image(svg: str) -> str:
    """A picture as an address: its styles are its own there."""
    return f"data:image/svg+xml;base64,{b64encode(svg.encode()).decode()}"


def _data(value: Json) -> Markup:
    """A value inside a script element, which only `</` could end."""
    return Markup(json.dumps(value, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c"))
