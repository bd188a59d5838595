"""The photos that the survey drones of a recorded simulated flight would have taken, and the truth.

The drones are where the record has them: the simulator's own places, less than a metre off, are in
no record. The camera timer runs whenever a drone is at its survey's height, also in turns and on
the way.
"""

from collections.abc import Iterator

import numpy as np

from recon.geo import enu_from_point, geo_from_enu
from recon.model.arrays import FloatArray, IntArray
from recon.model.units import NS_PER_S
from recon.product.flight import FlightData, FlownSurvey, RecordedTrack
from recon.score.methods import config_of, renderers_of
from recon.score.scenario_conditions import conditions_of
from recon.score.scenario_schema import ScenarioError
from recon.score.true_paths import phases_s
from recon.score.truth import Truth
from recon.sim.photos.card import CardSettings, PhotoCard, PhotoFile, PhotoShot

AT_HEIGHT_SHARE = 0.9
"""Of the survey's height: lower photos are of takeoffs and landings."""
TRUTH_COLUMNS = (
    "name,vehicle,time_utc,east_m,north_m,up_m,latitude_deg,longitude_deg,ellipsoid_height_m,"
    "height_above_takeoff_m,omega_deg,phi_deg,kappa_deg,sunlit"
)


def card_of(flight: FlightData, truth: Truth, settings: CardSettings) -> PhotoCard:
    """Return the card on which a flight's photos are, over the land and below the sky of a truth.

    Raises `ScenarioError` for a scenario without an imaging drone, whose world is taken.
    """
    config = config_of(truth.scenario, truth.sky.settings.seed)
    world = next(iter(renderers_of(config).values()), None)
    if world is None:
        raise ScenarioError(f"{truth.scenario.name}: expected an imaging drone, got none")
    return PhotoCard(flight.frame, world, settings)


def shots_of(flight: FlightData, truth: Truth, every: int = 1) -> list[PhotoShot]:
    """Return every Nth shot of each survey drone, drone by drone: neighbours share drawn land.

    Raises `ScenarioError` where no drone flew at its survey's height.
    """
    shots = [
        shot
        for track in flight.survey_tracks.values()
        for shot in _shots_of(flight, truth, track)[::every]
    ]
    if not shots:
        raise ScenarioError(
            f"{flight.path}: expected a survey that was flown, got none: no survey drone was at "
            "its survey's height"
        )
    return shots


def _shots_of(flight: FlightData, truth: Truth, track: RecordedTrack) -> list[PhotoShot]:
    home_up_m = _home_up_m(truth, track.serial)
    yaw_error_deg = conditions_of(truth.scenario, truth.sky.settings.seed).yaw_error_deg
    shots: list[PhotoShot] = []
    for at_ns in _presses_ns(flight, truth, track):
        since_s = (track.at_ns - at_ns) / NS_PER_S
        place = [_at(since_s, part) for part in (track.east_m, track.north_m, track.height_m)]
        shots.append(
            PhotoShot(
                f"{track.serial}_{len(shots) + 1:04d}.JPG",
                track.serial,
                (at_ns - truth.zero_ns) / NS_PER_S,
                at_ns + flight.utc_ahead_ns,
                np.array([place[0], place[1], place[2] + home_up_m]),
                place[2],
                _heading_at(since_s, track.yaw_deg) - yaw_error_deg,
                truth.sky.settings.seed,
            )
        )
    return shots


def _presses_ns(flight: FlightData, truth: Truth, track: RecordedTrack) -> list[int]:
    """Return the station times at which the camera timer took a photo at a survey's height."""
    seed, found = truth.sky.settings.seed, list[int]()
    for survey, part in flight.parts_by_survey(track):
        at_ns, height_m = track.at_ns[part], track.height_m[part]
        if len(at_ns) < 2:
            continue
        interval_s = survey.camera.interval_s
        (phase_s,) = phases_s(seed, [track.serial], interval_s)
        interval_ns, phase_ns = round(interval_s * NS_PER_S), round(phase_s * NS_PER_S)
        # The timer counts from the world's beginning, whatever survey it is used for.
        first = -((truth.zero_ns + phase_ns - int(at_ns[0])) // interval_ns)
        last = (int(at_ns[-1]) - truth.zero_ns - phase_ns) // interval_ns
        presses = truth.zero_ns + phase_ns + interval_ns * np.arange(first, last + 1)
        high = _interpolated(presses, at_ns, height_m) >= AT_HEIGHT_SHARE * _height_m(survey)
        found += presses[high].tolist()
    return found


def _height_m(survey: FlownSurvey) -> float:
    height_m = survey.height_above_takeoff_m
    found = survey.height_above_ground_m if height_m is None else height_m
    assert found is not None  # a survey has one of them
    return found


def _interpolated(moments_ns: IntArray, at_ns: IntArray, values: FloatArray) -> FloatArray:
    start_ns = int(at_ns[0])
    return np.interp(moments_ns - start_ns, at_ns - start_ns, values)


def _at(since_s: FloatArray, values: FloatArray) -> float:
    return float(np.interp(0.0, since_s, values))


def _heading_at(since_s: FloatArray, yaw_deg: FloatArray) -> float:
    turned = np.deg2rad(yaw_deg)
    return float(np.rad2deg(np.arctan2(_at(since_s, np.sin(turned)), _at(since_s, np.cos(turned)))))


def _home_up_m(truth: Truth, serial: str) -> float:
    """Return how high a drone took off above the site's origin."""
    profile = truth.scenario.site.profiles.get(serial)
    if profile is None or profile.pad is None:
        return 0.0
    return float(enu_from_point(truth.scenario.frame, profile.pad)[2])


def truth_rows(flight: FlightData, photos: Iterator[PhotoFile]) -> Iterator[tuple[PhotoFile, str]]:
    """Yield each photo with its row of `TRUTH_COLUMNS`.

    Omega, phi and kappa turn about east, north and up: R = Rx(omega) Ry(phi) Rz(kappa) takes the
    camera's right, up and backward to east, north and up.
    """
    for photo in photos:
        shot, pose = photo.shot, photo.shot.pose
        latitude, longitude, height = (
            float(part[0]) for part in geo_from_enu(flight.frame, shot.place_m[np.newaxis])
        )
        angles = _omega_phi_kappa_deg(pose.rotation_enu_camera)
        numbers = [
            *(f"{each:.4f}" for each in shot.place_m.tolist()),
            f"{latitude:.9f}",
            f"{longitude:.9f}",
            f"{height:.4f}",
            f"{shot.height_above_takeoff_m:.4f}",
            *(f"{each:.5f}" for each in angles),
            f"{photo.sunlit:.4f}",
        ]
        time = flight.utc(shot.utc_ns - flight.utc_ahead_ns)
        yield photo, ",".join([shot.name, shot.serial, time, *numbers])


def _omega_phi_kappa_deg(rotation: FloatArray) -> tuple[float, float, float]:
    right, down, forward = rotation.T
    turned = np.stack([right, -down, -forward], axis=1)
    omega = np.arctan2(-turned[1, 2], turned[2, 2])
    phi = np.arcsin(np.clip(turned[0, 2], -1.0, 1.0))
    kappa = np.arctan2(-turned[0, 1], turned[0, 0])
    return float(np.degrees(omega)), float(np.degrees(phi)), float(np.degrees(kappa))
