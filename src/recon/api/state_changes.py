"""States as changes: what a reader of the stream has already is not sent again.

A change is a state without what its base has: `since` is the base's `time_ns`; a part that is
absent is as in the base; and of the vehicles in `kept`, by serial, `track` holds the new points
only, to be put after so many of the last points of the base's. The site and the tracks are most of
a state's bytes, and hardly change; everything else carries ages and is sent whole.
"""

import json
from collections.abc import Sequence

from recon.api.schema import StationState, VehicleView

Track = Sequence[tuple[float, float]]

MOST_DROPPED = 8
"""Points that leave a track between two states; a track adds about two a second."""


def change_text(base: StationState, state: StationState) -> str:
    """Return the JSON text that turns `base` into `state`."""
    before = {vehicle.serial: vehicle.track for vehicle in base.vehicles if vehicle.serial}
    kept: dict[str, int] = {}
    vehicles: list[VehicleView] = []
    for vehicle in state.vehicles:
        number = kept_points(before.get(vehicle.serial or "", ()), vehicle.track)
        if number and vehicle.serial is not None:
            kept[vehicle.serial] = number
            vehicle = vehicle.model_copy(update={"track": vehicle.track[number:]})
        vehicles.append(vehicle)
    same = {"site"} if state.site is base.site or state.site == base.site else set()
    shortened = state.model_copy(update={"vehicles": vehicles})
    head = f'{{"since":{base.time_ns},"kept":{json.dumps(kept)},'
    return head + shortened.model_dump_json(exclude=same)[1:]


def kept_points(before: Track, now: Track) -> int:
    """Return how many of the last points of `before` the track `now` begins with; 0 for none."""
    for dropped in range(min(len(before), MOST_DROPPED)):
        number = len(before) - dropped
        if list(before[dropped:]) == list(now[:number]):
            return number
    return 0
