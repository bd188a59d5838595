"""Matches acknowledgments to commands.

On the wire an acknowledgment names only the kind of command. TCP keeps order, so it answers the
oldest unanswered command of the kind, unless an earlier one timed out: then it may be the late
answer of that one, and is ignored.
"""

from collections import defaultdict, deque
from dataclasses import dataclass, field

from recon.link.settings import LinkSettings
from recon.model.event import CommandAnswered
from recon.model.report import AckReport, AnsweredKind
from recon.model.units import seconds_to_ns


@dataclass(slots=True)
class AckBook:
    """The unanswered commands of one link. Stick packets are not tracked."""

    link_id: int
    settings: LinkSettings
    ignored_late: int = 0
    unexpected: int = 0
    _waiting: dict[AnsweredKind, deque[tuple[int, int]]] = field(
        default_factory=lambda: defaultdict(deque)
    )
    _missed_at_ns: dict[AnsweredKind, deque[int]] = field(
        default_factory=lambda: defaultdict(deque)
    )

    def sent(self, kind: AnsweredKind, command_id: int, now_ns: int) -> None:
        """Expect an answer to this command."""
        if kind is not AnsweredKind.STICK:
            self._waiting[kind].append((command_id, now_ns))

    def is_waiting(self, kind: AnsweredKind) -> bool:
        """Return whether a command of this kind is unanswered."""
        return bool(self._waiting[kind])

    def answered(self, report: AckReport, arrived_at_ns: int) -> CommandAnswered | None:
        """Return which command an acknowledgment answers, or None when it is ambiguous."""
        if report.answered is AnsweredKind.STICK:
            return None
        missed = self._missed_at_ns[report.answered]
        self._forget_missed(missed, arrived_at_ns)
        if missed:
            missed.popleft()
            self.ignored_late += 1
            return None
        waiting = self._waiting[report.answered]
        if not waiting or arrived_at_ns < waiting[0][1]:
            self.unexpected += 1
            return None
        command_id, _ = waiting.popleft()
        return CommandAnswered(self.link_id, command_id, report.positive)

    def expire(self, now_ns: int) -> list[CommandAnswered]:
        """Return the commands whose acknowledgment timed out."""
        missed: list[CommandAnswered] = []
        for kind, waiting in self._waiting.items():
            while waiting and now_ns - waiting[0][1] >= seconds_to_ns(self.settings.ack_timeout_s):
                command_id, _ = waiting.popleft()
                self._missed_at_ns[kind].append(now_ns)
                missed.append(CommandAnswered(self.link_id, command_id, None))
        for times_ns in self._missed_at_ns.values():
            self._forget_missed(times_ns, now_ns)
        return missed

    def _forget_missed(self, times_ns: deque[int], now_ns: int) -> None:
        """Forget timeouts too old for a late answer."""
        while times_ns and now_ns - times_ns[0] > seconds_to_ns(self.settings.late_ack_s):
            times_ns.popleft()
