#!/bin/sh
# Usage: tools/require.sh TOOL...   Says in one sentence what is missing and where it comes from.
missing=0
for tool in "$@"; do
    command -v "$tool" >/dev/null 2>&1 && continue
    case "$tool" in
        python3) hint="install Python 3.11 or newer (Debian: apt-get install python3 python3-venv)" ;;
        cargo) hint="install Rust 1.88 or newer from https://rustup.rs" ;;
        node | npm) hint="install Node.js 20 or newer with npm from https://nodejs.org" ;;
        java) hint="install a JDK 17 (Debian: apt-get install openjdk-17-jdk-headless)" ;;
        mvn) hint="install Maven 3.8 or newer (Debian: apt-get install maven)" ;;
        *) hint="install it and try again" ;;
    esac
    echo "recon: '$tool' is missing: $hint." >&2
    missing=1
done
[ "$missing" = 0 ] || exit 1

case " $* " in *" python3 "*)
    python3 -c 'import sys; sys.exit(sys.version_info < (3, 11))' || {
        echo "recon: Python 3.11 or newer is needed, this is $(python3 --version)." >&2
        exit 1
    } ;;
esac
case " $* " in *" node "*)
    [ "$(node -p 'parseInt(process.versions.node)')" -ge 20 ] || {
        echo "recon: Node.js 20 or newer is needed, this is $(node --version)." >&2
        exit 1
    } ;;
esac
case " $* " in *" cargo "*)
    cargo --version | awk '{ split($2, v, "."); exit !(v[1] > 1 || v[2] >= 88) }' || {
        echo "recon: Rust 1.88 or newer is needed, this is $(cargo --version): run 'rustup update'." >&2
        exit 1
    } ;;
esac
case " $* " in *" java "*)
    java -version 2>&1 | awk -F '"' '/version/ { split($2, v, "."); exit !(v[1] >= 17) }' || {
        echo "recon: a JDK 17 or newer is needed, this is $(java -version 2>&1 | head -1)." >&2
        exit 1
    } ;;
esac
