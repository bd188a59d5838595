"""The link's limits and times, each with its reason."""

from dataclasses import dataclass

MIB = 1024 * 1024


@dataclass(frozen=True, slots=True)
class LinkSettings:
    """Times in seconds, sizes in bytes."""

    packet_gap_s: float = 0.1
    """Least time between two packets to one app: some apps read one packet per segment and drop
    what follows in the same read. A vehicle's profile may set its own. Emergency orders wait for
    no gap."""

    stick_gap_s: float = 0.075
    """Least time from one stick to the next, where the app's gap is longer than that and shorter
    than `longest_stick_gap_s`: a stream at 10 Hz whose beat wavers by some milliseconds must not
    wait for the next tick each time. One lost in the app's read is made good by the next."""

    longest_stick_gap_s: float = 0.2
    """A profile that asks for a longer gap than this is of an app that is slow, and is kept to."""

    ack_timeout_s: float = 2.0
    """Apps acknowledge before they act, so an answer takes a round trip; video delays it."""

    late_ack_s: float = 10.0
    """An acknowledgment names a kind, not a command: within this time after a missed one, the next
    of its kind may still belong to the command that missed it, and is counted but not believed."""

    garbage_limit_bytes: int = 8 * MIB
    """Bytes skipped without a single valid packet between, after which a link is closed."""

    first_packet_timeout_s: float = 30.0
    """A connection that has never delivered a valid packet is closed after this time."""

    stuck_output_timeout_s: float = 5.0
    """A client that does not read: with the socket full this long, the link is closed."""

    send_buffer_bytes: int = 16 * 1024
    """Kept small, so that an emergency order never waits behind much that is in the kernel."""

    max_links: int = 256
    """Connections beyond are refused at once."""

    read_bytes: int = 32 * 1024
    """Taken from one socket at a time: at most 3,640 of the smallest packets, decoded in 10 ms."""

    events_per_turn: int = 64
    """Packets of one link handled before the others get their turn (a few milliseconds); reading
    pauses meanwhile."""

    keepalive_idle_s: int = 15
    keepalive_interval_s: int = 5
    keepalive_probes: int = 3
    """A phone that left without a word is noticed by the kernel within half a minute, so that dead
    connections do not fill the places. The system's own default is two hours."""

    ended_sessions_kept: int = 32
    """Sessions whose counters can still be read after they ended."""

    max_image_rows: int = 2160
    max_image_cols: int = 3840
    """A raw image larger than this is no image (decisions on the ICD, framing 2)."""

    capture_limit_bytes: int = 2 * 1024 * MIB
    """All capture files of a run together."""
