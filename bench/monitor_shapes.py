"""The seven shapes of bench/monitors.py, as each monitor writes them, and a trace that satisfies them.

This module is also imported by the Python that has the other monitors, so it needs nothing but NumPy.

Times are in seconds. p is x > 0.99 and holds in one row of a hundred; q is y > 0.9, in one of ten. `{w}` stands for
the window, 180 s but where windows are compared. reelay looks at the past only: its formulas say the same about the
trace as a whole, each obligation at its deadline. A shape that a monitor cannot say is missing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

NAMES = ("BR", "BI", "ND", "NE", "RE", "UN", "PR")
WINDOWED = ("BR", "NE", "RE", "UN", "PR")
"""Those whose window is varied."""

MEANINGS = {
    "BR": "G(p -> F[0,180] q)",
    "BI": "G(p -> G[0,50] !q')",
    "ND": "G(p -> q'')",
    "NE": "G(p -> F[0,180](q && G[0,20] r))",
    "RE": "G F[0,180] q",
    "UN": "G(p -> (r' U[0,180] q))",
    "PR": "G(p -> O[0,180] q)",
}

TACHK = {
    "BR": "G (x > 0.99 -> F[0,{w} s] y > 0.9)",
    "BI": "G (x > 0.99 -> G[0,50 s] !(y > 0.99))",
    "ND": "G (x > 0.99 -> y > 0.5)",
    "NE": "G (x > 0.99 -> F[0,{w} s] (y > 0.9 && G[0,20 s] z < 0.99))",
    "RE": "G F[0,{w} s] y > 0.9",
    "UN": "G (x > 0.99 -> (z < 0.999 U[0,{w} s] y > 0.9))",
    "PR": "G (x > 0.99 -> O[0,{w} s] y > 0.9)",
}

REELAY = {
    "BR": "historically(once[180:180]{x > 0.99} -> once[0:180]{y > 0.9})",
    "BI": "historically(once[0:50]{x > 0.99} -> not {y > 0.99})",
    "ND": "historically({x > 0.99} -> {y > 0.5})",
    "NE": "historically(once[200:200]{x > 0.99} -> once[0:180](once[20:20]{y > 0.9} and historically[0:20]{z < 0.99}))",
    "RE": "historically(once[0:180]{y > 0.9})",
    "UN": "historically("
    "not(({y <= 0.9} and {z >= 0.999}) and ({y <= 0.9} since[0:180] ({x > 0.99} and {y <= 0.9}))) and "
    "not({y <= 0.9} since[180:180] ({x > 0.99} and {y <= 0.9})))",
    "PR": "historically({x > 0.99} -> once[0:180]{y > 0.9})",
}

# mstlo has no outermost G: it gives a verdict for every instant. It looks ahead only.
MSTLO = {
    "BR": "(x > 0.99) -> (F[0, 180](y > 0.9))",
    "BI": "(x > 0.99) -> (G[0, 50](!(y > 0.99)))",
    "ND": "(x > 0.99) -> (y > 0.5)",
    "NE": "(x > 0.99) -> (F[0, 180]((y > 0.9) && (G[0, 20](z < 0.99))))",
    "RE": "F[0, 180](y > 0.9)",
    "UN": "(x > 0.99) -> ((z < 0.999) U[0, 180] (y > 0.9))",
}

# Windows of `alw` need an end: that of the trace, less what the rest looks ahead. Until crashes, there is no past.
STLROM = {
    "BR": ("alw_[0, {end}] ((x[t] > 0.99) => ev_[0, 180] (y[t] > 0.9))", 180),
    "BI": ("alw_[0, {end}] ((x[t] > 0.99) => alw_[0, 50] (not (y[t] > 0.99)))", 50),
    "ND": ("alw_[0, {end}] ((x[t] > 0.99) => (y[t] > 0.5))", 0),
    "NE": ("alw_[0, {end}] ((x[t] > 0.99) => ev_[0, 180] ((y[t] > 0.9) and (alw_[0, 20] (z[t] < 0.99))))", 200),
    "RE": ("alw_[0, {end}] ev_[0, 180] (y[t] > 0.9)", 180),
}

RTAMT = {
    "BR": "always((x > 0.99) implies eventually[0:180](y > 0.9))",
    "BI": "always((x > 0.99) implies always[0:50](not(y > 0.99)))",
    "ND": "always((x > 0.99) implies (y > 0.5))",
    "NE": "always((x > 0.99) implies eventually[0:180]((y > 0.9) and always[0:20](z < 0.99)))",
    "RE": "always(eventually[0:180](y > 0.9))",
    "UN": "always((x > 0.99) implies ((z < 0.999) until[0:180] (y > 0.9)))",
    "PR": "always((x > 0.99) implies once[0:180](y > 0.9))",
}

MOONLIGHT = {
    "BR": "globally ((x > 0.99) -> (eventually [0, 180] (y > 0.9)))",
    "BI": "globally ((x > 0.99) -> (globally [0, 50] (!(y > 0.99))))",
    "ND": "globally ((x > 0.99) -> (y > 0.5))",
    "NE": "globally ((x > 0.99) -> (eventually [0, 180] ((y > 0.9) & (globally [0, 20] (z < 0.99)))))",
    "RE": "globally (eventually [0, 180] (y > 0.9))",
    "UN": "globally ((x > 0.99) -> ((z < 0.999) until [0, 180] (y > 0.9)))",
    "PR": "globally ((x > 0.99) -> (once [0, 180] (y > 0.9)))",
}


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """Attributes:
    milliseconds: of each row, strictly rising from 0.
    """

    milliseconds: NDArray[np.int64]
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    z: NDArray[np.float64]

    def table(self) -> NDArray[np.float64]:
        """One row of time in seconds, x, y, z for each sample."""
        return np.stack([self.milliseconds / 1000, self.x, self.y, self.z], axis=1)


def make_rows(count: int, seed: int = 1) -> Rows:
    """Uniform noise at irregular instants, one row a second on average, mended where a shape would be violated.

    So no monitor can stop before the end. In the last 400 s there is no p, so nothing but RE is open at the end.
    """
    random = np.random.default_rng(seed)
    times = np.cumsum(random.integers(1, 2000, count))
    times -= times[0]
    x, y, z = random.random(count), random.random(count), random.random(count)
    x = np.where(times > times[-1] - 400_000, 0.5 * x, x)
    trigger = x > 0.99
    # p is true up to the row after; what has to hold for 50 s (BI) or up to q (UN) counts from there.
    ended = np.zeros(count, dtype=bool)
    ended[1:] = trigger[:-1]
    since = times - np.maximum.accumulate(np.where(ended, times, np.int64(-(10**15))))
    y = np.where(trigger | (since <= 50_000), np.minimum(y, 0.9899), y)
    period = times // 90_000
    begins = np.ones(count, dtype=bool)
    begins[1:] = period[1:] != period[:-1]
    y = np.where(begins, 0.95, y)
    y = np.where(trigger, np.maximum(y, 0.6), y)
    z = np.where(times - 90_000 * period <= 40_000, 0.98 * z, z)
    z = np.where(trigger | (since <= 100_000), np.minimum(z, 0.9985), z)
    return Rows(times.astype(np.int64), x, y, z)
