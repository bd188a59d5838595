"""DJI's numbers of aircraft and cameras, which a mission file states so that an app opens it.

From DJI's Cloud API, "Product support" and WPML's common elements; `DJI Fly` is the number that the
app DJI Fly writes for every model it flies, and it names no camera. The companion app has the same
table; `vectors/wpml/aircraft.json` holds what both must agree on.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TypeVar

from recon.model.names import did_you_mean
from recon.plans.flight_plan import PlanExportError

_T = TypeVar("_T")


@dataclass(frozen=True, slots=True)
class CameraNumber:
    """A camera; `lens` is what it stores a photo of, as WPML names it ("visable" is DJI's word)."""

    enum_value: int
    lens: str


@dataclass(frozen=True, slots=True)
class AircraftModel:
    """An aircraft with its camera; None: it has none of its own, or the app names none."""

    enum_value: int
    sub_enum_value: int
    payload: CameraNumber | None
    takes_payloads: bool = False
    most_waypoints: int = 65_535
    photos: bool = True
    """Whether the app is known to take the photos that a mission file asks for."""


AIRCRAFT: Mapping[str, AircraftModel] = MappingProxyType(
    {
        "Mavic 3E": AircraftModel(77, 0, CameraNumber(66, "wide")),
        "Mavic 3T": AircraftModel(77, 1, CameraNumber(67, "wide")),
        "Mavic 3M": AircraftModel(77, 2, CameraNumber(68, "visable")),
        "Mavic 3TA": AircraftModel(77, 3, CameraNumber(129, "wide")),
        "Matrice 30": AircraftModel(67, 0, CameraNumber(52, "wide")),
        "Matrice 30T": AircraftModel(67, 1, CameraNumber(53, "wide")),
        "Matrice 3D": AircraftModel(91, 0, CameraNumber(80, "wide")),
        "Matrice 3TD": AircraftModel(91, 1, CameraNumber(81, "wide")),
        "Matrice 4E": AircraftModel(99, 0, CameraNumber(88, "wide")),
        "Matrice 4T": AircraftModel(99, 1, CameraNumber(89, "wide")),
        "Matrice 4D": AircraftModel(100, 0, CameraNumber(98, "wide")),
        "Matrice 4TD": AircraftModel(100, 1, CameraNumber(99, "wide")),
        "Matrice 300": AircraftModel(60, 0, None, takes_payloads=True),
        "Matrice 350": AircraftModel(89, 0, None, takes_payloads=True),
        "Matrice 400": AircraftModel(103, 0, None, takes_payloads=True),
        "DJI Fly": AircraftModel(68, 0, None, most_waypoints=200, photos=False),
    }
)
PAYLOADS: Mapping[str, CameraNumber] = MappingProxyType(
    {
        "H20": CameraNumber(42, "wide"),
        "H20T": CameraNumber(43, "wide"),
        "H20N": CameraNumber(61, "wide"),
        "H30": CameraNumber(82, "wide"),
        "H30T": CameraNumber(83, "wide"),
    }
)


def aircraft_named(name: str | None, payload: str | None) -> AircraftModel:
    """Return an aircraft by its name, with the camera that is named for it.

    Raises `PlanExportError` with what is known.
    """
    if name is None:
        raise PlanExportError(f"a .kmz names its aircraft: choose one of {', '.join(AIRCRAFT)}")
    found = _named("aircraft", name, AIRCRAFT)
    if not found.takes_payloads:
        if payload is not None:
            raise PlanExportError(f"{name} has its own camera: leave the payload out")
        return found
    if payload is None:
        raise PlanExportError(f"{name} carries a camera: name one of {', '.join(PAYLOADS)}")
    chosen = _named("payload", payload, PAYLOADS)
    return AircraftModel(found.enum_value, found.sub_enum_value, chosen)


def _named(what: str, name: str, known: Mapping[str, _T]) -> _T:
    by_lower = {each.lower(): value for each, value in known.items()}
    found = by_lower.get(name.strip().lower())
    if found is not None:
        return found
    hint = did_you_mean(name, known)
    raise PlanExportError(f"no {what} {name[:40]!a}: known are {', '.join(known)}{hint}")
