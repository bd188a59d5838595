"""A flight in parts, where a program holds fewer waypoints than it has."""

from collections.abc import Iterator
from dataclasses import replace

from recon.plans.flight_plan import ExportedPlan, PlanExportError


def parts_of(plan: ExportedPlan, most_waypoints: int, who: str) -> tuple[ExportedPlan, ...]:
    """Return a flight in parts that are cut between rows, each flown from takeoff to its end.

    Raises `PlanExportError` where a row alone has more waypoints than `who` holds.
    """
    if len(plan.waypoints) <= most_waypoints:
        return (plan,)
    spans = list(_spans(plan, most_waypoints, who))
    return tuple(
        _part(plan, number, first, last) for number, (first, last) in enumerate(spans, start=1)
    )


def _spans(plan: ExportedPlan, most: int, who: str) -> Iterator[tuple[int, int]]:
    """Yield the first and the last waypoint of each part: whole rows, as many as fit."""
    begun: tuple[int, int] | None = None
    for first, last in plan.rows or ((0, len(plan.waypoints) - 1),):
        if last - first + 1 > most:
            raise PlanExportError(
                f"{plan.name}: {who} holds {most} waypoints, and one row has {last - first + 1}: "
                "divide the region"
            )
        if begun is not None and last - begun[0] + 1 > most:
            yield begun
            begun = None
        begun = (first if begun is None else begun[0], last)
    assert begun is not None
    yield begun


def _part(plan: ExportedPlan, number: int, first: int, last: int) -> ExportedPlan:
    waypoints = list(plan.waypoints[first : last + 1])
    if waypoints[0].gimbal_pitch_deg is None:
        pitches = [each.gimbal_pitch_deg for each in plan.waypoints[:first]]
        known = [deg for deg in pitches if deg is not None]
        # Each part begins on the ground: what an earlier waypoint turned is turned again.
        waypoints[0] = replace(waypoints[0], gimbal_pitch_deg=known[-1] if known else None)
    rows = tuple((a - first, b - first) for a, b in plan.rows if first <= a and b <= last)
    # The ground is that of the whole flight.
    return replace(
        plan, name=f"{plan.name}, part {number}", waypoints=tuple(waypoints), rows=rows, ground=None
    )
