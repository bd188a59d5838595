"""The root of Recon's error tree.

    ReconError              text: what was expected, what was found, what to do
    |- MethodError          recon.model.methods: methods of installed packages
    |- WireError            recon.wire: bytes or values that do not form a packet
    |- CameraError          recon.camera: calibration, control points, pose, frames
    |- SiteError            recon.site: a site's folder
    |- BaseMapError         recon.basemap: files of base maps, and fetching them
    |- FetchError           recon.fetching: servers and files asked for what a site needs
    |- RecordError          recon.record: files of a flight
    |- SimulationError      recon.sim: options and inputs of the simulator
    |- ClientError          recon.client: connecting to a station
    |- GatewayError         recon.gateway: a gateway that cannot start
    |- AnnouncementError    recon.link: the station cannot announce itself by mDNS
    |- StartError           recon.station: the station cannot start

The command line prints the text of a `ReconError` as one sentence; `recon.cli.exit_codes` gives its
exit code. Refused commands are values, not errors (`recon.model.command.Refusal`).
"""

import traceback
from pathlib import Path
from typing import ClassVar


class ReconError(Exception):
    """An error that is reported to the user as one sentence."""

    is_failure: ClassVar[bool] = False
    """Whether the work failed though it was asked for rightly; else the person names what is not
    there or does not fit."""


class SiteError(ReconError):
    """A site's folder cannot be used; the message names the file, the key, what was expected."""


class RecordError(ReconError):
    """A file could not be read or written; the message names the file and the reason."""


def describe_fault(fault: BaseException) -> str:
    """Return one line for a fault in Recon's own code: the error, its file and line."""
    frames = traceback.extract_tb(fault.__traceback__)
    place = f" ({Path(frames[-1].filename).name}:{frames[-1].lineno})" if frames else ""
    return f"{type(fault).__name__}: {fault}{place}"
