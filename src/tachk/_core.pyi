from collections.abc import Sequence

class Explorer:
    def __init__(
        self,
        image: Sequence[int],
        *,
        order: int,
        seed: int,
        extrapolation: int,
        local_bounds: bool,
        subsumption: bool,
        narrow: bool,
        vector: bool,
        state_limit: int,
        memory_limit: int,
        depth_limit: int,
    ) -> None: ...
    def run(self, expansions: int) -> int: ...
    def statistics(self) -> tuple[int, int, int, int]: ...
    def reached(self, goal: int) -> int | None: ...
    def path(self, node: int) -> list[list[int]]: ...
    def fault(self) -> tuple[int, int, list[list[int]], list[int]] | None: ...
    def kernel(self) -> str: ...
