"""States as changes: what a reader of the stream has already is not sent again.

A change is a state without what its base has: `since` is the base's `time_ns`; a part that is
absent is as in the base; and of the vehicles in `kept`, by serial, `track` holds the new points
only, to be put after so many of the last points of the base's; those in `same_facts` have the
`app_facts` of the base. The site, the tracks and the facts are most of a state's bytes, and hardly
change; everything else carries ages and is sent whole.
"""

import json
from collections.abc import Sequence

from recon.api.schema import StationState, VehicleView

Track = Sequence[tuple[float, float]]

MOST_DROPPED = 8
"""Points that leave a track between two states; a track adds about two a second."""


def change_text(base: StationState, state: StationState) -> str:
    """Return the JSON text that turns `base` into `state`."""
    before = {vehicle.serial: vehicle for vehicle in base.vehicles if vehicle.serial}
    kept: dict[str, int] = {}
    same_facts: list[str] = []
    vehicles: list[VehicleView] = []
    for vehicle in state.vehicles:
        was, changes = before.get(vehicle.serial or ""), dict[str, object]()
        number = 0 if was is None else kept_points(was.track, vehicle.track)
        if number and vehicle.serial is not None:
            kept[vehicle.serial] = number
            changes["track"] = vehicle.track[number:]
        if was is not None and vehicle.serial is not None and _has_facts_of(vehicle, was):
            same_facts.append(vehicle.serial)
            changes["app_facts"] = None
        vehicles.append(vehicle.model_copy(update=changes) if changes else vehicle)
    same = {"site"} if state.site is base.site or state.site == base.site else set()
    shortened = state.model_copy(update={"vehicles": vehicles})
    facts = f'"same_facts":{json.dumps(same_facts)},' if same_facts else ""
    head = f'{{"since":{base.time_ns},"kept":{json.dumps(kept)},{facts}'
    return head + shortened.model_dump_json(exclude=same)[1:]


def _has_facts_of(vehicle: VehicleView, was: VehicleView) -> bool:
    """Whether it has facts, the base's: views of the same facts are mostly one object."""
    facts = vehicle.app_facts
    return facts is not None and (facts is was.app_facts or facts == was.app_facts)


def kept_points(before: Track, now: Track) -> int:
    """Return how many of the last points of `before` the track `now` begins with; 0 for none."""
    for dropped in range(min(len(before), MOST_DROPPED)):
        number = len(before) - dropped
        if list(before[dropped:]) == list(now[:number]):
            return number
    return 0
