"""`recon sim photos`: the photos that a simulated flight's survey drones would have taken."""

from pathlib import Path
from typing import Annotated

import typer

from recon.cli.opened_flight import opened_flight
from recon.cli.own_files import scenarios_folder
from recon.cli.progress import progress_over
from recon.model.errors import RecordError
from recon.product.flight import FlightData
from recon.score.survey_photos import TRUTH_COLUMNS, card_of, shots_of, truth_rows
from recon.score.truth import Truth, truth_of
from recon.sim.photos.cameras import CAMERAS, CameraName
from recon.sim.photos.card import USUAL_COLS, CardSettings

TRUTH_FILE = "truth.csv"


def photos_command(
    flight: Annotated[Path, typer.Argument(help="A record of a simulated flight (MCAP).")],
    out: Annotated[Path, typer.Option("--out", help="Folder to write.")] = Path("photos"),
    camera: Annotated[CameraName, typer.Option(help="The camera.")] = CameraName.MAVIC_3E,
    width: Annotated[
        int, typer.Option(min=160, max=6000, help="Columns of the photos; the camera's are most.")
    ] = USUAL_COLS,
    every: Annotated[
        int, typer.Option(min=1, max=1000, help="Write every Nth photo of each drone.")
    ] = 1,
    clock_ahead: Annotated[
        float, typer.Option(min=-1e9, max=1e9, help="Seconds of the cameras' clock before UTC.")
    ] = 0.0,
    gnss_error: Annotated[
        float | None,
        typer.Option(
            min=0.0, max=100.0, help="Error of positions, m, each axis; default: the camera's."
        ),
    ] = None,
    gimbal_yaw_off: Annotated[
        float, typer.Option(min=-360.0, max=360.0, help="Error of the stated gimbal yaw, degrees.")
    ] = 0.0,
    gimbal_roll_180: Annotated[
        bool,
        typer.Option(
            "--gimbal-roll-180", help="State the gimbal rolled and turned by 180 degrees."
        ),
    ] = False,
    gimbal: Annotated[
        bool, typer.Option("--gimbal/--no-gimbal", help="State the gimbal's attitude.")
    ] = True,
    scenario: Annotated[
        Path | None, typer.Option(help="The scenario's file; default: Recon's own of its name.")
    ] = None,
) -> None:
    """Render the photos that a simulated flight's drones would have taken, and the truth."""
    model = CAMERAS[camera]
    settings = CardSettings(
        camera=model,
        cols=min(width, model.cols),
        clock_ahead_s=clock_ahead,
        gnss_m=gnss_error,
        states_gimbal=gimbal,
        gimbal_yaw_off_deg=gimbal_yaw_off,
        is_roll_180=gimbal_roll_180,
    )
    flown = opened_flight(flight)
    truth = simulated_truth(flown, scenario)
    count = write_photos(out, flown, truth, settings, every)
    print(f"{count} photos of {model.make} {model.model}, and {TRUTH_FILE}, written to {out}")


def simulated_truth(flight: FlightData, scenario: Path | None) -> Truth:
    """Return a flight's simulated world; raises `RecordError` for one of real drones."""
    truth = truth_of(flight.scenario, scenario, scenarios_folder())
    if truth is None:
        raise RecordError(
            f"{flight.path}: expected a simulated flight, as recon demo records one, got one that "
            "states no simulated world: photos of real drones are on their cards"
        )
    return truth


def write_photos(
    out: Path, flight: FlightData, truth: Truth, settings: CardSettings, every: int = 1
) -> int:
    """Write the photos and `TRUTH_FILE` into a folder; return how many."""
    shots = shots_of(flight, truth, every)
    photos = progress_over(
        card_of(flight, truth, settings).photos(shots), "rendering photos", len(shots)
    )
    try:
        out.mkdir(parents=True, exist_ok=True)
        with (out / TRUTH_FILE).open("w", encoding="utf-8") as rows:
            rows.write(f"{TRUTH_COLUMNS}\n")
            for photo, row in truth_rows(flight, photos):
                (out / photo.shot.name).write_bytes(photo.jpeg)
                rows.write(f"{row}\n")
    except OSError as problem:
        raise RecordError(f"{problem.filename or out}: {problem.strerror}") from problem
    return len(shots)
