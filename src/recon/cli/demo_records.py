"""The records of demonstrations: less than all is recorded, and the oldest are deleted."""

import asyncio
from pathlib import Path

from recon.record.files.users_file import state_folder
from recon.record.mcap.record_ceiling import remove_oldest_demos
from recon.station.recording.keyframe import RecordDetail

DEMO_DETAIL = RecordDetail(keyframe_s=6.0, has_all_maps=False, flight_file_s=1_800.0, is_demo=True)
"""All frames, a twelfth of the maps: a demonstration runs for hours and its imaging drone never
lands, so that its record would be one file without end."""
MOST_RECORD_BYTES = 2_000_000_000
"""All records of demonstrations: some hours of them."""
ABOUT_RECORDS = (
    f"records of demos: at most {MOST_RECORD_BYTES / 1e9:g} GB, the oldest are deleted; "
    "--record FOLDER keeps yours"
)
LOOKS_AT_RECORDS_EVERY_S = 60.0


def demos_folder() -> Path:
    """Return the folder of the records of demonstrations."""
    return state_folder() / "demo-records"


async def keep_records_small() -> None:
    """Delete the oldest of them whenever they take too much."""
    while True:
        await asyncio.to_thread(remove_oldest_demos, demos_folder(), MOST_RECORD_BYTES)
        await asyncio.sleep(LOOKS_AT_RECORDS_EVERY_S)
