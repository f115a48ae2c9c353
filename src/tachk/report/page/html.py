"""The page as one HTML file that needs no other file and no network, or as a widget of a notebook."""

from __future__ import annotations

import json
import zlib
from base64 import b64encode
from typing import Any

from jinja2 import Environment, FunctionLoader, StrictUndefined
from markdown_it import MarkdownIt
from markupsafe import Markup

from tachk.base.optional_packages import optional_packages
from tachk.base.resources import template_text
from tachk.model.quantity import bytes_, grouped, seconds
from tachk.report.drawing.svg import DARK_STYLE, STYLE
from tachk.report.drawing.themes import with_dark
from tachk.report.json_report import Json
from tachk.report.page.content import Answers, Page, Text
from tachk.report.statistics.answered import short_answer
from tachk.verify.verdict import Answer

_MARKS = {Answer.HOLDS.value: "✓", Answer.FAILS.value: "✗", Answer.UNKNOWN.value: "?"}
_CLASSES = {**{answer: answer for answer in _MARKS}, "true": "holds", "false": "fails", "undetermined": "unknown"}
"""The classes that colour answers and verdicts."""

_RENDER = """
export default {
  async render({ model, el }) {
    const root = el.attachShadow({ mode: "open" });
    root.innerHTML = model.get("content");
    await enliven(root);
  },
};
"""
"""The styles of the page stay in the widget, and those of the notebook outside."""


def page_to_html(page: Page) -> str:
    """The text of the file. Everything that comes from the model is escaped."""
    return _rendered("page", page)


def page_to_widget(page: Page) -> Any:
    """The page as an `anywidget.AnyWidget` for notebooks. Raises MissingPackageError without anywidget."""
    with optional_packages():
        from anywidget import AnyWidget
        from traitlets import Unicode
    content = f'<style>{_style()}</style><div class="page">{_rendered("content", page)}</div>'
    members = {"_esm": template_text("report/page.js") + _RENDER, "content": Unicode(content).tag(sync=True)}
    return type("PageWidget", (AnyWidget,), members)()


def _rendered(template: str, page: Page) -> str:
    environment = Environment(
        loader=FunctionLoader(template_text), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    environment.filters |= {"count": grouped, "seconds": seconds, "bytes": bytes_, "image": _image, "packed": packed}
    environment.filters |= {"markdown": _markdown, "short_answer": short_answer}
    environment.tests |= {
        "a_text": lambda part: isinstance(part, Text),
        "about_a_model": lambda p: isinstance(p, Answers),
    }
    script = Markup(template_text("report/page.js"))
    given = {"page": page, "marks": _MARKS, "classes": _CLASSES, "style": Markup(_style()), "script": script}
    return environment.get_template(f"report/{template}.html.j2").render(given)


def _style() -> str:
    """The styles of the page, with those of the pictures of automata."""
    light, dark = ("\n".join(f".automaton {rule}" for rule in rules.splitlines()) for rules in (STYLE, DARK_STYLE))
    return "\n".join((with_dark(light, dark), template_text("report/page.css")))


def _markdown(text: str) -> Markup:
    """HTML in the text stays text."""
    return Markup(MarkdownIt("commonmark", {"html": False}).enable("table").render(text))


def _image(svg: str) -> str:
    """A picture as an address: its styles are its own there."""
    return f"data:image/svg+xml;base64,{b64encode(svg.encode()).decode()}"


def packed(value: Json) -> str:
    """A value for the script of the page: JSON, compressed as in RFC 1950, in base64."""
    text = json.dumps(value, separators=(",", ":"), ensure_ascii=False)
    return b64encode(zlib.compress(text.encode(), level=9)).decode()
