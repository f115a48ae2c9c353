"""The gallery: each model that comes with tachk, with its picture, its verdicts as of this build, and its text."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from textwrap import indent

from docs.site_build import markdown
from docs.site_build.site_files import ROOT, Section, SiteFile
from docs.site_build.verdicts import Answered, ModelVerdicts

FOLDER = "gallery/"
FOLDERS = {"classics": "Classics", "micro_xrce_dds": "Micro XRCE-DDS"}
"""The folders of models, with their headings."""

_SYSTEM = re.compile(r"^system\b", re.MULTILINE)
_LINES_OF_A_RUN = 60
_CONSTANTS = 12
"""How many constants a page names."""


def models(root: Path = ROOT) -> tuple[Path, ...]:
    """The models that are systems, not parts of one."""
    found = (path for folder in FOLDERS for path in sorted((root / "models" / folder).glob("*.ta")))
    return tuple(path for path in found if _SYSTEM.search(path.read_text(encoding="utf-8")))


def first_comment(text: str) -> str:
    """The comment at the top of a model, without its slashes."""
    lines = []
    for line in text.splitlines():
        if not line.startswith("//"):
            break
        lines.append(line.removeprefix("//").removeprefix(" ").rstrip())
    return "\n".join(lines)


def comment_as_markdown(comment: str) -> str:
    """The paragraphs of a comment; indented lines, such as commands and tables, stay as they are."""
    return "\n\n".join(_paragraph(block) for block in re.split(r"\n\n+|\n(?=Source: )", comment.strip()))


def _paragraph(block: str) -> str:
    lines = block.splitlines()
    if lines[0].startswith("Try it:"):
        lines[0] = lines[0].replace("Try it:", "       ", 1)
        return f"Try it:\n\n{markdown.fence(_remarks(_dedented(lines)), 'sh')}"
    if all(line.startswith("  ") for line in lines):
        return markdown.fence(_dedented(lines), "text")
    return markdown.plain(" ".join(lines))


def _remarks(commands: str) -> str:
    """Commands with what stands behind them, at a distance, as comments of the shell."""
    return re.sub(r"^(tachk .*?\S)(\s{3,})(?=\S)", r"\1\2# ", commands, flags=re.MULTILINE)


def _dedented(lines: Iterable[str]) -> str:
    lines = list(lines)
    margin = min(len(line) - len(line.lstrip()) for line in lines if line.strip())
    return "\n".join(line[margin:] for line in lines)


def gallery_section(
    verdicts: Mapping[Path, ModelVerdicts], pictures: Mapping[Path, Mapping[str, str]], root: Path = ROOT
) -> Section:
    """An overview with the pictures, and a page for each model.

    Args:
        verdicts: of each model.
        pictures: the SVG of each template of each model.
    """
    pages = []
    drawings = []
    for path in models(root):
        drawn = {name: f"{FOLDER}pictures/{path.stem}_{name}.svg" for name in pictures[path]}
        drawings += [SiteFile(drawn[name], svg) for name, svg in pictures[path].items()]
        pages.append(SiteFile(page_of(path), _page(path, drawn, verdicts[path], root), path.stem))
    overview = SiteFile(f"{FOLDER}index.md", _overview(pictures, verdicts, root), "All models")
    homes = {path.relative_to(root).as_posix(): page_of(path) for path in models(root)}
    groups = {
        title: tuple(page_of(path) for path in models(root) if path.parent.name == folder)
        for folder, title in FOLDERS.items()
    }
    return Section(FOLDER, (overview, *pages, *drawings), homes, groups)


def page_of(path: Path) -> str:
    """The path of the page of a model."""
    return f"{FOLDER}{path.stem}.md"


def _overview(pictures: Mapping[Path, Mapping[str, str]], verdicts: Mapping[Path, ModelVerdicts], root: Path) -> str:
    parts = ["# Gallery of models", "`tachk models copy NAME` copies one of these models, with all that it imports."]
    for folder, title in FOLDERS.items():
        cards = (_card(path, pictures[path], verdicts[path]) for path in models(root) if path.parent.name == folder)
        parts.append(f'## {title}\n\n<div class="grid cards gallery" markdown>\n\n' + "\n".join(cards) + "\n\n</div>")
    return markdown.joined(*parts)


def _card(path: Path, pictures: Mapping[str, str], verdicts: ModelVerdicts) -> str:
    first = first_comment(path.read_text(encoding="utf-8")).partition("\n\n")[0]
    sentence = re.split(r"(?<=[.!?])\s", " ".join(first.split()))[0]
    link = page_of(path).removeprefix(FOLDER)
    picture = _thumbnail(pictures)
    image = f"[{_image(picture, f'{path.stem}_{picture}.svg')}]({link})" if picture else ""
    parts = (f"**[{path.stem}]({link})**", image, markdown.plain(sentence), verdicts.summary())
    return f"-{indent(markdown.joined(*parts), '    ')[1:]}"


def _image(template: str, file: str) -> str:
    return f"![Template {template}](pictures/{file}){{ .automaton loading=lazy }}"


def _thumbnail(pictures: Mapping[str, str]) -> str:
    """The template that a card shows: the one whose picture is nearest to that of a photograph."""

    def distance(name: str) -> float:
        width, height = size(pictures[name])
        return abs(width / height - 1.6) + width / 1500

    return min(pictures, key=distance, default="")


def size(svg: str) -> tuple[float, float]:
    """Width and height of a picture."""
    found = re.search(r'viewBox="\S+ \S+ (\S+) (\S+)"', svg)
    assert found is not None, svg[:200]
    return float(found[1]), float(found[2])


def _page(path: Path, pictures: Mapping[str, str], verdicts: ModelVerdicts, root: Path) -> str:
    name = path.relative_to(root / "models").as_posix().removesuffix(".ta")
    text = path.read_text(encoding="utf-8")
    drawn = "\n\n".join(
        f"**{template}**\n\n[{_image(template, Path(file).name)}](pictures/{Path(file).name})"
        for template, file in pictures.items()
    )
    return markdown.joined(
        f"# {path.stem}",
        comment_as_markdown(first_comment(text)),
        markdown.fence(f"$ tachk models copy {name}", "console"),
        "## Verdicts" if verdicts.answers else "",
        _circumstances(verdicts),
        markdown.table(("property", "answer", "states", "meaning"), [_row(each) for each in verdicts.answers]),
        *(_run(each) for each in verdicts.answers if each.run),
        "## Templates" if pictures else "",
        drawn,
        "## Text",
        markdown.fence(text, "ta", path.name),
    )


def _circumstances(verdicts: ModelVerdicts) -> str:
    """What stands above the table of verdicts."""
    if not verdicts.answers:
        return ""
    given = f"With {_constants(verdicts.constants)}, as" if verdicts.constants else "As"
    return f"{given} of this build; ✓ marks the answers that the model expects:"


def _constants(constants: Mapping[str, int]) -> str:
    shown = [f"`{name} = {value}`" for name, value in constants.items()]
    more = [f"{len(shown) - _CONSTANTS} more constants"] if len(shown) > _CONSTANTS else []
    return ", ".join((*shown[:_CONSTANTS], *more))


def _row(answered: Answered) -> tuple[str, ...]:
    states = f"{answered.states:,}" if answered.states else ""
    mark = {True: "✓", False: "✗", None: ""}[answered.met]
    return (
        markdown.code(answered.name),
        f"{markdown.plain(answered.answer)} {mark}",
        states,
        markdown.plain(answered.meaning),
    )


def _run(answered: Answered) -> str:
    return markdown.folded(f"The run of {answered.name}", markdown.fence(_shortened(answered.run), "text"))


def _shortened(run: str) -> str:
    lines = run.splitlines()
    if len(lines) <= _LINES_OF_A_RUN:
        return run
    return "\n".join((*lines[:_LINES_OF_A_RUN], f"... {len(lines) - _LINES_OF_A_RUN} more lines"))
