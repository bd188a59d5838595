"""The root of Recon's error tree.

    ReconError              its text says what was expected, what came, and what to do
    |- WireError            recon.wire: bytes or values that are no packet
    |- CameraError          recon.camera: calibration, control points, pose, frames
    |- SiteError            recon.site: a site's folder
    |- RecordError          recon.record: files written of a flight
    |- SimulationError      recon.sim: options and inputs of the simulator
    |- ClientError          recon.client: the way to a station
    |- StartError           recon.station: the station cannot start

The command line prints the text of a `ReconError` as one sentence and exits with 1. Refused
commands are no errors: they are values (`recon.model.command.Refusal`).
"""

import traceback
from pathlib import Path


class ReconError(Exception):
    """Something that Recon tells its user in one sentence."""


def described(fault: BaseException) -> str:
    """Return a fault of Recon's own code in one line: what, and the file and line it arose at."""
    frames = traceback.extract_tb(fault.__traceback__)
    place = f" ({Path(frames[-1].filename).name}:{frames[-1].lineno})" if frames else ""
    return f"{type(fault).__name__}: {fault}{place}"
