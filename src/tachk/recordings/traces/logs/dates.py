"""Times as text: numbers, or dates by ISO 8601."""

from __future__ import annotations

import re
from datetime import UTC, datetime, timedelta
from fractions import Fraction

from tachk.base.exact_numbers import exact_number

_DATE = re.compile(r"\d{4}-\d\d-\d\d(\D.*)?")
_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)


def is_date(text: str) -> bool:
    """True if a time is written as a date."""
    return _DATE.fullmatch(text.strip()) is not None


def date_text(seconds: Fraction) -> str:
    """A time in seconds since 1970 as a date of universal time, with as many decimals as it has, at most nine."""
    nanoseconds = round(seconds * 10**9)
    whole, rest = divmod(nanoseconds, 10**9)
    fraction = f".{rest:09}".rstrip("0") if rest else ""
    try:
        return f"{(_EPOCH + timedelta(seconds=whole)).replace(tzinfo=None).isoformat()}{fraction}Z"
    except OverflowError:  # a deadline in the year 10000
        return f"{whole} s since 1970"


def seconds_of(text: str) -> Fraction:
    """A number as it is; a date and time in seconds since 1970, without a zone as universal time. Raises ValueError."""
    text = text.strip()
    if not is_date(text):
        return exact_number(text)
    main, point, rest = text.partition(".")
    digits = re.match(r"\d*", rest)
    fraction = digits.group() if digits else ""
    read = datetime.fromisoformat(main + rest[len(fraction) :])
    if point and not fraction:
        raise ValueError(text)
    if read.tzinfo is None:
        read = read.replace(tzinfo=UTC)
    elapsed = read - _EPOCH
    whole = Fraction(elapsed.days * 86400 + elapsed.seconds) + Fraction(elapsed.microseconds, 10**6)
    return whole + (Fraction(int(fraction), 10 ** len(fraction)) if fraction else 0)
