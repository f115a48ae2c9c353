"""The server of tools on the standard streams, by the Model Context Protocol (MCP), over its official SDK.

Each call runs in a process of its own, so that a call that is cancelled, takes too long or crashes ends with its
process, and the server goes on. This is the only module that uses the SDK.
"""

from __future__ import annotations

import asyncio
import signal
from contextlib import suppress
from functools import partial
from typing import Any

import anyio
import anyio.to_process
import mcp_types as types
from mcp.server.lowlevel import Server
from mcp.server.stdio import stdio_server

import tachk
from tachk.api.tools.answer import ToolAnswer
from tachk.api.tools.catalogue import TOOLS, call
from tachk.api.tools.instructions import INSTRUCTIONS
from tachk.api.tools.limits import DEFAULT_LIMITS, ToolLimits

_GRACE = 15.0
"""Seconds that a call may take beyond its limit, which it observes itself, before its process is ended."""


def serve(ceilings: ToolLimits) -> None:
    """Answers requests on standard input until it ends. Raises KeyboardInterrupt for Ctrl-C.

    Args:
        ceilings: the largest limits that a call can have.
    """
    anyio.run(_serve, ceilings)


async def _serve(ceilings: ToolLimits) -> None:
    server: Server[Any] = Server(
        "tachk",
        version=tachk.__version__,
        title="tachk: model checking of timed automata",
        instructions=INSTRUCTIONS,
        on_list_tools=partial(_list_tools, ceilings),
        on_call_tool=partial(_call_tool, ceilings),
    )
    _end_between_steps()
    async with stdio_server() as (incoming, outgoing):
        await server.run(incoming, outgoing, server.create_initialization_options())


def _end_between_steps() -> None:
    """Lets the handlers of signals, which raise KeyboardInterrupt, run between two steps of the event loop (but on
    Windows, where it cannot): inside a step, what they raise would come out of a task that another one awaits."""
    for number in (signal.SIGINT, signal.SIGTERM):
        handler = signal.getsignal(number)
        if callable(handler):
            with suppress(NotImplementedError):
                asyncio.get_running_loop().add_signal_handler(number, handler, number, None)


async def _list_tools(ceilings: ToolLimits, context: Any, params: Any) -> types.ListToolsResult:
    return types.ListToolsResult(
        tools=[
            types.Tool(
                name=tool.name,
                title=tool.title,
                description=tool.description,
                input_schema=tool.input_schema(ceilings),
                output_schema=tool.answers(),
                annotations=types.ToolAnnotations(read_only_hint=True, idempotent_hint=True, open_world_hint=False),
            )
            for tool in TOOLS
        ]
    )


async def _call_tool(ceilings: ToolLimits, context: Any, params: types.CallToolRequestParams) -> types.CallToolResult:
    found = await _answer(ceilings, params.name, params.arguments or {})
    return types.CallToolResult(
        content=[types.TextContent(type="text", text=found.text)],
        structured_content=found.structured,
        is_error=found.failed,
    )


async def _answer(ceilings: ToolLimits, name: str, arguments: dict[str, Any]) -> ToolAnswer:
    seconds = arguments.get("seconds", DEFAULT_LIMITS.seconds)
    wanted = seconds if isinstance(seconds, int | float) else ceilings.seconds
    with anyio.move_on_after(min(wanted, ceilings.seconds) + _GRACE):
        try:
            return await anyio.to_process.run_sync(call, name, arguments, ceilings, cancellable=True)
        except anyio.BrokenWorkerProcess:
            return ToolAnswer("error: the process of this call has ended before there was a result; the server goes on")
    return ToolAnswer("error: the call was ended, as it went on long after its time limit")
