#!/bin/sh
# Guess:   importing a client library changes nothing outside itself.
# True:    importing mavsdk 3.17.4 makes uvloop's the event loop policy of the whole process, where uvloop is installed.
# Why:     the package sets the policy when it is imported (mavsdk/__init__.py in the wheel); seen with uvloop 0.22.1.
# Matters: a later asyncio.run of unrelated code gets another loop: other errors of sockets failed tests of Recon in the same process.

set -eu
FOLDER=$(mktemp -d)
trap 'rm -rf "$FOLDER"' EXIT
python3 -m venv "$FOLDER/venv"
"$FOLDER/venv/bin/pip" install --quiet --disable-pip-version-check mavsdk==3.17.4 uvloop==0.22.1

cat > "$FOLDER/look.py" <<'END'
import asyncio
import sys
import warnings
from importlib.metadata import version

# The package warns that it was renamed, and Python that policies will go: neither is the finding.
warnings.simplefilter("ignore")


def library(thing: object) -> str:
    return type(thing).__module__.partition(".")[0]


async def loop_library() -> str:
    return library(asyncio.get_running_loop())


print(f"Python {sys.version.split()[0]}, mavsdk {version('mavsdk')}, uvloop {version('uvloop')}")
for moment in ("before", "after"):
    if moment == "after":
        import mavsdk
    print(f"{moment} the import: policy of {library(asyncio.get_event_loop_policy())}")
    print(f"{moment} the import: loop of {asyncio.run(loop_library())}")
END

"$FOLDER/venv/bin/python" "$FOLDER/look.py" | tee "$FOLDER/seen"

cat > "$FOLDER/expected" <<'END'
before the import: policy of asyncio
before the import: loop of asyncio
after the import: policy of uvloop
after the import: loop of uvloop
END
tail -n +2 "$FOLDER/seen" | diff "$FOLDER/expected" - || { echo "changed since the finding was written"; exit 1; }
echo "as it was found"
