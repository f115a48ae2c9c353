"""A console script whose command line click reads."""

from __future__ import annotations

from typing import NoReturn

import click

from tachk.cli.console_script import end_program


def end_with(command: click.Command, name: str, completion: str | None = None) -> NoReturn:
    """Carries out the command line of the process and ends the program with its status.

    Args:
        name: of the program.
        completion: the variable with which shells ask to complete a line.
    """

    def status() -> int | None:
        try:
            found = command.main(prog_name=name, complete_var=completion, standalone_mode=False)
        except click.ClickException as error:
            error.show()
            return error.exit_code
        except click.Abort:
            raise KeyboardInterrupt from None
        assert found is None or isinstance(found, int)
        return found

    end_program(status)
