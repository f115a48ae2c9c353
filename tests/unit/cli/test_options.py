"""Choices stand for the members of the enums of the domain, and each is written as its value."""

from __future__ import annotations

from collections.abc import Iterable

import click
import pytest

from tachk.cli import main, options
from tachk.cli.distribution import distributed
from tachk.cli.main import COMMANDS, FOLDERS, HIDDEN, SECTIONS, app, load_command
from tachk.engine.options import Extrapolation, Limits, Options, SearchOrder
from tachk.formats.catalogue import EXPORT_FORMATS, SUFFIXES
from tachk.formats.uppaal.versions import UppaalVersion
from tachk.recordings.traces.conventions import Interpolation, TraceEnding
from tachk.recordings.traces.trace_files import FORMATS


def command(name: str) -> click.Command:
    found: click.Command = app
    for word in name.split():
        assert isinstance(found, click.Group)
        within = found.get_command(click.Context(found), word)
        assert within is not None
        found = within
    return found


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_is_called_as_it_is_listed(name: str) -> None:
    assert command(name).name == name.split()[-1]
    assert command(name).get_short_help_str()


def test_the_lines_of_the_help_are_about_commands_and_not_wrapped() -> None:
    lines = [line for section in SECTIONS.values() for line in section.items()]
    assert {name for name, _ in lines} <= {*COMMANDS, *FOLDERS}
    assert len({name for name, _ in lines}) == len(lines)
    assert max(len(summary) for _, summary in lines) <= 78 - 2 - max(len(name) for name, _ in lines) - 2


def test_a_command_without_a_section_comes_last(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(main, "SECTIONS", {"Verify": {"verify": "Check the properties of models."}})
    monkeypatch.setattr(main, "TOP_LEVEL", ("verify", "fmt"))
    told = app.get_help(click.Context(app, info_name="tachk"))
    assert told[told.index("Verify:") :].split() == (
        [
            "Verify:",
            "verify",
            "Check",
            "the",
            "properties",
            "of",
            "models.",
            "More",
            "commands:",
            "fmt",
            "Rewrite",
            "models",
            "in",
            "canonical",
            "form.",
        ]
    )


def test_the_help_fits_one_screen_and_lists_every_command() -> None:
    told = app.get_help(click.Context(app, info_name="tachk"))
    assert len(told.splitlines()) <= 40
    listed = {
        line.split()[0]
        for line in told[told.index("Write and run models") :].splitlines()
        if line.startswith("  ") and line[2:3].islower()
    }
    assert listed == {*(name.split()[0] for name in COMMANDS)} - {*HIDDEN}


def test_eight_options_of_verify_come_before_the_headings() -> None:
    verify = command("verify")
    told = verify.get_help(click.Context(verify))
    first = told[told.index("\nOptions:") : told.index("\nMeaning:")]
    assert len([line for line in first.splitlines() if line.startswith("  -")]) == 8
    assert all(f"{option.opts[-1]} " in told for option in verify.params if isinstance(option, click.Option))


@pytest.mark.parametrize(
    ("name", "option", "values"),
    [
        ("verify", "order", SearchOrder),
        ("verify", "extrapolation", Extrapolation),
        ("convert", "form", ["ta", *EXPORT_FORMATS, "fmu"]),
        ("check", "version", UppaalVersion),
        ("monitor", "ending", TraceEnding),
        ("monitor", "interpolation", Interpolation),
    ],
)
def test_choices_are_the_values_that_exist(name: str, option: str, values: Iterable[str]) -> None:
    (parameter,) = [found for found in command(name).params if found.name == option]
    assert isinstance(parameter.type, click.Choice)
    assert set(parameter.type.choices) == set(values)


@pytest.mark.parametrize("name", ["monitor", "plot"])
def test_the_help_names_every_format_of_traces(name: str) -> None:
    (trace,) = [found for found in command(name).params if found.name == "trace"]
    assert isinstance(trace, click.Argument)
    assert all(known.name in str(trace.help) for known in FORMATS)


def test_the_help_names_every_format_of_models() -> None:
    assert all(suffix in str(command("convert").help) for suffix in SUFFIXES)


def test_an_option_that_nobody_takes_is_a_defect() -> None:
    assert distributed({"states": 3, "seed": 4}, Options, Limits) == [Options(seed=4), Limits(states=3)]
    with pytest.raises(AssertionError, match="colour"):
        distributed({"states": 3, "colour": "red"}, Limits)


def test_a_misspelt_command_is_guessed_without_loading_the_others(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        app(["explainn"], prog_name="tachk")
    assert end.value.code == 2
    assert "Did you mean 'explain'?" in capsys.readouterr().err


NUMBERS = [
    (name, option)
    for name in COMMANDS
    for option in load_command(name).params
    if isinstance(option.type, click.types.FloatParamType | click.types.IntParamType)
]
"""The numeric options of all commands."""


@pytest.mark.parametrize("value", ["nan", "inf", "-inf", "1e999", ""])
@pytest.mark.parametrize(("name", "option"), NUMBERS, ids=[f"{name} {option.opts[-1]}" for name, option in NUMBERS])
def test_a_numeric_option_takes_finite_numbers_only(name: str, option: click.Parameter, value: str) -> None:
    with pytest.raises(click.BadParameter, match=r"is not a (finite number|valid)"):
        option.type_cast_value(click.Context(load_command(name)), [value] if option.multiple else value)


def test_minus_zero_is_zero() -> None:
    assert options.Seconds(min=0).convert("-0", None, None) == 0
