"""DJI's WPML: the template that Pilot 2 opens in its editor, and the wayline that is flown.

Heights are relative to the takeoff point (`relativeToStartPoint`). The companion app writes the
same documents for its own missions; `vectors/wpml/` holds what both must produce. Left out on
purpose:

- `ellipsoidHeight` where the takeoff point's own height is not known: none follows from heights
  above takeoff;
- `globalRTHHeight` where the aircraft's own setting for its return is not known: the setting stays
  as the pilot made it.
"""

from dataclasses import dataclass
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from recon.model.mission import Waypoint
from recon.plans.aircraft import AircraftModel
from recon.plans.flight_plan import AtEnd, ExportedPlan

KML = "http://www.opengis.net/kml/2.2"
WPML = "http://www.dji.com/wpmz/1.0.2"
HEIGHT_MODE = "relativeToStartPoint"
FINISH = {AtEnd.RETURN_HOME: "goHome", AtEnd.LAND: "autoLand", AtEnd.HOVER: "noAction"}
LOWEST_TAKEOFF_M, HIGHEST_TAKEOFF_M = 1.2, 1_500.0


@dataclass(frozen=True, slots=True)
class WpmlOptions:
    """What a mission file states beside the flight; `created_ms` since 1970.

    `go_home_height_m` is the aircraft's own setting, above takeoff; None: unknown.
    """

    created_ms: int
    aircraft: AircraftModel | None = None
    go_home_height_m: float | None = None


def template_kml(plan: ExportedPlan, options: WpmlOptions) -> bytes:
    """Return the document that a person may edit in Pilot 2."""
    root, document = _document()
    _add(document, "author", "Recon")
    _add(document, "createTime", str(options.created_ms))
    _add(document, "updateTime", str(options.created_ms))
    _mission_config(document, plan, options)
    folder = SubElement(document, "Folder")
    first = plan.waypoints[0]
    _add(folder, "templateType", "waypoint")
    _add(folder, "templateId", "0")
    system = _add(folder, "waylineCoordinateSysParam")
    _add(system, "coordinateMode", "WGS84")
    _add(system, "heightMode", HEIGHT_MODE)
    _add(folder, "autoFlightSpeed", number(first.speed_mps))
    _add(folder, "gimbalPitchMode", "manual")
    _add(folder, "globalHeight", number(first.height_above_takeoff_m))
    _heading(_add(folder, "globalWaypointHeadingParam"))
    _add(folder, "globalWaypointTurnMode", _turn_mode(plan, 0))
    _add(folder, "globalUseStraightLine", "1")
    groups = _ActionGroups(plan, options.aircraft)
    for index, waypoint in enumerate(plan.waypoints):
        _template_placemark(folder, plan, index, waypoint)
        groups.add_to(folder[-1], index, waypoint)
    return _bytes(root)


def waylines_wpml(plan: ExportedPlan, options: WpmlOptions) -> bytes:
    """Return the document that the aircraft flies."""
    root, document = _document()
    _mission_config(document, plan, options)
    folder = SubElement(document, "Folder")
    _add(folder, "templateId", "0")
    _add(folder, "executeHeightMode", HEIGHT_MODE)
    _add(folder, "waylineId", "0")
    _add(folder, "autoFlightSpeed", number(plan.waypoints[0].speed_mps))
    groups = _ActionGroups(plan, options.aircraft)
    for index, waypoint in enumerate(plan.waypoints):
        placemark = _placemark(folder, index, waypoint)
        _add(placemark, "executeHeight", number(waypoint.height_above_takeoff_m))
        _add(placemark, "waypointSpeed", number(waypoint.speed_mps))
        _heading(_add(placemark, "waypointHeadingParam"))
        _turn(placemark, plan, index)
        groups.add_to(placemark, index, waypoint)
    return _bytes(root)


def number(value: float) -> str:
    """Return millimetres, or thousandths of a second or degree."""
    return f"{value:.3f}"


def _mission_config(document: Element, plan: ExportedPlan, options: WpmlOptions) -> None:
    config = _add(document, "missionConfig")
    first = plan.waypoints[0]
    takeoff_m = min(max(first.height_above_takeoff_m, LOWEST_TAKEOFF_M), HIGHEST_TAKEOFF_M)
    _add(config, "flyToWaylineMode", "safely")
    _add(config, "finishAction", FINISH[plan.at_end])
    # Without its controller it flies home and not the rest of the mission: no pilot could stop it.
    _add(config, "exitOnRCLost", "executeLostAction")
    _add(config, "executeRCLostAction", "goBack")
    _add(config, "takeOffSecurityHeight", number(takeoff_m))
    _add(config, "globalTransitionalSpeed", number(first.speed_mps))
    if options.go_home_height_m is not None:
        _add(config, "globalRTHHeight", number(options.go_home_height_m))
    aircraft = options.aircraft
    if aircraft is None:
        return
    drone = _add(config, "droneInfo")
    _add(drone, "droneEnumValue", str(aircraft.enum_value))
    _add(drone, "droneSubEnumValue", str(aircraft.sub_enum_value))
    if aircraft.payload is not None:
        payload = _add(config, "payloadInfo")
        _add(payload, "payloadEnumValue", str(aircraft.payload.enum_value))
        _add(payload, "payloadPositionIndex", "0")


