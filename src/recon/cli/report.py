"""`recon report`: a flight's report as one HTML file, and as PDF."""

import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

import typer

from recon.cli.opened_flight import opened_flight
from recon.cli.output import print_line
from recon.cli.progress import opener
from recon.model.errors import RecordError
from recon.product.flight_log import read_log
from recon.product.mosaic.finished import finished_mosaic
from recon.product.report import flight_report
from recon.product.report_page import report_html
from recon.product.tagged import tagged_photos
from recon.product.write import write_text

BROWSERS = (
    *("chromium", "chromium-browser", "google-chrome", "google-chrome-stable"),
    *("microsoft-edge", "msedge", "chrome"),
)
PRINT_WITHIN_S = 60.0


def report_command(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A flight record (MCAP).")],
    out: Annotated[Path, typer.Option(help="HTML file to write.")] = Path("report.html"),
    tagged: Annotated[
        Path | None,
        typer.Option(help="A folder that recon tag has written: coverage by the photos."),
    ] = None,
    mosaic: Annotated[
        Path | None, typer.Option(help="A folder that recon mosaic has written: adds its picture.")
    ] = None,
    pdf: Annotated[
        Path | None, typer.Option(help="PDF to write too; needs Chromium, Chrome or Edge.")
    ] = None,
    time_zone: Annotated[
        str | None,
        typer.Option(
            help="Zone of the local times, as America/Chicago; default: this computer's. UTC "
            "stands beside them."
        ),
    ] = None,
) -> None:
    """Write a flight's report: coverage in sun, sky, tracks, decisions, alarms, forecasts."""
    zone = None if time_zone is None else _zone(time_zone)
    flight = opened_flight(file)
    photos = None if tagged is None else tagged_photos(tagged, flight)
    try:
        log = read_log(file, flight, opener("reading decisions and forecasts"))
    except OSError as problem:
        raise RecordError(f"{file}: {problem.strerror}") from problem
    picture = None if mosaic is None else finished_mosaic(mosaic, flight.path.name)
    write_text(out, report_html(flight_report(flight, log, photos), picture, zone))
    print_line(f"written: {out}")
    if pdf is not None:
        print_pdf(out, pdf)
        print_line(f"written: {pdf}")


def _zone(name: str) -> ZoneInfo:
    try:
        return ZoneInfo(name)
    except (ZoneInfoNotFoundError, ValueError, OSError):
        raise typer.BadParameter(
            f"--time-zone: expected a name like America/Chicago, got {name!a}"
        ) from None


def print_pdf(page: Path, pdf: Path) -> None:
    """Print a page to PDF by an installed browser; raises `RecordError` without one."""
    browser = next((found for name in BROWSERS if (found := shutil.which(name))), None)
    if browser is None:
        raise RecordError(
            f"--pdf needs Chromium, Chrome or Edge on the path, found none; open {page} in any "
            "browser and print it to a file"
        )
    with TemporaryDirectory() as profile:
        command = [
            browser,
            "--headless",
            "--disable-gpu",
            # The page has no script; a sandbox needs rights that containers do not give.
            "--no-sandbox",
            f"--user-data-dir={profile}",
            "--no-pdf-header-footer",
            f"--print-to-pdf={pdf.resolve()}",
            page.resolve().as_uri(),
        ]
        try:
            ended = subprocess.run(
                command, capture_output=True, timeout=PRINT_WITHIN_S, check=False
            )
        except (OSError, subprocess.TimeoutExpired) as problem:
            raise RecordError(f"{pdf}: {browser} did not print the page: {problem}") from problem
    if ended.returncode != 0 or not pdf.is_file():
        reason = ended.stderr.decode(errors="replace").strip()[-200:]
        raise RecordError(f"{pdf}: {browser} did not print the page: {reason!a}")
