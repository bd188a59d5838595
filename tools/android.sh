#!/bin/sh
# Prints Maven's option for the app of the companion where the tools for an APK are, else says how to get them.
for tool in aapt aapt2 zipalign apksigner; do
    command -v "$tool" >/dev/null 2>&1 && continue
    echo "recon: no APK of the app is built: '$tool' is missing (Debian: apt-get install aapt apksigner zipalign)" >&2
    exit 0
done
echo "-Papp"
