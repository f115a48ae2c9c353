"""The states in which a system may be after what was seen of it, by the core: explored step by step as time passes."""

from __future__ import annotations

from collections.abc import Sequence

from tachk import _core
from tachk.base.job import current_job
from tachk.base.records import dataclass
from tachk.engine.compiler.program import Program
from tachk.engine.core_search import core_limits, core_options, reason_of
from tachk.engine.options import Limits, Options
from tachk.engine.program_image import encode

_SLICE = 20_000
"""States that are explored before the time limit is looked at again."""

Window = tuple[int, int]
"""The least and the largest moment, in whole units of the model, rounded outwards."""


@dataclass(frozen=True, slots=True)
class VisibleChannel:
    """A channel of which each synchronisation is an event.

    Attributes:
        channel: its number in the program.
        stream: the events of a stream happen in the order in which they are seen.
        is_input: the environment sends, and the system receives.
        columns: of the event, each the slot that holds it at the end of the step, or a constant.
    """

    channel: int
    stream: int
    is_input: bool
    columns: tuple[tuple[int | None, int], ...]


@dataclass(frozen=True, slots=True)
class PredictedStep:
    """Attributes:
    channel: the place among the visible channels.
    values: of the columns.
    windows: when it may happen, from the present moment on.
    boundaries: where the windows of single transitions begin or end.
    """

    channel: int
    values: tuple[int, ...]
    windows: tuple[Window, ...]
    boundaries: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Prediction:
    """What may happen first if nothing more is seen.

    Attributes:
        steps: the visible steps.
        blocked: channels, by place, with windows in which the system may be unable to receive on them.
        silent_until: how long nothing may be seen; if that is the end of what was explored, perhaps longer.
    """

    steps: tuple[PredictedStep, ...]
    blocked: tuple[tuple[int, Window], ...]
    silent_until: int


class EstimateLimitError(Exception):
    """The set of states cannot be computed: a limit, or a run-time error of the model. Its text says why."""


class StateEstimate:
    """All symbolic states that go along with what was seen up to the present moment, which begins at 0.

    Larsen, Mikucionis, Nielsen, "Online testing of real-time systems using Uppaal" (2004), section 4.
    """

    def __init__(
        self,
        program: Program,
        channels: Sequence[VisibleChannel],
        streams: int,
        marks: Sequence[int | None] = (),
        options: Options = Options(),
        limits: Limits = Limits(),
    ) -> None:
        """The first clock of the program is the time since the present moment: nothing resets it, and an invariant
        bounds it by a constant beyond all moments that are asked for.

        Args:
            marks: for each edge of the program its mark, if it has one; edges may share one.
        """
        described = [(c.channel, c.stream, c.is_input, list(c.columns)) for c in channels]
        self._core = _core.StateEstimate(
            encode(program, ()), core_options(options), core_limits(limits), described, streams, list(marks)
        )

    @property
    def size(self) -> int:
        """The number of symbolic states that are possible now; 0: the system is not as the model says."""
        return self._core.size()

    @property
    def explored(self) -> int:
        """How many symbolic states were explored so far."""
        return self._core.explored()

    def covered(self) -> list[int]:
        """The marks of edges that were taken on the way to each possible state. Of several ways to one, one counts."""
        return self._core.covered()

    def observe(self, stream: int, values: Sequence[int | None], window: Window, optional: bool = False) -> None:
        """Adds an event behind those of its stream. It happened in the window, counted from the present moment."""
        self._core.observe(stream, list(values), *window, optional)

    def advance(self, until: int) -> None:
        """Moves the present moment on. Every event that happened until then has been observed. Raises
        EstimateLimitError."""
        self._core.advance(until)
        self._run()

    def watch(self, edges: Sequence[int]) -> None:
        """From now on `passed` is about these edges of the program."""
        self._core.watch(list(edges))

    @property
    def passed(self) -> bool:
        """Whether one of the watched edges was possible, on some way to the present moment."""
        return self._core.passed()

    def prediction(self, until: int) -> Prediction:
        """What may happen first up to a moment. Raises EstimateLimitError."""
        self._core.predict(until)
        self._run()
        events, blocked, silent = self._core.prediction()
        steps = tuple(
            PredictedStep(channel, tuple(values), tuple(windows), tuple(boundaries))
            for channel, values, windows, boundaries in events
        )
        return Prediction(steps, tuple(blocked), silent)

    def can_conclude(self) -> bool:
        """True if all that was observed can have happened, however the system goes on unseen from now on. Raises
        EstimateLimitError."""
        self._core.conclude()
        self._run()
        return self._core.lead()[0]

    def lead(self, until: int, edges: Sequence[int], states: int) -> PredictedStep | None:
        """The first visible step of a run that takes one of these edges of the program within a time; None if none is
        found among so many states, or no step comes before the edge. Raises EstimateLimitError."""
        self._core.seek(until, list(edges), states)
        self._run()
        _, lead = self._core.lead()
        return None if lead is None else PredictedStep(lead[0], tuple(lead[1]), (lead[2],))

    def _run(self) -> None:
        job = current_job()
        status = _core.Status.RUNNING
        while status is _core.Status.RUNNING:
            job.check()
            status = self._core.run(_SLICE, job.seconds_left, job.check_memory)
        if status is not _core.Status.FINISHED:
            raise EstimateLimitError(reason_of(status))
