"""The reference of the command line, from the commands themselves: a page for each, with every argument and option."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import click

from docs.site_build import markdown
from docs.site_build.site_files import Section, SiteFile
from tachk.cli.former_names import FORMER_NAMES
from tachk.cli.main import FOLDERS, HIDDEN, SECTIONS, app, load_command
from tachk.cli.options import SectionedCommand

FOLDER = "reference/commands/"

_GROUPS = {**{title: tuple(section) for title, section in SECTIONS.items()}, "For scripts and shells": HIDDEN}
"""The names of commands, as the help groups them, with those that it does not list."""

_FENCE = re.compile(r"^```console\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_CALL = re.compile(r"^\$ tachk (.*)$", re.MULTILINE)
_LONGEST_EXAMPLE = 24
"""Lines."""


@dataclass(frozen=True, slots=True)
class Example:
    """A block of a page that a test executes.

    Attributes:
        page: its path in the repository.
        title: the heading of the page.
        block: commands with their output.
    """

    page: str
    title: str
    block: str

    @property
    def calls(self) -> list[str]:
        return _CALL.findall(self.block)


def examples(pages: Mapping[str, str]) -> tuple[Example, ...]:
    """The blocks with commands of pages, by their paths in the repository."""
    return tuple(
        Example(path, heading(text) or path, block) for path, text in pages.items() for block in _FENCE.findall(text)
    )


def heading(text: str) -> str:
    """The first heading of a page."""
    found = re.search(r"^# (.*)$", text, re.MULTILINE)
    return found[1] if found else ""


def command_names() -> tuple[str, ...]:
    """Every command as one types it, subcommands included, in the order of the help."""
    return tuple(name for name, _ in _all_commands())


def _all_commands() -> Iterator[tuple[str, click.Command]]:
    for name in (*(name for section in SECTIONS.values() for name in section), *HIDDEN):
        for full in [f"{name} {each}" for each in FOLDERS[name]] if name in FOLDERS else [name]:
            yield full, load_command(full)


def command_section(found: Sequence[Example]) -> Section:
    """An overview and a page for each command."""
    commands = dict(_all_commands())
    pages = tuple(
        SiteFile(page_of(name), _page(name, command, found), f"tachk {name}") for name, command in commands.items()
    )
    groups = {
        title: tuple(page_of(name) for name in commands if name.split()[0] in section)
        for title, section in _GROUPS.items()
    }
    overview = SiteFile(f"{FOLDER}index.md", _overview(commands), "All commands")
    return Section(FOLDER, (overview, *pages), groups=groups)


def page_of(name: str) -> str:
    """The path of the page of a command."""
    return f"{FOLDER}{name.replace(' ', '_')}.md"


def anchor_of(parameter: click.Parameter) -> str:
    """The anchor of an option or argument on the page of its command: its longest name."""
    if isinstance(parameter, click.Option):
        return max(parameter.opts, key=len).lstrip("-")
    return f"argument-{parameter.name}".replace("_", "-")


def shown_parameters(command: click.Command) -> list[click.Parameter]:
    """The arguments and options that the help shows; of a group, those of its subcommands, too."""
    own = [each for each in command.params if not getattr(each, "hidden", False)]
    inner = command.commands.values() if isinstance(command, click.Group) else ()
    return own + [each for child in inner for each in shown_parameters(child)]


def _overview(commands: Mapping[str, click.Command]) -> str:
    tables = [
        markdown.joined(
            f"## {title}",
            markdown.table(
                ("command", "what it does"),
                [
                    (f"[`tachk {name}`]({page_of(name).removeprefix(FOLDER)})", markdown.plain(_summary(command)))
                    for name, command in commands.items()
                    if name.split()[0] in section
                ],
            ),
        )
        for title, section in _GROUPS.items()
    ]
    former = markdown.table(
        ("before", "now"), [(f"`tachk {old}`", f"`tachk {former.name}`") for old, former in FORMER_NAMES.items()]
    )
    return markdown.joined(
        "# Commands",
        "\n\n".join(_paragraphs(app.help or "")),
        *tables,
        "## Names of version 0.2",
        "These still work, with a note on the standard error.",
        former,
    )


def _summary(command: click.Command) -> str:
    return command.get_short_help_str(200)


def _paragraphs(text: str) -> Iterator[str]:
    for paragraph in re.split(r"\n\s*\n", text.strip()):
        yield markdown.plain(" ".join(paragraph.replace("\b", "").split()))


def _page(name: str, command: click.Command, found: Sequence[Example]) -> str:
    return markdown.joined(
        f"# tachk {name}", *_described(name, command, "##"), _example(name, found), _mentions(name, found)
    )


def _described(name: str, command: click.Command, level: str) -> Iterator[str]:
    """Usage, meaning, arguments and options; of a group, those of its subcommands behind them."""
    context = click.Context(command, info_name=f"tachk {name}")
    yield markdown.fence(" ".join((f"tachk {name}", *command.collect_usage_pieces(context))), "text")
    yield from _paragraphs(command.help or "")
    arguments = [each for each in command.params if isinstance(each, click.Argument)]
    if arguments:
        yield f"{level} Arguments"
        yield from (_parameter(each, context, level) for each in arguments)
    for title, options in _option_groups(command):
        yield f"{level} {title}"
        yield from (_parameter(each, context, level) for each in options)
    if isinstance(command, click.Group):
        for child_name, child in command.commands.items():
            yield f"{level} tachk {name} {child_name}"
            yield from _described(f"{name} {child_name}", child, level + "#")


def _option_groups(command: click.Command) -> Iterator[tuple[str, list[click.Option]]]:
    """The options below the headings of the help."""
    options = [each for each in command.params if isinstance(each, click.Option) and not each.hidden]
    sections = command.sections if isinstance(command, SectionedCommand) else {}
    placed = {name for names in sections.values() for name in names}
    groups = {"Options": [each for each in options if each.name not in placed]}
    for title, names in sections.items():
        groups[title] = [each for name in names for each in options if each.name == name]
    yield from ((title, group) for title, group in groups.items() if group)


def _parameter(parameter: click.Parameter, context: click.Context, level: str) -> str:
    record = parameter.get_help_record(context)
    names, help = record or (parameter.make_metavar(context), "")
    if isinstance(parameter, click.Argument):
        names, help = parameter.make_metavar(context), getattr(parameter, "help", None) or help
    names, values = _split_choices(names)
    help, limits = _split_limits(help)
    facts = (
        f"One of {', '.join(markdown.code(value) for value in values)}." if values else "",
        f"{limits.capitalize()}." if limits else "",
    )
    title = f"{level}# {markdown.code(names)} {{ #{anchor_of(parameter)} }}"
    return markdown.joined(title, markdown.plain(help), " ".join(fact for fact in facts if fact)).rstrip()


def _split_limits(help: str) -> tuple[str, str]:
    """What click adds in brackets, such as `[default: 0; 0<=x<=256]`, and the help without it."""
    added = re.search(r"\s*\[((?:default: |required|env var: |[\w.]*<=?x|x[<>])[^\]]*)\]$", help)
    if added is None:
        return help, ""
    parts = []
    for part in added[1].split("; "):
        default = part.removeprefix("default: ")
        if default.startswith("("):
            parts.append(f"default: {markdown.plain(default.strip('()'))}")
        elif default != part:
            parts.append(f"default: {markdown.code(default)}")
        else:
            parts.append(part if part == "required" else f"range: {markdown.code(part)}")
    return help[: added.start()], "; ".join(parts)


def _split_choices(names: str) -> tuple[str, list[str]]:
    """`--format [a|b]` as its name and its choices; other names as they are."""
    choices = re.search(r" \[([^\[\]]+\|[^\[\]]+)\]$", names)
    return (names[: choices.start()], choices[1].split("|")) if choices else (names, [])


def _called(name: str, call: str) -> bool:
    return (call + " ").startswith(name + " ")


def _example(name: str, found: Sequence[Example]) -> str:
    """The block of the documentation that shows the command best: not long, and nothing else in it."""
    fitting = [
        each
        for each in found
        if all(_called(name, call) for call in each.calls) and 2 < each.block.count("\n") <= _LONGEST_EXAMPLE
    ]
    if not fitting:
        return ""
    best = max(fitting, key=lambda each: ("\n...\n" not in each.block, each.block.count("\n")))
    return markdown.joined("## Example", markdown.fence(best.block, "console"), f"From {_link(best)}.").rstrip()


def _mentions(name: str, found: Sequence[Example]) -> str:
    links = sorted({_link(each) for each in found if any(_called(name, call) for call in each.calls)})
    listed = "\n".join(f"- {link}" for link in links)
    return markdown.joined("## Pages that show it", listed).rstrip() if links else ""


def _link(example: Example) -> str:
    """A link to the page of an example, from the top of the repository."""
    return f"[{example.title}](/{example.page})"
