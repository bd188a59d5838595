"""The extension `recon 1`: facts, photos and outcomes in the texts of message strings.

docs/icd.md ("Facts, photos and outcomes") is its document. A text is read strictly and whole: one
value of a wrong type or out of its bounds refuses all of it, with a sentence; keys and kinds that
are not known are ignored, so that newer apps may say more. Whatever the bytes, nothing is raised
and no more than the text's size is held.
"""

import json
from collections.abc import Callable
from typing import Any

from recon.model.app_report import (
    AppAction,
    AppFacts,
    AppOrder,
    OutcomeReport,
    PhotosReport,
    ReportedPhoto,
    RtkState,
)
from recon.model.report import IgnoredReport
from recon.vehicles.json_fields import (
    Reader,
    WrongValueError,
    fields,
    flag,
    integer,
    known,
    many,
    member,
    number,
    text,
    word,
)
from recon.vehicles.printable import printable

NAME = b"recon"
PREFIX = b"recon 1 "
LONGEST_BYTES = 4096
"""Of one text; the interface allows 65536, which nothing here needs."""
MOST_LISTS = 64
"""Brackets that open in one text: 16 photos need 18. It bounds the depth before it is parsed."""
MOST_PHOTOS = 16

AppText = AppFacts | PhotosReport | OutcomeReport

_LATITUDE, _LONGITUDE = number(-90, 90), number(-180, 180)
_HEIGHT, _ANGLE = number(-500, 10_000), number(-360, 360)
_NAME, _SENTENCE = text(64, printable), text(200, printable)

FACTS: dict[str, Reader] = {
    "go_home_height_m": number(0, 2000),
    "failsafe": word("go_home", "hover", "land"),
    "home_latitude_deg": _LATITUDE,
    "home_longitude_deg": _LONGITUDE,
    "max_height_m": number(0, 10_000),
    "max_distance_m": number(0, 100_000),
    "model": _NAME,
    "firmware": _NAME,
    "app": _NAME,
    "battery_cells_v": many(number(0, 10), 1, 48),
    "battery_temperature_c": number(-60, 150),
    "rtk": member(RtkState),
    "storage_left_mb": integer(0, 100_000_000),
    "storage_left_photos": integer(0, 10_000_000),
    "gimbal_yaw_deg": _ANGLE,
    "gimbal_pitch_deg": _ANGLE,
    "gimbal_roll_deg": _ANGLE,
    "camera_mode": word("photo", "interval", "video", "other"),
    "photo_interval_s": number(0.1, 3600),
    "exposure_locked": flag,
    "white_balance_locked": flag,
    "can_fly_missions": flag,
    "max_waypoints": integer(0, 65_535),
    "dji_check_passed": flag,
    "dji_check": _SENTENCE,
    "reports_photos": flag,
    "photo_series": integer(0, 2**32 - 1),
    "photo_count": integer(0, 2**32 - 1),
    "orders": known(AppOrder, 16),
}
PHOTO: dict[str, Reader] = {
    "index": integer(1, 2**32 - 1),
    "age_s": number(0, 3600),
    "time_utc_ms": integer(0, 2**53),
    "latitude_deg": _LATITUDE,
    "longitude_deg": _LONGITUDE,
    "height_above_takeoff_m": _HEIGHT,
    "yaw_deg": _ANGLE,
    "gimbal_pitch_deg": _ANGLE,
    "lens": _NAME,
    "file": _NAME,
}
OUTCOME: dict[str, Reader] = {
    "action": member(AppAction),
    "ok": flag,
    "code": _NAME,
    "text": _SENTENCE,
    "mission_id": integer(0, 65_535),
}


def _photo(found: Any) -> ReportedPhoto:
    return ReportedPhoto(**fields(found, PHOTO, frozenset({"index", "age_s"})))


PHOTOS: dict[str, Reader] = {
    "series": integer(0, 2**32 - 1),
    "serial": text(256, printable),
    "photos": many(_photo, 1, MOST_PHOTOS),
}


def read_app_text(raw: bytes) -> AppText | IgnoredReport | None:
    """Return what a message's text says in the extension; None for a text that is not of it.

    A text of another version, or one that is refused, is an IgnoredReport with the reason.
    """
    if not raw.startswith(NAME + b" "):
        return None
    if not raw.startswith(PREFIX):
        return _other_version(raw)
    if len(raw) > LONGEST_BYTES:
        return _refused(f"at most {LONGEST_BYTES} bytes; got {len(raw)}")
    try:
        return _read(raw[len(PREFIX) :])
    except WrongValueError as wrong:
        return _refused(str(wrong))


def _other_version(raw: bytes) -> IgnoredReport | None:
    """A sentence that begins with the name is an ordinary message."""
    version = raw[len(NAME) + 1 :][:8].partition(b" ")[0]
    return IgnoredReport("app text of another version") if version.isdigit() else None


def _read(raw: bytes) -> AppText | IgnoredReport:
    found = _parsed(raw)
    if not isinstance(found, dict):
        raise WrongValueError("a JSON object")
    kind = found.get("kind")
    read = _KINDS.get(kind) if isinstance(kind, str) else None
    if read is None:
        return IgnoredReport("app text of a kind that is not known")
    return read(found)


def _parsed(raw: bytes) -> Any:
    if raw.count(b"{") + raw.count(b"[") > MOST_LISTS:
        raise WrongValueError(f"at most {MOST_LISTS} objects and lists")
    try:
        return json.loads(raw, parse_constant=_no_constant, object_pairs_hook=_once)
    except (ValueError, RecursionError) as wrong:
        expected = str(wrong) if isinstance(wrong, WrongValueError) else "JSON in UTF-8"
        raise WrongValueError(expected) from None


def _no_constant(name: str) -> Any:
    raise WrongValueError(f"finite numbers, not {name}")


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        raise WrongValueError("each key once")
    return found


def _photos(found: Any) -> PhotosReport:
    return PhotosReport(**fields(found, PHOTOS, frozenset({"series", "photos"})))


_KINDS: dict[str, Callable[[Any], AppText]] = {
    "facts": lambda found: AppFacts(**fields(found, FACTS)),
    "photos": _photos,
    "outcome": lambda found: OutcomeReport(**fields(found, OUTCOME, frozenset({"action", "ok"}))),
}


def _refused(expected: str) -> IgnoredReport:
    return IgnoredReport(f"app text refused: expected {expected}")
