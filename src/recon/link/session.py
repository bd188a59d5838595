"""One app's session as a sans-IO state machine: bytes and times in, events and bytes out.

Theory of operation. Incoming bytes go through the deframer; each intact packet becomes a
`PacketReceived` event, and an acknowledgment also resolves the oldest unanswered command of its
kind (`acks`). Outgoing orders wait in an outbox with three lanes, each holding only the newest
order (`outbox`):

- emergency: sent at once, without pacing;
- motion and camera: sent when the packet gap has passed and, for missions and camera orders, when
  the previous one of their kind is answered. In a setpoint stream the gap is shorter, and a waiting
  camera order takes one turn.

The session closes its link for garbage without a valid packet, for a link without serial number and
telemetry that is silent, and for a client that does not read. A link that reports another serial
drops what waits for the first aircraft. Both drivers, on real sockets and in virtual time, run this
code.

One call does a bounded amount of work; while `is_busy`, the driver calls `resume` in turns with
other links, before it reads on. Each packet is reported with the time at which its last byte was
read. The waits for the rest of a packet count only time in which the station could read: the driver
reports in `tick` whether unread bytes wait, and a long time between two calls is excluded.
"""

from collections.abc import Callable
from dataclasses import dataclass

from recon import wire
from recon.link.acks import AckBook
from recon.link.outbox import Lane, Outbox
from recon.link.settings import LinkSettings
from recon.model.command import FlyMission, Phase, Refusal, VirtualStick
from recon.model.event import CommandDropped, CommandSent, Event, PacketReceived
from recon.model.report import AckReport, CoreReport, ExtendedReport
from recon.model.units import seconds_to_ns
from recon.safety import ApprovedCommand
from recon.vehicles.packets import answered_kind, to_packet
from recon.vehicles.reports import to_report


@dataclass(frozen=True, slots=True)
class Outgoing:
    """One packet to be written to the socket separately, and the event that reports it."""

    data: bytes
    event: CommandSent


Objection = Callable[[ApprovedCommand], Refusal | None]
"""Why an approved order may not be sent at this moment; None: it may."""


def no_objection(_approved: ApprovedCommand) -> Refusal | None:
    """Let every approved order go."""
    return None


