"""The elements that WPML's documents may have, by their parent, from DJI's reference.

A rule is (required, repeated, accepted texts as a regular expression or a range). Written from the
reference, not from the writer.
"""

import re
from collections import Counter
from collections.abc import Iterator
from xml.etree.ElementTree import Element

Rule = tuple[bool, bool, str | tuple[float, float] | None]


def _one(*texts: str, required: bool = True) -> Rule:
    return required, False, "|".join(texts)


def _number(least: float, most: float, *, required: bool = True) -> Rule:
    return required, False, (least, most)


def _parent(*, required: bool = True, repeated: bool = False) -> Rule:
    return required, repeated, None


INDEX, FLAG, SPEED = _number(0, 65_535), _one("0", "1"), _number(0.001, 15.0)
STOPS = "toPointAndStopWithDiscontinuityCurvature"
TURN = _one("coordinateTurn", STOPS, "toPointAndPassWithContinuityCurvature")
HEADING = {
    "waypointHeadingMode": _one("followWayline", "manually", "fixed", "smoothTransition"),
    "waypointHeadingPathMode": _one("clockwise", "counterClockwise", "followBadArc"),
}
COMMON: dict[str, dict[str, Rule]] = {
    "kml": {"Document": _parent()},
    "missionConfig": {
        "flyToWaylineMode": _one("safely", "pointToPoint"),
        "finishAction": _one("goHome", "noAction", "autoLand", "gotoFirstWaypoint"),
        "exitOnRCLost": _one("goContinue", "executeLostAction"),
        "executeRCLostAction": _one("goBack", "landing", "hover"),
        "takeOffSecurityHeight": _number(1.2, 1_500.0),
        "globalTransitionalSpeed": SPEED,
        "globalRTHHeight": _number(2.0, 1_500.0, required=False),
        "droneInfo": _parent(required=False),
        "payloadInfo": _parent(required=False),
    },
    "droneInfo": {"droneEnumValue": INDEX, "droneSubEnumValue": INDEX},
    "payloadInfo": {"payloadEnumValue": INDEX, "payloadPositionIndex": _number(0, 2)},
    "waylineCoordinateSysParam": {
        "coordinateMode": _one("WGS84"),
        "heightMode": _one("EGM96", "relativeToStartPoint", "aboveGroundLevel"),
    },
    "Point": {"coordinates": _one(r"-?\d+\.\d+,-?\d+\.\d+")},
    "waypointHeadingParam": HEADING,
    "globalWaypointHeadingParam": HEADING,
    "waypointTurnParam": {"waypointTurnMode": TURN, "waypointTurnDampingDist": _number(0, 2_000)},
    "actionGroup": {
        "actionGroupId": INDEX,
        "actionGroupStartIndex": INDEX,
        "actionGroupEndIndex": INDEX,
        "actionGroupMode": _one("sequence"),
        "actionTrigger": _parent(),
        "action": _parent(repeated=True),
    },
    "actionTrigger": {
        "actionTriggerType": _one("reachPoint", "multipleTiming", "multipleDistance"),
        "actionTriggerParam": _number(0.001, 10_000.0, required=False),
    },
    "action": {
        "actionId": INDEX,
        "actionActuatorFunc": _one("hover", "gimbalRotate", "takePhoto"),
        "actionActuatorFuncParam": _parent(),
    },
}
PLACEMARK = {
    "Point": _parent(),
    "index": INDEX,
    "waypointSpeed": SPEED,
    "waypointTurnParam": _parent(),
    "useStraightLine": FLAG,
    "actionGroup": _parent(required=False, repeated=True),
}
TEMPLATE: dict[str, dict[str, Rule]] = {
    **COMMON,
    "Document": {
        "author": _one(".+", required=False),
        "createTime": _one(r"\d{13}", required=False),
        "updateTime": _one(r"\d{13}", required=False),
        "missionConfig": _parent(),
        "Folder": _parent(),
    },
    "Folder": {
        "templateType": _one("waypoint"),
        "templateId": INDEX,
        "waylineCoordinateSysParam": _parent(),
        "autoFlightSpeed": SPEED,
        "gimbalPitchMode": _one("manual", "usePointSetting"),
        "globalHeight": _number(-200.0, 1_500.0),
        "globalWaypointHeadingParam": _parent(),
        "globalWaypointTurnMode": TURN,
        "globalUseStraightLine": FLAG,
        "Placemark": _parent(repeated=True),
    },
    "Placemark": {
        **PLACEMARK,
        "ellipsoidHeight": _number(-1_000.0, 10_000.0, required=False),
        "height": _number(-200.0, 1_500.0, required=False),
        "useGlobalHeight": FLAG,
        "useGlobalSpeed": FLAG,
        "useGlobalHeadingParam": FLAG,
        "useGlobalTurnParam": FLAG,
    },
}
WAYLINES: dict[str, dict[str, Rule]] = {
    **COMMON,
    "Document": {"missionConfig": _parent(), "Folder": _parent()},
    "Folder": {
        "templateId": INDEX,
        "executeHeightMode": _one("WGS84", "relativeToStartPoint", "realTimeFollowSurface"),
        "waylineId": INDEX,
        "autoFlightSpeed": SPEED,
        "Placemark": _parent(repeated=True),
    },
    "Placemark": {
        **PLACEMARK,
        "executeHeight": _number(-200.0, 1_500.0),
        "waypointHeadingParam": _parent(),
    },
}
PARAMETERS: dict[str, dict[str, Rule]] = {
    "hover": {"hoverTime": _number(0.001, 3_600.0)},
    "takePhoto": {
        "payloadPositionIndex": _number(0, 2),
        "fileSuffix": _one(r"\w+"),
        "payloadLensIndex": _one("wide", "zoom", "ir", "narrow_band", "visable", required=False),
        "useGlobalPayloadLensIndex": _one("0", "1", required=False),
    },
    "gimbalRotate": {
        "gimbalHeadingYawBase": _one("north"),
        "gimbalRotateMode": _one("absoluteAngle"),
        **{f"gimbal{axis}RotateEnable": FLAG for axis in ("Pitch", "Roll", "Yaw")},
        **{f"gimbal{axis}RotateAngle": _number(-180, 180) for axis in ("Pitch", "Roll", "Yaw")},
        "gimbalRotateTimeEnable": FLAG,
        "gimbalRotateTime": _number(0, 100),
        "payloadPositionIndex": _number(0, 2),
    },
}


