"""`tachk mcp`: offer tachk's tools to agents, by the Model Context Protocol."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from tachk.base.optional_packages import optional_packages
from tachk.cli import options
from tachk.cli.exit_status import ExitStatus

_BYTES_IN_A_MEGABYTE = 1 << 20


@click.command(name="mcp")
@click.option(
    "seconds",
    "--max-seconds",
    metavar="SECONDS",
    type=options.Seconds(min=0, min_open=True),
    help="The most seconds that a call can ask for (default 300; a call that names none has 30).",
)
@click.option(
    "max_memory",
    "--max-memory",
    metavar="SIZE",
    help="The most memory that a call can ask for, such as 2G (default 4G; a call that names none has 1G).",
)
@click.option(
    "states",
    "--max-states",
    metavar="N",
    type=options.Count(min=1),
    help="The most states that a call can ask to store in a search (default 20000000; a call that names none has "
    "1000000).",
)
@click.option(
    "skill",
    "--copy-skill",
    metavar="DIR",
    type=options.type_of_file,
    help="Copy instructions for agents into DIR/tachk, and end: how to model, how to read a counterexample, how to "
    "diagnose a capture. DIR is where your agent looks for skills.",
)
def command(skill: Path | None, **given: Any) -> None:
    """Offer check, verify, explain, simulate, step, monitor and conform to an agent, by MCP on standard input and
    output.

    An MCP client starts this command; its settings need an entry such as

    \b
    "tachk": {"command": "tachk", "args": ["mcp"]}

    Needs: pip install "tachk[mcp]".

    Exit status: 0 when standard input ends or the skill is copied, 3 where the package mcp is not installed.
    """

    options.finish(lambda: run_mcp(**given) if skill is None else run_copy_skill(skill))


def run_copy_skill(folder: Path) -> ExitStatus:
    """Copies the skill for agents. Raises UsageError where a file that is different would be lost."""
    from tachk.base.resources import data_root
    from tachk.cli.copying import copy_files

    skill = data_root() / "docs/skills/tachk"
    files = (path for path in sorted(skill.rglob("*")) if path.is_file())
    targets = {path: folder / skill.name / path.relative_to(skill) for path in files}
    copy_files(targets, False, "remove it, or name another folder")
    return ExitStatus.AS_EXPECTED


def run_mcp(seconds: float | None, max_memory: str | None, states: int | None) -> ExitStatus:
    """Serves calls until standard input ends. Raises UsageError for a size that is none."""
    from tachk.api.tools.limits import DEFAULT_CEILINGS, ToolLimits
    from tachk.cli.arguments import parse_size

    ceilings = ToolLimits(
        DEFAULT_CEILINGS.seconds if seconds is None else seconds,
        DEFAULT_CEILINGS.megabytes if max_memory is None else max(parse_size(max_memory) // _BYTES_IN_A_MEGABYTE, 1),
        DEFAULT_CEILINGS.states if states is None else states,
    )
    with optional_packages():
        from tachk.api.tools.server import serve
    try:
        serve(ceilings)
    except KeyboardInterrupt:  # how a server is ended: nothing is lost that a message would name
        return ExitStatus.INTERRUPTED
    return ExitStatus.AS_EXPECTED