class Session:
    """The protocol with one connected app. All times are arguments, in nanoseconds."""

    def __init__(self, link_id: int, settings: LinkSettings, opened_at_ns: int) -> None:
        self.link_id = link_id
        self.settings = settings
        self.closing_reason: str | None = None
        """Set when the connection must be closed; the driver does it."""
        self.bytes_received = 0
        self.acks = AckBook(link_id, settings)
        self._outbox = Outbox.empty(link_id)
        self._deframer = wire.Deframer(
            wire.Limits(
                max_image_rows=settings.max_image_rows,
                max_image_cols=settings.max_image_cols,
                work_per_call=settings.work_per_call,
            )
        )
        self._readable_at_ns = opened_at_ns
        self._last_packet_at_ns = opened_at_ns
        self._telemetry_at_ns: int | None = None
        self._has_packets = False
        self._serial: str | None = None
        self._garbage_at_last_packet = self._damaged_at_last_packet = 0
        self._last_sent_at_ns: int | None = None
        self._last_was_stick = False
        self._blocked_since_ns: int | None = None

    @property
    def counters(self) -> wire.Counters:
        """The deframer's counters."""
        return self._deframer.counters

    @property
    def commands_queued(self) -> int:
        """Number of orders waiting to be sent."""
        return len(self._outbox)

    @property
    def has_packets(self) -> bool:
        """Whether any valid packet has arrived."""
        return self._has_packets

    @property
    def is_identified(self) -> bool:
        """Whether the app has reported a serial number."""
        return self._serial is not None

    @property
    def buffered_bytes(self) -> int:
        """Memory of its half-received packet."""
        return self._deframer.buffered_bytes

    @property
    def is_waiting_for_bytes(self) -> bool:
        """Whether half a packet waits for its rest."""
        return self._deframer.pending_bytes > 0

    @property
    def is_busy(self) -> bool:
        """Whether received bytes wait to be searched: call `resume`."""
        return self._deframer.is_busy

    @property
    def work_done(self) -> int:
        """Bytes searched or hashed so far; a packet counts as 64 KiB."""
        return self._deframer.work_done

    def is_without_telemetry(self, now_ns: int) -> bool:
        """Whether an app without a serial number has sent no telemetry lately."""
        telemetry_ns = self._telemetry_at_ns
        late_ns = seconds_to_ns(self.settings.unidentified_timeout_s)
        return self._serial is None and (telemetry_ns is None or now_ns - telemetry_ns > late_ns)

    def receive(self, data: bytes, now_ns: int) -> list[Event]:
        """Take bytes from the socket; return the events of their packets."""
        self.bytes_received += len(data)
        gap_ns = now_ns - self._readable_at_ns
        if gap_ns > seconds_to_ns(self.settings.read_gap_s):
            self._deframer.excuse(gap_ns)
        self._readable_at_ns = now_ns
        return self._events(self._deframer.feed(data, now_ns))

    def resume(self) -> list[Event]:
        """Go on with received bytes that one call left; return the events of their packets."""
        return self._events(self._deframer.resume())

    def tick(self, now_ns: int, *, has_unread: bool = False) -> list[Event]:
        """Handle timeouts: stalled packets, missed acknowledgments, expired orders, liveness.

        `has_unread`: bytes wait in the socket, so a stalled packet is the station's own delay.
        """
        events: list[Event] = []
        if not has_unread:
            self._readable_at_ns = now_ns
            events += self._events(self._deframer.tick(now_ns))
        events += self.acks.expire(now_ns)
        events += self._outbox.expire(now_ns)
        self._check_liveness(now_ns)
        return events

    def end_stream(self) -> list[Event]:
        """Take the end of the connection; return the events of what is still held."""
        return self._events(self._deframer.finish())

    def drop_unsent(self, reason: str) -> list[CommandDropped]:
        """Drop every order that waits: it fails with `reason`."""
        return self._outbox.empty_out(f"{reason}, before it was sent")

    def finish(self, reason: str) -> list[Event]:
        """End the stream at once: buffered bytes are decoded, unsent orders fail with `reason`."""
        events = self.end_stream()
        while self.is_busy:
            events += self.resume()
        return [*events, *self.drop_unsent(reason)]

    def discard_half_packet(self) -> None:
        """Drop the half-received packet, for its memory."""
        self._deframer.discard()

    def submit(self, approved: ApprovedCommand) -> list[CommandDropped]:
        """Queue an approved command; return the unsent ones it displaces.

        Raises TypeError for anything but an approved command for this link.
        """
        if not isinstance(approved, ApprovedCommand):
            raise TypeError(f"only approved commands are sent, not {type(approved).__name__}")
        if self.link_id not in approved.link_ids:
            raise TypeError(f"approved for links {approved.link_ids}, not for {self.link_id}")
        return self._outbox.put(approved)

    def withdraw_motion(self, reason: str) -> list[CommandDropped]:
        """Drop the unsent mission, stick or takeoff; what was sent cannot be withdrawn."""
        return self._outbox.withdraw_motion(reason)

    def next_packet(
        self, now_ns: int, objection: Objection = no_objection
    ) -> Outgoing | CommandDropped | None:
        """Return the next packet that may be written now; call only while the socket is clear.

        `objection` judges the order again at this moment; with one, the order is dropped instead.
        """
        approved = self._outbox.take(lambda lane, waiting: self._may_go(lane, waiting, now_ns))
        if approved is None:
            return None
        command = approved.command
        refusal = objection(approved)
        if refusal is not None:
            phase, why = Phase.REFUSED_BY_STATION, refusal.reason
            return CommandDropped(self.link_id, command.id, phase, why, refusal)
        self.acks.sent(answered_kind(command.body), command.id, now_ns)
        self._last_sent_at_ns = now_ns
        self._last_was_stick = isinstance(command.body, VirtualStick)
        packet = to_packet(command.body, approved.altitude_offset_m or 0.0)
        return Outgoing(wire.encode(packet), CommandSent(self.link_id, command.id))

    def note_socket(self, is_clear: bool, now_ns: int) -> None:
        """Report whether everything written has left for the network."""
        if is_clear:
            self._blocked_since_ns = None
        elif self._blocked_since_ns is None:
            self._blocked_since_ns = now_ns

    def _may_go(self, lane: Lane, approved: ApprovedCommand, now_ns: int) -> bool:
        if now_ns >= approved.command.expires_at_ns:
            return False
        if lane is Lane.EMERGENCY:
            return True
        last_ns = self._last_sent_at_ns
        if last_ns is not None and now_ns - last_ns < seconds_to_ns(self._gap_s(approved)):
            return False
        return not self._waits_for_answer(lane, approved) and not self._gives_way(approved)

    def _waits_for_answer(self, lane: Lane, approved: ApprovedCommand) -> bool:
        needs_answer_first = lane is Lane.CAMERA or isinstance(approved.command.body, FlyMission)
        return needs_answer_first and self.acks.is_waiting(answered_kind(approved.command.body))

    def _gives_way(self, approved: ApprovedCommand) -> bool:
        """Whether a stick after a stick yields this turn to a camera order.

        A setpoint stream leaves no gap for anything else: without this a camera order would wait
        until the stream ends. It costs the stream one setpoint.
        """
        camera = self._outbox.waiting(Lane.CAMERA)
        return (
            camera is not None
            and self._last_was_stick
            and isinstance(approved.command.body, VirtualStick)
            and not self._waits_for_answer(Lane.CAMERA, camera)
        )

    def _gap_s(self, approved: ApprovedCommand) -> float:
        """Return the minimum time since the previous packet; shorter within a setpoint stream."""
        settings = self.settings
        gap_s = approved.profile.packet_gap_s if approved.profile else settings.packet_gap_s
        is_in_stream = self._last_was_stick and isinstance(approved.command.body, VirtualStick)
        if is_in_stream and gap_s < settings.longest_stick_gap_s:
            return min(gap_s, settings.stick_gap_s)
        return gap_s

    def _events(self, packets: list[wire.Packet]) -> list[Event]:
        events: list[Event] = []
        deframer = self._deframer
        places = zip(packets, deframer.arrivals_ns, deframer.spans, strict=True)
        for packet, arrived_at_ns, (start, end) in places:
            report = to_report(packet)
            if isinstance(report, AckReport):
                answered = self.acks.answered(report, arrived_at_ns)
                if answered is not None:
                    events.append(answered)
            if isinstance(report, ExtendedReport):
                events += self._other_aircraft(report.serial)
            if isinstance(report, CoreReport | ExtendedReport):
                self._telemetry_at_ns = arrived_at_ns
            events.append(PacketReceived(self.link_id, report, arrived_at_ns, start, end))
            self._last_packet_at_ns = arrived_at_ns
        if packets:
            self._has_packets = True
        self._check_garbage(bool(packets))
        return events

    def _other_aircraft(self, serial: str | None) -> list[CommandDropped]:
        """Orders that wait for one aircraft are never sent to another one on the same link."""
        if serial is None or serial == self._serial:
            return []
        is_another = self._serial is not None
        self._serial = serial
        reason = f"the link now reports serial {serial}"
        return self._outbox.empty_out(reason) if is_another else []

    def _check_garbage(self, has_packets: bool) -> None:
        counters = self._deframer.counters
        damaged = counters.bytes_damaged
        garbage = counters.bytes_skipped - damaged
        if has_packets:
            self._garbage_at_last_packet, self._damaged_at_last_packet = garbage, damaged
            return
        garbage -= self._garbage_at_last_packet
        damaged -= self._damaged_at_last_packet
        if garbage > self.settings.garbage_limit_bytes:
            self.closing_reason = f"{garbage} bytes without one valid packet"
        elif damaged > self.settings.damaged_limit_bytes:
            self.closing_reason = f"{damaged} bytes of damaged packets without one valid packet"

    def _check_liveness(self, now_ns: int) -> None:
        silent_ns = now_ns - self._last_packet_at_ns
        is_idle = self._serial is None and self._telemetry_at_ns is None
        if is_idle and silent_ns > seconds_to_ns(self.settings.unidentified_timeout_s):
            self.closing_reason = (
                "no serial number, no telemetry and no valid packet for "
                f"{self.settings.unidentified_timeout_s:g} s"
            )
        since_ns = now_ns if self._blocked_since_ns is None else self._blocked_since_ns
        if now_ns - since_ns > seconds_to_ns(self.settings.stuck_output_timeout_s):
            self.closing_reason = (
                f"the app has not read for {self.settings.stuck_output_timeout_s:g} s"
            )