def _template_placemark(
    folder: Element, plan: ExportedPlan, index: int, waypoint: Waypoint
) -> None:
    placemark = _placemark(folder, index, waypoint)
    height_m, ground_m = waypoint.height_above_takeoff_m, plan.takeoff_ellipsoid_height_m
    if not plan.is_level:
        if ground_m is not None:
            _add(placemark, "ellipsoidHeight", number(ground_m + height_m))
        _add(placemark, "height", number(height_m))
    _add(placemark, "useGlobalHeight", "1" if plan.is_level else "0")
    _add(placemark, "useGlobalSpeed", "0")
    _add(placemark, "waypointSpeed", number(waypoint.speed_mps))
    _add(placemark, "useGlobalHeadingParam", "1")
    _add(placemark, "useGlobalTurnParam", "0")
    _turn(placemark, plan, index)


def _placemark(folder: Element, index: int, waypoint: Waypoint) -> Element:
    placemark = SubElement(folder, "Placemark")
    point = SubElement(placemark, "Point")
    place = SubElement(point, "coordinates")
    place.text = f"{waypoint.longitude_deg:.8f},{waypoint.latitude_deg:.8f}"
    _add(placemark, "index", str(index))
    return placemark


def _heading(element: Element) -> None:
    _add(element, "waypointHeadingMode", "followWayline")
    _add(element, "waypointHeadingPathMode", "followBadArc")


def _turn(placemark: Element, plan: ExportedPlan, index: int) -> None:
    turn = _add(placemark, "waypointTurnParam")
    radius_m = plan.waypoints[index].corner_radius_m if _cuts_corner(plan, index) else 0.0
    _add(turn, "waypointTurnMode", _turn_mode(plan, index))
    _add(turn, "waypointTurnDampingDist", number(radius_m))
    _add(placemark, "useStraightLine", "1")


def _turn_mode(plan: ExportedPlan, index: int) -> str:
    if _cuts_corner(plan, index):
        return "coordinateTurn"
    return "toPointAndStopWithDiscontinuityCurvature"


def _cuts_corner(plan: ExportedPlan, index: int) -> bool:
    """The first and the last waypoint have no corner to cut."""
    return plan.curved and 0 < index < len(plan.waypoints) - 1


class _ActionGroups:
    """The actions of a document; their groups are counted from 0 without gaps."""

    def __init__(self, plan: ExportedPlan, aircraft: AircraftModel | None) -> None:
        self._plan, self._count = plan, 0
        payload = None if aircraft is None else aircraft.payload
        self._lens = None if payload is None else payload.lens

    def add_to(self, placemark: Element, index: int, waypoint: Waypoint) -> None:
        """Add a waypoint's actions; photos begin at the first, once the gimbal is turned."""
        pitch_deg, loiter_s = waypoint.gimbal_pitch_deg, waypoint.loiter_s
        if pitch_deg is not None or loiter_s:
            group = self._group(placemark, index, index, "reachPoint")
            if pitch_deg is not None:
                _gimbal(_action(group, 0, "gimbalRotate"), pitch_deg)
            if loiter_s:
                stay = _action(group, int(pitch_deg is not None), "hover")
                _add(stay, "hoverTime", number(loiter_s))
        photos = self._plan.photos
        if index or photos is None:
            return
        is_timed = photos.every_s is not None
        last = len(self._plan.waypoints) - 1
        trigger = "multipleTiming" if is_timed else "multipleDistance"
        every = photos.every_s if is_timed else photos.every_m
        group = self._group(placemark, 0, last, trigger, every)
        _photo(_action(group, 0, "takePhoto"), self._lens)

    def _group(
        self, placemark: Element, first: int, last: int, trigger: str, every: float | None = None
    ) -> Element:
        group = _add(placemark, "actionGroup")
        _add(group, "actionGroupId", str(self._count))
        _add(group, "actionGroupStartIndex", str(first))
        _add(group, "actionGroupEndIndex", str(last))
        _add(group, "actionGroupMode", "sequence")
        when = _add(group, "actionTrigger")
        _add(when, "actionTriggerType", trigger)
        if every is not None:
            _add(when, "actionTriggerParam", number(every))
        self._count += 1
        return group


def _action(group: Element, number_in_group: int, function: str) -> Element:
    """Add an action; return the element of its parameters."""
    action = _add(group, "action")
    _add(action, "actionId", str(number_in_group))
    _add(action, "actionActuatorFunc", function)
    return _add(action, "actionActuatorFuncParam")


def _gimbal(parameters: Element, pitch_deg: float) -> None:
    for name, value in (
        ("gimbalHeadingYawBase", "north"),
        ("gimbalRotateMode", "absoluteAngle"),
        ("gimbalPitchRotateEnable", "1"),
        ("gimbalPitchRotateAngle", number(pitch_deg)),
        ("gimbalRollRotateEnable", "0"),
        ("gimbalRollRotateAngle", "0"),
        ("gimbalYawRotateEnable", "0"),
        ("gimbalYawRotateAngle", "0"),
        ("gimbalRotateTimeEnable", "0"),
        ("gimbalRotateTime", "0"),
        ("payloadPositionIndex", "0"),
    ):
        _add(parameters, name, value)


def _photo(parameters: Element, lens: str | None) -> None:
    _add(parameters, "payloadPositionIndex", "0")
    _add(parameters, "fileSuffix", "recon")
    if lens is not None:
        _add(parameters, "payloadLensIndex", lens)
        _add(parameters, "useGlobalPayloadLensIndex", "0")


def _document() -> tuple[Element, Element]:
    root = Element("kml", {"xmlns": KML, "xmlns:wpml": WPML})
    return root, SubElement(root, "Document")


def _add(parent: Element, name: str, text: str | None = None) -> Element:
    """Add an element of DJI's namespace."""
    child = SubElement(parent, f"wpml:{name}")
    child.text = text
    return child


def _bytes(root: Element) -> bytes:
    indent(root)
    data: bytes = tostring(root, encoding="utf-8", xml_declaration=True)
    return data
