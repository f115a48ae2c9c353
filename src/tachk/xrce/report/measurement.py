"""Measured parameters: as text, as JSON of docs/schema/measure.schema.json, as options of `tachk verify`."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from tachk.base.plain_data import Fields, PlainData
from tachk.base.records import dataclass
from tachk.report.json_text import LongList
from tachk.xrce.measuring.measure import Measurement
from tachk.xrce.measuring.quantity import Observation, PackedSamples, PacketPlace, Quantity
from tachk.xrce.measuring.settings import Setting

_PLACES = 6
"""So many packets are named in a text; JSON has all of them."""


@dataclass(frozen=True, slots=True)
class ModelTime:
    """Options for writing settings.

    Attributes:
        milliseconds: in a unit of time of the model.
        constants: those that the model has; None for a model that is not known, which may have all of them.
        model: its name.
    is_for_recordings: whether recordings are held against it.
    """

    milliseconds: float = 1.0
    constants: frozenset[str] | None = None
    model: str = ""
    is_for_recordings: bool = False

    def all(self, found: Measurement) -> tuple[Setting, ...]:
        """The settings for such models."""
        return found.recorded if self.is_for_recordings else found.settings

    def chosen(self, found: Measurement) -> list[Setting]:
        """The settings that the model has."""
        return [one for one in self.all(found) if self.constants is None or one.name in self.constants]


def settings_line(found: Measurement, time: ModelTime) -> str:
    """``-D NAME=VALUE`` for each setting, in a line that a shell takes apart."""
    return " ".join(f"-D {one.name}={one.in_units(time.milliseconds)}" for one in time.chosen(found))


def measurement_to_json(found: Measurement, time: ModelTime) -> dict[str, Any]:
    """The measurement as a dictionary for `json_pieces`."""
    return {
        **PlainData(_FORMS).of(found),
        "unit_ms": time.milliseconds,
        "settings": [_setting_to_json(one, time) for one in time.chosen(found)],
        "recorded_settings": [_setting_to_json(one, ModelTime()) for one in found.recorded],
    }


_FORMS: dict[type, Fields | Callable[[Any], object]] = {
    Measurement: Fields("files problems quantities"),
    Quantity: Fields(
        "name title unit value min=minimum median max=maximum count confidence how samples",
        count=lambda quantity: len(quantity.samples),
        samples=lambda quantity: _samples_to_json(quantity.samples),
    ),
    LongList: lambda samples: samples,
    Observation: Fields("value packets=places"),
}


def _samples_to_json(samples: Sequence[Observation]) -> list[Observation] | LongList:
    if not isinstance(samples, PackedSamples):
        return list(samples)
    return LongList(
        {"value": value, "packets": [{"file": file, "packet": packet} for file, packet in places]}
        for value, places in samples.rows()
    )


def _setting_to_json(setting: Setting, time: ModelTime) -> dict[str, Any]:
    return {
        "name": setting.name,
        "value": setting.in_units(time.milliseconds),
        "ms": setting.value if setting.is_time else None,
        "confidence": setting.confidence.value,
        "how": setting.how,
    }


def measurement_to_text(found: Measurement, time: ModelTime) -> str:
    """Quantities that were seen, those that were not, and settings."""
    known = [quantity for quantity in found.quantities if quantity.samples]
    unknown = [quantity for quantity in found.quantities if not quantity.samples]
    lines = ["  value          min / median / max               seen  what"]
    for quantity in known:
        lines += _quantity_lines(quantity, len(found.files) > 1)
    if unknown:
        lines += ["", "not enough evidence:", *(f"  {quantity.title}: {quantity.how}" for quantity in unknown)]
    chosen = time.chosen(found)
    scale = "" if time.milliseconds == 1 else f", in units of {time.milliseconds:g} ms"
    lines += ["", f"settings{f' for {time.model}' if time.model else ''}{scale}:", *_setting_lines(chosen, time)]
    coarse = [one for one in chosen if one.is_time and _is_coarse(one, time)]
    if coarse:
        listed = ", ".join(f"{one.name} is {one.value:g} ms" for one in coarse)
        lines.append(f"the unit of {time.milliseconds:g} ms is too coarse: {listed}")
    left_out = [one.name for one in time.all(found) if one not in chosen]
    if left_out:
        lines.append(f"{time.model} has no constant {', '.join(left_out)}")
    if not time.model:
        lines += ["settings for models of recordings, in ms:", *_setting_lines(list(found.recorded), time)]
    return "\n".join(lines) + "\n"


def _is_coarse(setting: Setting, time: ModelTime) -> bool:
    """True if a time in units of the model is more than 2 % off."""
    return abs(setting.in_units(time.milliseconds) * time.milliseconds - setting.value) > setting.value / 50


def _quantity_lines(quantity: Quantity, several: bool) -> Iterator[str]:
    spread = " / ".join(_number(value) for value in (quantity.minimum, quantity.median, quantity.maximum))
    value = "?" if quantity.value is None else f"{_number(quantity.value)} {quantity.unit.value}".rstrip()
    yield f"  {value:<13}  {spread:<31}  {len(quantity.samples):>4}  {quantity.title}"
    places = _places(*quantity.first_places(_PLACES), several)
    yield f"      {quantity.confidence.value}: {quantity.how}{f'; {places}' if places else ''}"


def _places(first: Sequence[PacketPlace], count: int, several: bool) -> str:
    if not first:
        return ""
    listed = [f"{place.file}:{place.packet}" if several else str(place.packet) for place in first]
    more = f" and {count - _PLACES} more" if count > _PLACES else ""
    return f"packet{'s' if count > 1 else ''} {', '.join(listed)}{more}"


def _setting_lines(settings: Sequence[Setting], time: ModelTime) -> Iterator[str]:
    written = [f"-D {one.name}={one.in_units(time.milliseconds)}" for one in settings]
    width = max(map(len, written), default=0)
    for text, one in zip(written, settings, strict=True):
        yield f"  {text:<{width}}  {one.confidence.value}: {one.how}"


def _number(value: float | None) -> str:
    """A number with four digits that matter."""
    if value is None:
        return "?"
    return f"{value:.0f}" if abs(value) >= 1000 or value == int(value) else f"{value:.4g}"
