"""The context that all objects of z3 share."""

from __future__ import annotations

from functools import cache


@cache
def release_from_any_thread() -> None:
    """Lets any thread release objects of z3 while another one solves.

    Python collects garbage in whichever thread makes some. Without this, z3 frees the object at once, in the middle of
    what the other thread does.
    """
    import z3

    z3.Z3_enable_concurrent_dec_ref(z3.main_ctx().ref())
