"""How often this flight's own forecasts were right: each is compared with the map of its lead.

Theory of operation: a forecast is kept, as sun or shade by cell, once per `keep_every_s`, until its
longest compared lead has passed. Each new map is compared with the forecasts that were made for its
time. Cells count that are known in both maps; a forecast counts as shade below a probability of one
half. The sums fade out over `hindcast_memory_s`.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from recon.forecast.settings import ForecastSettings
from recon.forecast.state import Comparison, ForecastState, IssuedForecast
from recon.model.shade import SURE, SunForecast
from recon.model.units import ns_to_seconds, seconds_to_ns


def with_hindcast(
    state: ForecastState, issued: SunForecast, settings: ForecastSettings
) -> ForecastState:
    """Return the state with its newest map compared with earlier forecasts, and one more kept.

    `issued` is the forecast from the newest map. Forecasts on another grid are dropped.
    """
    at_ns, every_ns = issued.issued_at_ns, seconds_to_ns(settings.keep_every_s)
    kept = tuple(one for one in state.issued if one.grid == issued.grid)
    if kept and at_ns // every_ns == kept[-1].issued_at_ns // every_ns:
        return state
    passed_s = ns_to_seconds(at_ns - kept[-1].issued_at_ns) if kept else 0.0
    fading = float(np.exp(-passed_s / settings.hindcast_memory_s))
    compared = {s: each.faded(fading) for s, each in state.compared.items()}
    shade = state.newest
    for lead_s in settings.hindcast_lead_s:
        due_ns = at_ns - seconds_to_ns(lead_s)
        near = [one for one in kept if abs(one.issued_at_ns - due_ns) * 2 <= every_ns]
        if near:
            then = min(near, key=lambda one: abs(one.issued_at_ns - due_ns))
            both = shade.valid & then.seen
            right = (shade.is_sunlit == then.sunlit[lead_s]) & both
            before = compared.get(lead_s, Comparison())
            compared[lead_s] = before + Comparison(float(right.sum()), float(both.sum()))
    oldest_ns = at_ns - seconds_to_ns(max(settings.hindcast_lead_s)) - every_ns
    recent = tuple(one for one in kept if one.issued_at_ns >= oldest_ns)
    return replace(state, issued=(*recent, _kept(state, issued, settings)), compared=compared)


def right_shares(state: ForecastState) -> Mapping[float, float]:
    """Return by lead the share of cells that recent forecasts had right; only leads compared."""
    return {
        lead_s: each.right / each.cells
        for lead_s, each in sorted(state.compared.items())
        if each.cells >= 1.0
    }


def _kept(state: ForecastState, issued: SunForecast, settings: ForecastSettings) -> IssuedForecast:
    levels = {
        lead_s: issued.sun_probability[int(np.argmin(np.abs(issued.lead_s - lead_s)))]
        for lead_s in settings.hindcast_lead_s
    }
    sunlit = {lead_s: level >= SURE / 2.0 for lead_s, level in levels.items()}
    return IssuedForecast(issued.grid, issued.issued_at_ns, sunlit, state.newest.valid)
