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
    than `longest_stick_gap_s`: a 10 Hz stream with some milliseconds of
    jitter must not wait for the next tick each time. A setpoint lost in the app is repaired by
    the next one."""

    longest_stick_gap_s: float = 0.2
    """A profile with a longer gap than this belongs to a slow app, and is respected."""

    ack_timeout_s: float = 2.0
    """Apps acknowledge before they act, so an answer takes a round trip; video delays it."""

    late_ack_s: float = 10.0
    """An acknowledgment names a kind, not a command: within this time after a missed one, the next
    of its kind may still belong to the command that missed it, and is counted but ignored."""

    garbage_limit_bytes: int = 8 * MIB
    """Bytes that belong to no frame, without a single valid packet between, after which a link is
    closed."""

    damaged_limit_bytes: int = 128 * MIB
    """The same for bytes of frames that were damaged or never completed: five raw 4K images. One
    flipped bit or a pause of the app costs a whole image, and no link."""

    unidentified_timeout_s: float = 10.0
    """A connection without a serial number and without telemetry gives up its place after this time
    without a valid packet. Apps send telemetry ten times a second."""

    buffer_budget_bytes: int = 256 * MIB
    """Memory of half-received packets, of all links together: ten raw 4K images at once."""

    work_per_call: int = 4 * MIB
    """Bytes searched or hashed for one link before others get their turn: a millisecond or two. A
    packet counts as 64 KiB."""

    read_gap_s: float = 0.25
    """Time without a read or a tick (five ticks) after which the station itself did not run: it
    does not count against a half-received packet."""

    stuck_output_timeout_s: float = 5.0
    """Time with a full socket after which the client is not reading, and the link is closed."""

    send_buffer_bytes: int = 16 * 1024
    """Small, so that an emergency order never waits behind much data in the kernel."""

    max_links: int = 256
    """Further connections are refused, unless an unidentified link without telemetry gives way."""

    limit_alarm_s: float = 10.0
    """How long an alarm about dropped packets stays active after the last one."""

    read_bytes: int = 32 * 1024
    """Taken from one socket at a time: at most 3,640 of the smallest packets, decoded in 10 ms."""

    events_per_turn: int = 64
    """Packets of one link handled before other links get their turn (a few milliseconds); reading
    pauses meanwhile."""

    keepalive_idle_s: int = 15
    keepalive_interval_s: int = 5
    keepalive_probes: int = 3
    """The kernel detects a vanished phone within half a minute, so that dead connections do not use
    up the links. The system's own default is two hours."""

    ended_sessions_kept: int = 32
    """Sessions whose counters can still be read after they ended."""

    max_image_rows: int = 2160
    max_image_cols: int = 3840
    """A larger raw image is invalid (decisions on the ICD, framing 2)."""
