"""A simulated TCP connection between an app and the station, in virtual time."""

import random
from collections.abc import Callable
from dataclasses import dataclass, field


@dataclass(slots=True)
class FakeLink:
    """A simulated TCP connection. It delivers in order, so a delay delays all that follows.

    `damage` may change, cut or drop a chunk on its way to the station. A dead link drops everything
    silently, as a sleeping phone does.
    """

    delay_s: float = 0.02
    jitter_s: float = 0.0
    damage: Callable[[bytes, random.Random], bytes] | None = None
    is_dead: bool = False
    seed: int = 0
    rng: random.Random = field(init=False)

    def __post_init__(self) -> None:
        self.rng = random.Random(self.seed)
