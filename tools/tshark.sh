#!/bin/sh
# Brings tshark for the dissector's test: through apt where that may be done, else says how.
command -v tshark >/dev/null 2>&1 && exit 0
if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1; then
    echo "recon: installing tshark for the dissector's test"
    { apt-get update -qq &&
        DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends tshark; } >/dev/null 2>&1 &&
        exit 0
    echo "recon: apt could not install tshark: is there a network?" >&2
fi
echo "recon: the dissector's test needs tshark; install it with: sudo apt-get install tshark" >&2
exit 1
