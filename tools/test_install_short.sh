#!/bin/sh
# Usage: tools/test_install_short.sh   Installs the wheel into an environment outside the checkout, with the
# packages of the lock file and no extra, starts the demonstration there, and removes it without a trace.
set -eu
cd "$(dirname "$0")/.."
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
environment="$folder/recon"

uv run --locked --quiet python -m tools.wheel --checkout
UV_PROJECT_ENVIRONMENT="$environment" uv sync --locked --quiet --no-dev --no-install-project --link-mode symlink
uv pip install --quiet --no-deps --python "$environment" build/recon_gcs-*-linux_x86_64.whl

HOME="$folder/home" XDG_STATE_HOME="" "$environment/bin/python" tools/try_install.py "$environment/bin"

uv pip uninstall --quiet --python "$environment" recon-gcs
left="$(find "$folder" -name '*recon*' ! -path "$environment" ! -path "$folder/home/.local/state/recon*")"
[ -z "$left" ] || { echo "recon: left after it was removed: $left" >&2; exit 1; }
