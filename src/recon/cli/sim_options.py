"""The options of `recon sim`."""

from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

from recon.sim.app.camera_feed import ImageFormat
from recon.sim.app.commands import HoverOnGround
from recon.sim.app.faults import FaultKind

MOST_VEHICLES = 256


class WaypointAltitude(Enum):
    """What a waypoint's altitude means to the simulated apps."""

    WGS84 = "wgs84"
    TAKEOFF = "takeoff"


VehiclesOption = Annotated[
    int, typer.Option(min=1, max=MOST_VEHICLES, help="How many, the eye included.")
]
StationOption = Annotated[str, typer.Option(help="HOST:PORT of the station.")]
AltitudeReferenceOption = Annotated[
    WaypointAltitude, typer.Option(help="What a waypoint's altitude means to the apps.")
]
HoverOnGroundOption = Annotated[
    HoverOnGround, typer.Option(help="What hover and return do on the ground.")
]
ImagerOption = Annotated[
    bool, typer.Option("--eye/--no-eye", help="Whether the first vehicle has a camera.")
]
AirborneOption = Annotated[
    bool | None,
    typer.Option(
        "--airborne/--grounded",
        help="All start in the air, or none; otherwise only the eye does.",
    ),
]
WanderOption = Annotated[
    bool, typer.Option(help="Survey vehicles fly to and fro until ordered otherwise.")
]
HomeOption = Annotated[
    str | None, typer.Option(help="LAT,LON to start from; default is the site's.")
]
SiteOption = Annotated[Path | None, typer.Option(help="Folder with a site.toml: place, eye, pads.")]
ReplaySiteOption = Annotated[
    Path | None,
    typer.Option(help="Folder with RefFrame.jpeg and GCPs.txt: the eye over a real field."),
]
FramesOption = Annotated[
    Path | None, typer.Option(help="Folder of images that the eye sends in turn.")
]
FrameSizeOption = Annotated[str, typer.Option(help="COLSxROWS of frames from a folder.")]
FpsOption = Annotated[float, typer.Option(help="Most frames per second the eye sends.")]
ImageFormatOption = Annotated[
    ImageFormat, typer.Option(help="How frames travel: packet 2 or packet 5.")
]
LatencySOption = Annotated[
    float | None, typer.Option(help="Capture to send; default is drawn from 0.2 to 1 s.")
]
FeedOption = Annotated[
    bool, typer.Option("--feed/--no-feed", help="Whether the eye's feed is on at the start.")
]
AltitudeBiasMOption = Annotated[
    float | None, typer.Option(help="Error of the absolute altitude; default is drawn.")
]
EnduranceMinOption = Annotated[float, typer.Option(help="Hover time of a full battery.")]
FaultOption = Annotated[
    list[str] | None,
    typer.Option(
        help="NAME[:vehicle[:start_s[:duration_s]]], again for more. Names: "
        + ", ".join(kind.value for kind in FaultKind)
    ),
]
FaultsOption = Annotated[
    Path | None, typer.Option(help="TOML file with faults by script and by chance.")
]
WindMpsOption = Annotated[
    float, typer.Option(help="Mean wind ten metres up, with its gusts; 0 is calm.")
]
WindToDegOption = Annotated[
    float, typer.Option(help="Where the wind goes, clockwise from north: 50 is to the north-east.")
]
MissionIdsOption = Annotated[
    bool,
    typer.Option(
        "--mission-ids/--no-mission-ids", help="Whether apps tell MissionID, or 0 always."
    ),
]
SeedOption = Annotated[int, typer.Option(help="The same seed behaves the same way.")]
