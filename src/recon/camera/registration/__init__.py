"""Registration: a frame's pose by its content, from telemetry's metres to decimetres.

    step(view, state, rgb, prior, at_s) -> (state, RegisteredPose)

`lens_view` (rays of the window, warps between poses), `tracking` (local contrast, Lucas-Kanade),
`robust_fit` (six degrees of freedom), `reference` (one frame against one reference), `step` (which
reference; lost and found). Pure: no clock, no random numbers.
"""

from recon.camera.registration.lens_view import LensView, view_of
from recon.camera.registration.settings import RegistrationSettings
from recon.camera.registration.step import RegisteredPose, RegistrationState, step
