"""The flight table as a documentation page: `python -m tools.flight_table_page` prints it."""

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

Generated from `src/recon/fleet/flight_table.py` by `make docs`; do not edit it here.

Telemetry confirms an order, an acknowledgment does not. This table gives the meaning of each flight
mode for the last instruction to a vehicle and the place where telemetry shows it. It is the only
place that distinguishes *started*, *finished*, *taken over by the pilot* and *failsafe*.

- **carried out**: as ordered. **started**: the mission is being flown. **finished**: complete.
- **pilot**: the station stops commanding at once. The pilot has control authority, the order is
  replaced, and nothing more is sent. An operator must take control explicitly.
- **failsafe**: the aircraft acts on its own, or the pilot pressed the return or landing button;
  telemetry cannot distinguish these. The order fails with an alarm.
- **undecided**: no conclusion. An order that stays undecided for long fails.

*At its end*: within {AT_END_M:g} m of the last waypoint, on its last leg; for a hold, within
{AT_END_M:g} m of the position where the hold began (while GNSS is good). Orders without a target
are always *at their end*. *Sent* rows apply until telemetry confirms the order.

A mode counts as **pilot** or **failsafe** only when it is new: the vehicle was not in it when the
instruction was sent. (When a hold is left, the position is what is new.) Except for pilot modes and
ATTI with good GNSS it must also last a second, because an app that cancels a mission passes through
position mode before it returns home. ATTI is the pilot's choice while the GNSS signal level is
{GOOD_GNSS_LEVEL} or more; below, the aircraft may have fallen back to it.

## Flight modes

| kind | modes of the ICD's table 3 |
|---|---|
"""


def markdown() -> str:
    """Return the whole page."""
    kinds = (f"| {kind.value} | {', '.join(_modes(kind))} |\n" for kind in COLUMNS)
    return "".join([_INTRODUCTION, *kinds, *(_section(each) for each in Instruction)])


def _modes(kind: ModeKind) -> list[str]:
    counted = ModeKind.ATTI_POOR if kind is ModeKind.ATTI_GOOD else kind
    return [f"{m.value} {m.name}" for m, of in KIND_OF_MODE.items() if of is counted]


def _section(instruction: Instruction) -> str:
    """One instruction; kinds of modes with the same verdicts share a row."""
    rows: dict[tuple[Verdict, ...], list[str]] = {}
    for kind in COLUMNS:
        verdicts = tuple(TABLE[instruction, kind, place] for place in Place)
        rows.setdefault(verdicts, []).append(kind.value)
    places = " | ".join(place.value for place in Place)
    head = f"\n## Instruction: {instruction.value}\n\n| mode | {places} |\n"
    return head + "|---|---|---|---|---|\n" + "".join(_row(k, v) for v, k in rows.items())


def _row(kinds: list[str], verdicts: tuple[Verdict, ...]) -> str:
    return f"| {'; '.join(kinds)} | {' | '.join(_word(v) for v in verdicts)} |\n"


def _word(verdict: Verdict) -> str:
    return f"**{verdict.value}**" if verdict in (Verdict.PILOT, Verdict.FAILSAFE) else verdict.value


if __name__ == "__main__":
    print(markdown(), end="")
