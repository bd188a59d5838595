"""A world in virtual time whose every step goes through the audit."""

from dataclasses import dataclass, field

from tests.station.station_world import World

from recon.record.audit.audit import AuditEntry, AuditLine, NumberedEntry, decode_line, encode_line
from recon.station.audit.entries import Auditing, audit
from recon.station.state.steps import StepTaken

UTC_NS = 1_748_770_200_000_000_000


@dataclass(slots=True)
class Audited:
    """Collects the entries of a world's steps, with their times."""

    world: World
    entries: list[tuple[int, AuditEntry]] = field(default_factory=list)
    memory: Auditing = field(default_factory=Auditing)

    def __post_init__(self) -> None:
        assert self.world.driver.observe is None
        self.world.driver.observe = self._observe

    def _observe(self, step: StepTaken) -> None:
        now_ns = step.now_ns
        self.memory, entries = audit(self.memory, step.before, step.event, step.after, now_ns)
        self.entries += [(now_ns, entry) for entry in entries]

    def kinds(self, start: str = "") -> list[str]:
        return [entry.kind for _, entry in self.entries if entry.kind.startswith(start)]

    def of(self, kind: str) -> list[AuditEntry]:
        return [entry for _, entry in self.entries if entry.kind == kind]

    def lines(self) -> list[AuditLine]:
        """The entries as they are read back from a file."""
        return [
            decode_line(encode_line(NumberedEntry(n, UTC_NS, at_ns, entry), "0" * 64))
            for n, (at_ns, entry) in enumerate(self.entries, start=1)
        ]
