#!/bin/sh
# Brings a Chromium for the end-to-end test: through apt where that may be done, else says how.
# Without a window of its own (the headless shell) it takes a quarter less of the processor, so root, as
# in CI, installs that beside any other.
if [ -n "$RECON_CHROMIUM" ] && [ -x "$RECON_CHROMIUM" ]; then exit 0; fi
shell=chromium-headless-shell
command -v $shell >/dev/null 2>&1 && exit 0
if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1; then
    apt-get install -y -qq $shell >/dev/null 2>&1 && exit 0
fi
for name in chromium chromium-browser google-chrome; do
    command -v "$name" >/dev/null 2>&1 && exit 0
done
if command -v apt-get >/dev/null 2>&1; then
    if [ "$(id -u)" = 0 ]; then run=""; elif sudo -n true 2>/dev/null; then run="sudo -n"; else run="no"; fi
    if [ "$run" != no ]; then
        echo "recon: installing Chromium for the end-to-end test"
        $run apt-get update -qq
        for name in $shell chromium; do
            $run apt-get install -y -qq "$name" >/dev/null 2>&1 && exit 0
        done
    fi
fi
echo "recon: the end-to-end test needs Chromium; install it with: sudo apt-get install chromium" >&2
exit 1
