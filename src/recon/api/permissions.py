"""Which role each request needs: the one place that decides, and SECURITY.md prints it.

A route of the API without a row is an administrator's, and a test fails for it. Every role may
order an all stop; pilots what brings single vehicles to rest or down; operators what sets one in
motion; administrators what switches a protection off.
"""

from typing import Any

from fastapi import HTTPException
from starlette.requests import HTTPConnection

from recon.api.security import person_of
from recon.model.person import Person, Role

FORBIDDEN = 403
STREAM = "STREAM"
"""Stands for the method of a WebSocket."""

STOP_ORDERS = frozenset({"hover", "land", "return_home"})

LEAST_ROLE: dict[tuple[str, str], Role] = {
    ("GET", "/api/access"): Role.OBSERVER,
    ("GET", "/api/access/qr.svg"): Role.OBSERVER,
    ("GET", "/api/apps/qr.svg"): Role.OBSERVER,
    ("GET", "/api/state"): Role.OBSERVER,
    ("GET", "/api/vehicles"): Role.OBSERVER,
    ("GET", "/api/vehicle"): Role.OBSERVER,
    ("GET", "/api/vehicle/frame.jpg"): Role.OBSERVER,
    ("GET", "/api/vehicle/preflight"): Role.OBSERVER,
    ("GET", "/api/commands"): Role.OBSERVER,
    ("GET", "/api/commands/{command_id}"): Role.OBSERVER,
    ("GET", "/api/audit"): Role.OBSERVER,
    ("GET", "/api/timeline"): Role.OBSERVER,
    ("GET", "/api/ground-image.png"): Role.OBSERVER,
    ("GET", "/api/ground-image.tif"): Role.OBSERVER,
    ("GET", "/api/shade.png"): Role.OBSERVER,
    ("GET", "/api/forecast.png"): Role.OBSERVER,
    ("GET", "/api/shade.npz"): Role.OBSERVER,
    ("GET", "/api/forecast.npz"): Role.OBSERVER,
    ("GET", "/api/sun-at"): Role.OBSERVER,
    ("GET", "/api/upwind-place"): Role.OBSERVER,
    ("GET", "/api/surveys"): Role.OBSERVER,
    ("GET", "/api/surveys/{survey_id}"): Role.OBSERVER,
    ("GET", "/api/surveys/{survey_id}/paths"): Role.OBSERVER,
    ("GET", "/api/surveys/{survey_id}/cells.png"): Role.OBSERVER,
    ("GET", "/api/flights"): Role.OBSERVER,
    ("GET", "/api/flights/{name}"): Role.OBSERVER,
    ("GET", "/api/flights/{name}/record.mcap"): Role.OBSERVER,
    ("GET", "/api/flights/{name}/files/{file}"): Role.OBSERVER,
    ("GET", "/api/photos"): Role.OBSERVER,
    ("GET", "/api/photos/files/{file}"): Role.OBSERVER,
    ("GET", "/api/maps"): Role.OBSERVER,
    ("GET", "/api/maps/{name}/{zoom}/{col}/{row}"): Role.OBSERVER,
    ("GET", "/api/surveys/{survey_id}/estimate"): Role.OBSERVER,
    ("GET", "/api/surveys/{survey_id}/exports"): Role.OBSERVER,
    ("GET", "/api/surveys/{survey_id}/plan.{kind}"): Role.OBSERVER,
    ("GET", "/api/cameras"): Role.OBSERVER,
    ("GET", "/api/flown-regions"): Role.OBSERVER,
    ("GET", "/api/zones"): Role.OBSERVER,
    ("GET", "/api/site/drawing"): Role.OBSERVER,
    ("GET", "/api/site/vehicles"): Role.OBSERVER,
    ("GET", "/api/site/calibration/frame.jpg"): Role.OBSERVER,
    ("GET", "/api/replay/marks"): Role.OBSERVER,
    # A replay orders nothing; a live station refuses it.
    ("POST", "/api/replay"): Role.OBSERVER,
    (STREAM, "/api/stream"): Role.OBSERVER,
    (STREAM, "/api/audit/stream"): Role.OBSERVER,
    ("POST", "/api/all-stop"): Role.OBSERVER,
    # The role depends on the kind: see `order_role` and `authority_role`.
    ("POST", "/api/orders"): Role.PILOT,
    ("POST", "/api/orders/check"): Role.PILOT,
    ("POST", "/api/vehicle/authority"): Role.PILOT,
    # Pause and abort hold the survey's vehicles.
    ("POST", "/api/surveys/{survey_id}/{command}"): Role.PILOT,
    # Drawing a zone brings to rest what comes near; a pilot in the field sees a person first.
    ("POST", "/api/zones"): Role.PILOT,
    ("POST", "/api/zones/{zone_id}/end"): Role.OPERATOR,
    ("POST", "/api/alarms/{alarm_id}/acknowledge"): Role.OPERATOR,
    ("POST", "/api/all-stop/release"): Role.OPERATOR,
    # A drone whose address changed in flight is admitted at once, by its operator.
    ("POST", "/api/apps/admit"): Role.OPERATOR,
    ("POST", "/api/apps/refuse"): Role.OPERATOR,
    ("POST", "/api/fleet-return"): Role.OPERATOR,
    ("POST", "/api/side-step"): Role.OPERATOR,
    ("POST", "/api/imager-relief"): Role.OPERATOR,
    ("POST", "/api/surveys"): Role.OPERATOR,
    ("POST", "/api/surveys/again"): Role.OPERATOR,
    ("POST", "/api/surveys/estimate"): Role.OPERATOR,
    ("POST", "/api/surveys/{survey_id}/start"): Role.OPERATOR,
    # Regions to survey only; boundary, zones and pads need an administrator: see `EditedSite`.
    ("POST", "/api/site/drawing"): Role.OPERATOR,
    ("POST", "/api/site/drawing/check"): Role.OPERATOR,
    ("POST", "/api/site/drawing/undo"): Role.OPERATOR,
    ("POST", "/api/site/import"): Role.OPERATOR,
    # The station reads a folder of its computer that the request names.
    ("POST", "/api/photos"): Role.OPERATOR,
    ("DELETE", "/api/photos"): Role.OPERATOR,
    ("POST", "/api/site/calibration"): Role.OPERATOR,
    ("POST", "/api/site/calibration/fit"): Role.OPERATOR,
    ("POST", "/api/site/calibration/freeze"): Role.OPERATOR,
    ("POST", "/api/site/vehicles"): Role.OPERATOR,
    ("POST", "/api/site/vehicles/check"): Role.OPERATOR,
    # Finding a lost vehicle is routine; the operators talk to those who look for it.
    ("POST", "/api/vehicle/hazard/dismiss"): Role.OPERATOR,
    # On is the operators', off the administrators': see `separation_hold_role`.
    ("POST", "/api/separation-hold/{switch}"): Role.OPERATOR,
    ("POST", "/api/vehicle/preflight/override"): Role.ADMIN,
}


def order_role(kind: str) -> Role:
    """Return the role that an order of a kind needs."""
    return Role.PILOT if kind in STOP_ORDERS else Role.OPERATOR


def authority_role(holder: str) -> Role:
    """Return the role that giving control authority to a holder needs."""
    return Role.PILOT if holder == "pilot" else Role.OPERATOR


def separation_hold_role(switch: str) -> Role:
    """Return the role that switching the separation holds needs."""
    return Role.OPERATOR if switch == "on" else Role.ADMIN


async def require_listed_role(connection: HTTPConnection) -> None:
    """Refuse a request whose route needs a higher role; runs before every route."""
    path: Any = getattr(connection.scope.get("route"), "path", "")
    method = connection.scope.get("method", STREAM)
    if path.startswith("/api/"):
        require(person_of(connection), LEAST_ROLE.get((method, path), Role.ADMIN))


def require(person: Person, needed: Role) -> None:
    """Raise 403 when a person's role does not include the one needed."""
    if not person.role.includes(needed):
        raise HTTPException(
            FORBIDDEN,
            f"{person.name} has the role {person.role.value}; this needs {needed.value}. Nothing "
            "was sent. All stop is open to every role",
        )
