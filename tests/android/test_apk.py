"""The APK as a phone would judge it: `make android` builds it where its tools are."""

import re
import subprocess
import zipfile
from pathlib import Path

import pytest

APK = Path(__file__).parents[2] / "android/app/target/recon-companion.apk"
PERMISSIONS = {
    "ACCESS_NETWORK_STATE",
    "ACCESS_WIFI_STATE",
    "CAMERA",
    "CHANGE_WIFI_MULTICAST_STATE",
    "FOREGROUND_SERVICE",
    "FOREGROUND_SERVICE_CONNECTED_DEVICE",
    "INTERNET",
    "POST_NOTIFICATIONS",
    "WAKE_LOCK",
}
pytestmark = pytest.mark.skipif(
    not APK.is_file(), reason="no APK: its tools are missing, see make android"
)


def _run(*command: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_it_is_signed_and_a_changed_byte_is_noticed(tmp_path: Path) -> None:
    verified = _run("apksigner", "verify", "--verbose", APK)
    assert verified.returncode == 0, verified.stderr
    assert "v2 scheme (APK Signature Scheme v2): true" in verified.stdout

    changed = bytearray(APK.read_bytes())
    changed[1000] ^= 1
    copy = tmp_path / "changed.apk"
    copy.write_bytes(changed)
    assert _run("apksigner", "verify", copy).returncode != 0


def test_its_manifest_says_what_it_is_and_asks_for_no_more_than_it_needs() -> None:
    badging = _run("aapt2", "dump", "badging", APK)
    assert badging.returncode == 0, badging.stderr
    lines = badging.stdout.splitlines()
    assert lines[0].startswith("package: name='recon.app' ")
    assert "sdkVersion:'26'" in lines
    assert "targetSdkVersion:'34'" in lines
    assert any(
        line.startswith("launchable-activity: name='recon.app.MainActivity'") for line in lines
    )
    assert "application-debuggable" not in lines
    asked = re.findall(r"uses-permission: name='android\.permission\.(\w+)'", badging.stdout)
    assert set(asked) == PERMISSIONS
    # Nothing that a tablet or a controller may lack is required.
    required = re.findall(r"^  uses-feature: name='([^']+)'", badging.stdout, re.MULTILINE)
    assert required == ["android.hardware.faketouch"]


def test_it_is_aligned_and_its_resources_are_stored_as_android_11_requires() -> None:
    assert _run("zipalign", "-c", "-p", "4", APK).returncode == 0
    with zipfile.ZipFile(APK) as apk:
        assert apk.getinfo("resources.arsc").compress_type == zipfile.ZIP_STORED


def test_it_holds_the_simulated_aircraft_and_says_that_it_lacks_djis_runtime() -> None:
    with zipfile.ZipFile(APK) as apk:
        dex = b"".join(apk.read(name) for name in apk.namelist() if name.endswith(".dex"))
    assert b"Lrecon/sim/SimulatedAircraft;" in dex
    assert b"Lrecon/app/CompanionService;" in dex
    assert b"It lacks DJI's runtime: no real drone can be connected." in dex
    assert not re.search(rb"Ldji/|Lcom/dji/|Lrecon/msdk5/", dex)
