"""`tachk completion`: print a script that lets your shell complete commands."""

from __future__ import annotations

import click


@click.command(name="completion")
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]), help="Your shell.")
@click.pass_context
def command(ctx: click.Context, shell: str) -> None:
    """Print a script that lets your shell complete commands, options and files.

    \b
    bash, in ~/.bashrc:  eval "$(tachk completion bash)"
    zsh, in ~/.zshrc:    eval "$(tachk completion zsh)"
    fish, once:          tachk completion fish > ~/.config/fish/completions/tachk.fish
    """
    from click.shell_completion import get_completion_class

    from tachk.cli.console_script import COMPLETION_VARIABLE
    from tachk.cli.main import app

    found = get_completion_class(shell)
    assert found is not None, shell
    print(found(app, {}, "tachk", COMPLETION_VARIABLE).source())
