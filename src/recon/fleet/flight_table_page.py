"""The flight table as a page of the documentation, written from the table itself."""

from recon.fleet.flight_table import (
    AT_END_M,
    COLUMNS,
    GOOD_GNSS_LEVEL,
    KIND_OF_MODE,
    TABLE,
    Instruction,
    ModeKind,
    Place,
    Verdict,
)

_INTRODUCTION = f"""# The flight table

Written from `src/recon/fleet/flight_table.py` by `make docs`; do not edit it here.

An acknowledgment confirms nothing: telemetry does. This table says what each flight mode means for
what the station has told a vehicle, by the place where the newest telemetry has it. It is the only
place where *started*, *finished*, *taken over by the pilot* and *failsafe* are told apart.

- **carried out**: as ordered. **started**: the mission is flown. **finished**: it is done.
- **pilot**: the station lets go at once. The pilot leads from then on, the order is superseded,
  and nothing is sent that fights them. Someone at the station must take over explicitly.
- **failsafe**: the aircraft does what it does by itself, or the pilot pressed the return or landing
  button; telemetry cannot tell these apart. The order has failed, and an alarm says so.
- **undecided**: nothing follows from it. An order that stays undecided for long fails.

*At its end*: within {AT_END_M:g} m of the last waypoint, on its last leg; for a hold, within
{AT_END_M:g} m of where it began to hold (while GNSS is good). Orders without a place of their own
are always *at their end*. *Sent* rows hold until telemetry shows the order carried out.

A mode counts as **pilot** or **failsafe** only when it is new: when the vehicle was not in it when
it was told. (Of a hold that is left, the place is new.) But for the pilot's own modes and ATTI with
good GNSS it must also have lasted a second, for an app that cancels a mission shows position mode
before it goes home. ATTI is a pilot's choice while the GNSS signal level is {GOOD_GNSS_LEVEL} or
more; below, the aircraft may have fallen back to it by itself.

## Flight modes

| kind | modes of the ICD's table 3 |
|---|---|
"""


def markdown() -> str:
    """Return the whole page."""
    kinds = (f"| {kind.value} | {', '.join(_modes(kind))} |\n" for kind in COLUMNS)
    return "".join([_INTRODUCTION, *kinds, *(_section(told) for told in Instruction)])


def _modes(kind: ModeKind) -> list[str]:
    counted = ModeKind.ATTI_POOR if kind is ModeKind.ATTI_GOOD else kind
    return [f"{m.value} {m.name}" for m, of in KIND_OF_MODE.items() if of is counted]


def _section(told: Instruction) -> str:
    """What one thing told means: kinds of modes with the same verdicts share a row."""
    rows: dict[tuple[Verdict, ...], list[str]] = {}
    for kind in COLUMNS:
        verdicts = tuple(TABLE[told, kind, place] for place in Place)
        rows.setdefault(verdicts, []).append(kind.value)
    head = f"\n## Told: {told.value}\n\n| mode | {' | '.join(place.value for place in Place)} |\n"
    return head + "|---|---|---|---|---|\n" + "".join(_row(k, v) for v, k in rows.items())


def _row(kinds: list[str], verdicts: tuple[Verdict, ...]) -> str:
    return f"| {'; '.join(kinds)} | {' | '.join(_word(v) for v in verdicts)} |\n"


def _word(verdict: Verdict) -> str:
    return f"**{verdict.value}**" if verdict in (Verdict.PILOT, Verdict.FAILSAFE) else verdict.value
