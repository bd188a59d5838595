"""Registration frame by frame: which reference a frame is aligned with, and with what result.

Theory of operation. The first frame with enough texture, taken at a hover, becomes the reference;
its pose is what telemetry (and, through the marked frame, the control points) gives. Each later
frame is aligned with a reference:

- An older reference comes before a newer one, so that errors do not add up from frame to frame:
  each frame tries one of the older ones, in turn, then the one used last, then the newest.
- A frame that still fits, but with few features (the light or the view changed), becomes a
  reference itself, with the pose it has. The first reference is kept, and of the others the newest.
- A frame that fits none keeps telemetry's pose and the reason. After 3 s without a registered frame
  registration is lost; it is found again by the first frame that fits. Lost for 30 s, a frame with
  enough texture begins anew with telemetry's pose: the drone has flown elsewhere.
"""

from dataclasses import dataclass

import numpy as np

from recon.camera.registration.lens_view import GreyImage, LensView
from recon.camera.registration.reference import Alignment, Reference, align, reference_of
from recon.camera.registration.settings import RegistrationSettings
from recon.camera.registration.tracking import local_contrast
from recon.model.imagery import CameraPose, Registration, RgbImage
from recon.model.replacing import replace


@dataclass(frozen=True, slots=True, eq=False)
class TimedPose:
    """Telemetry's pose for one frame."""

    pose: CameraPose
    at_s: float

    def speed_mps(self, before: "TimedPose") -> float:
        """Return the mean speed since another pose; infinite when no time has passed."""
        apart_m = np.linalg.norm(self.pose.position_enu_m - before.pose.position_enu_m)
        return float(apart_m) / (self.at_s - before.at_s) if self.at_s > before.at_s else np.inf


@dataclass(frozen=True, slots=True, eq=False)
class RegistrationState:
    """What is kept between frames: the references, oldest first, and the last success."""

    references: tuple[Reference, ...] = ()
    used: int = 0
    """Index of the reference that the last registered frame was aligned with."""
    turn: int = 0
    """Counts frames: which of the older references is tried."""
    last_at_s: float | None = None
    """Time of the newest registered frame, or of the first frame before there was one."""
    newest_prior: TimedPose | None = None


@dataclass(frozen=True, slots=True, eq=False)
class RegisteredPose:
    """A frame's pose and how it was found; `problem` is empty for a registered one.

    The covariance of a registered pose is relative to the reference's pose. `residual_m` is the
    median distance on the ground between features and where the pose puts them.
    """

    pose: CameraPose
    registration: Registration
    residual_m: float | None = None
    problem: str = ""
    inliers: int = 0
    generation: int = 0


def step(
    view: LensView,
    state: RegistrationState,
    rgb: RgbImage,
    prior: CameraPose,
    at_s: float,
) -> tuple[RegistrationState, RegisteredPose]:
    """Register one frame (rows, cols, 3) taken at `at_s`; `prior` is the pose by telemetry."""
    if state.references and state.references[0].contrast.shape != view.mask.shape:
        state = RegistrationState()  # frames of another size
    before = state.newest_prior
    since_s = at_s if state.last_at_s is None else state.last_at_s
    state = replace(
        state, last_at_s=since_s, turn=state.turn + 1, newest_prior=TimedPose(prior, at_s)
    )
    contrast = local_contrast(view, view.grey(rgb))
    problem = ""
    for index in _candidates(state):
        found = align(view, state.references[index], contrast, prior)
        if not found.problem:
            return _registered(view, state, contrast, index, found, at_s)
        problem = found.problem
    if not state.references or at_s - since_s > view.settings.new_start_after_s:
        return _begun(view, state, contrast, before)
    return state, _failed(view, prior, problem, at_s - since_s)


def _candidates(state: RegistrationState) -> tuple[int, ...]:
    """Return the references to try, in order."""
    if not state.references:
        return ()
    newest = len(state.references) - 1
    in_turn = (state.turn % state.used,) if state.used > 0 else ()
    return tuple(dict.fromkeys((*in_turn, state.used, newest)))


def _begun(
    view: LensView, state: RegistrationState, contrast: GreyImage, before: TimedPose | None
) -> tuple[RegistrationState, RegisteredPose]:
    """Begin with this frame as a reference at telemetry's pose, if it can be one."""
    now = state.newest_prior
    assert now is not None
    assert state.last_at_s is not None
    reference = reference_of(view, contrast, now.pose, now.at_s, 0)
    if problem := _unfit(view, reference, now, before):
        return state, _failed(view, now.pose, problem, now.at_s - state.last_at_s)
    state = _with(state, reference, view.settings)
    state = replace(state, used=len(state.references) - 1, last_at_s=now.at_s)
    return state, RegisteredPose(
        now.pose, Registration.UNREGISTERED, problem="this frame becomes the reference"
    )


def _unfit(view: LensView, reference: Reference, now: TimedPose, before: TimedPose | None) -> str:
    """Return why a frame is no reference to begin with; empty if it is one."""
    settings = view.settings
    height_m = float(now.pose.position_enu_m[2])
    if not height_m >= settings.least_height_m:
        return (
            f"the camera is {height_m:.0f} m above the ground, a reference frame needs "
            f"{settings.least_height_m:g} m"
        )
    if before is None:
        return "the first frame: the drone's speed is known from the second on"
    if not now.speed_mps(before) <= settings.largest_speed_mps:
        return "the drone is moving: a reference frame is taken at a hover"
    count, fewest = len(reference.pixels), 2 * settings.fewest_inliers
    if count < fewest:
        return f"{count} features in the frame, a reference needs {fewest}: too dark or blurred"
    return ""


def _registered(
    view: LensView,
    state: RegistrationState,
    contrast: GreyImage,
    index: int,
    found: Alignment,
    at_s: float,
) -> tuple[RegistrationState, RegisteredPose]:
    settings, generation = view.settings, state.references[index].generation
    state = replace(state, used=index, last_at_s=at_s)
    is_weak = found.inlier_share < settings.hand_on_share
    if is_weak and at_s - state.references[-1].taken_at_s >= settings.hand_on_apart_s:
        new = reference_of(view, contrast, found.pose, at_s, generation + 1)
        if len(new.pixels) >= 2 * settings.fewest_inliers:
            state = _with(state, new, settings)
    return state, RegisteredPose(
        found.pose,
        Registration.REGISTERED,
        found.residual_m,
        inliers=found.inliers,
        generation=generation,
    )


def _with(
    state: RegistrationState, new: Reference, settings: RegistrationSettings
) -> RegistrationState:
    """Return the state with a new reference; of too many, the second oldest goes."""
    kept, used = (*state.references, new), state.used
    if len(kept) > settings.references:
        kept = (kept[0], *kept[2:])
        used = len(kept) - 1 if used == 1 else max(0, used - 1)
    return replace(state, references=kept, used=used)


def _failed(view: LensView, prior: CameraPose, problem: str, without_s: float) -> RegisteredPose:
    is_lost = without_s > view.settings.lost_after_s
    status = Registration.LOST if is_lost else Registration.UNREGISTERED
    return RegisteredPose(prior, status, problem=problem)
