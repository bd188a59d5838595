"""The fleet return's thresholds, each with its reason."""

from dataclasses import dataclass

from recon.model.airspace import HOVER_DRIFT_M, LAYER_SPACING_M


@dataclass(frozen=True, slots=True)
class FleetReturnSettings:
    """Distances in metres, speeds in metres per second."""

    layer_spacing_m: float = LAYER_SPACING_M

    lowest_layer_m: float = 20.0
    """Height above the highest ground on the ways: over vans, masts and trees at a field's edge."""

    ceiling_margin_m: float = 1.0
    """Margin below the ceiling: an aircraft overshoots a climb by less than this."""

    zone_margin_m: float = 6.0
    """Margin above a zone that is flown over: as much as between two vehicles."""

    horizontal_slack_m: float = HOVER_DRIFT_M
    """Added to the gate's minimum."""

    vertical_slack_m: float = 0.4
    """Added to the gate's minimum; less than the layers' spacing exceeds the gate's 7.5 m."""

    detour_slack_m: float = 1.0
    """Added to the margin at boundary and zones: a waypoint is rounded, a corner is not."""

    speed_mps: float = 8.0
    """Speed between the layers' ends: half of what DJI allows, braking takes 13 m."""

    fastest_upright_mps: float = 5.0
    """No survey aircraft climbs or sinks faster on its own: the least time of a flight."""

    over_pad_m: float = 3.0
    """Distance from its pad within which a vehicle counts as over it."""

    at_layer_m: float = 2.0
    """Height difference within which a vehicle counts as in its layer."""
