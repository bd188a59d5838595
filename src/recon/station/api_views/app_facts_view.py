"""What an app reports of its aircraft, as the API sends it."""

from dataclasses import fields
from enum import Enum
from functools import lru_cache
from typing import Any

from recon.api import schema
from recon.model.app_report import AppFacts, PhotoTally

_COUNTS = ("photo_series", "photo_count")
"""For the station: `PhotoTallyView` has what it makes of them."""
_NAMES = tuple(each.name for each in fields(AppFacts) if each.name not in _COUNTS)
_DIGITS = 8
"""A millimetre of latitude; further digits cannot be compressed."""


@lru_cache(maxsize=256)
def app_facts_view(facts: AppFacts) -> schema.AppFactsView:
    """Return an app's facts; made once for all the messages in which they stay the same."""
    return schema.AppFactsView(**{name: _plain(getattr(facts, name)) for name in _NAMES})


@lru_cache(maxsize=256)
def photo_tally_view(tally: PhotoTally) -> schema.PhotoTallyView:
    """Return the photos that an app has reported; made once for each report."""
    return schema.PhotoTallyView(count=tally.newest_index, missing=tally.missing)


def _plain(value: Any) -> Any:
    if isinstance(value, tuple):
        return [_plain(each) for each in value]
    if isinstance(value, Enum):
        return value.value
    return round(value, _DIGITS) if isinstance(value, float) else value
