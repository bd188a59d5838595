"""What states the heading of a picture's top, and which of them to believe unverified."""

from collections.abc import Mapping

import numpy as np

from recon.model.arrays import FloatArray

GIMBAL, AIRCRAFT = "the gimbal's yaw", "the aircraft's yaw"
RECORDED, COURSE = "the recorded heading", "the course"
SOURCES = (GIMBAL, AIRCRAFT, RECORDED, COURSE)
"""The photo's own statements, the flight record's, the track's direction."""
APART_DEG = 20.0
"""Two that differ by more contradict each other, no matter how much more."""

MOST_MIDDLES = 500


def signed_deg(angle_deg: float) -> float:
    """Return an angle from -180 up to 180."""
    return (angle_deg + 180.0) % 360.0 - 180.0


def best_guess_deg(headings_deg: Mapping[str, float]) -> float:
    """Return the heading that agrees with the others best, the first of `SOURCES` among equals."""
    return headings_deg[
        min(
            (name for name in SOURCES if name in headings_deg),
            key=lambda name: sum(
                min(APART_DEG, abs(signed_deg(headings_deg[name] - other)))
                for other in headings_deg.values()
            ),
        )
    ]


def signed_degs(angles_deg: FloatArray) -> FloatArray:
    """Return angles (N,) from -180 up to 180."""
    found: FloatArray = (angles_deg + 180.0) % 360.0 - 180.0
    return found


def middle_deg(angles_deg: FloatArray) -> float:
    """Return the angle among some (N,) that is nearest to all of them: a median on the circle."""
    few = np.linspace(0, len(angles_deg) - 1, min(len(angles_deg), MOST_MIDDLES)).astype(np.int64)
    apart = np.abs(signed_degs(angles_deg[:, np.newaxis] - angles_deg[few])).sum(axis=0)
    return signed_deg(float(angles_deg[few[np.argmin(apart)]]))
