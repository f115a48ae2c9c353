"""The program `tachkc`, which is beside `tachk` in a folder of scripts and uses the server of that."""

from __future__ import annotations

import os
import sys
import sysconfig
from contextlib import suppress

from tachk.cli.server.identity import interpreter_options, key, key_of_scripts, package_folder, usual_socket


def key_of_own_scripts() -> str | None:
    """The key of the `tachkc` beside the Python of this process; None where the `tachk` there may be another one."""
    folder = os.path.realpath(os.path.dirname(sys.executable))
    package = os.path.join(sysconfig.get_path("platlib"), "tachk")
    is_plain = not interpreter_options() and sys.getfilesystemencoding() == "utf-8"
    if is_plain and os.path.realpath(package) == os.path.realpath(package_folder()):
        return key_of_scripts(folder)
    return None


def name_for_scripts(path: str) -> None:
    """Lets `tachkc` find the socket of this server, if it is the usual one, by a link with the name that it expects."""
    own = key_of_own_scripts()
    if own is None or path != usual_socket(key()):
        return
    link = usual_socket(own)
    with suppress(OSError):
        temporary = f"{link}.{os.getpid()}"
        os.symlink(os.path.basename(path), temporary)
        os.replace(temporary, link)