def violations(element: Element, rules: dict[str, dict[str, Rule]]) -> Iterator[str]:
    """Yield what in a document breaks the rules."""
    name, children = _local(element), list(element)
    own = rules.get(name)
    if name == "action":
        function = next(c.text or "" for c in children if _local(c) == "actionActuatorFunc")
        rules = {**rules, "actionActuatorFuncParam": PARAMETERS[function]}
    if own is None:
        if children:
            yield f"children in {name}"
        return
    counts = Counter(map(_local, children))
    yield from (
        f"{name} lacks {each}" for each, rule in own.items() if rule[0] and not counts[each]
    )
    for child in children:
        known = own.get(_local(child))
        if known is None:
            yield f"unknown {_local(child)} in {name}"
            continue
        if counts[_local(child)] > 1 and not known[1]:
            yield f"{_local(child)} is repeated in {name}"
        if not _accepts(known[2], (child.text or "").strip()):
            yield f"{_local(child)} is {child.text}"
        yield from violations(child, rules)


def _accepts(rule: str | tuple[float, float] | None, text: str) -> bool:
    if rule is None:
        return True
    if isinstance(rule, str):
        return re.fullmatch(rule, text) is not None
    return re.fullmatch(r"-?\d+(\.\d+)?", text) is not None and rule[0] <= float(text) <= rule[1]


def _local(element: Element) -> str:
    return element.tag.rpartition("}")[2]
