#!/bin/sh
# Brings a Chromium for the end-to-end test: through apt where that may be done, else says how.
for name in chromium chromium-browser google-chrome; do
    command -v "$name" >/dev/null 2>&1 && exit 0
done
if [ -n "$RECON_CHROMIUM" ] && [ -x "$RECON_CHROMIUM" ]; then exit 0; fi
if command -v apt-get >/dev/null 2>&1; then
    if [ "$(id -u)" = 0 ]; then run=""; elif sudo -n true 2>/dev/null; then run="sudo -n"; else run="no"; fi
    if [ "$run" != no ]; then
        echo "recon: installing Chromium for the end-to-end test"
        $run apt-get update -qq && $run apt-get install -y -qq chromium >/dev/null && exit 0
    fi
fi
echo "recon: the end-to-end test needs Chromium; install it with: sudo apt-get install chromium" >&2
exit 1
