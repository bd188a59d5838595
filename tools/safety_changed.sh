#!/bin/sh
# Usage: tools/safety_changed.sh   Succeeds when the gate, the watchdogs or their tests changed lately:
# in the last 50 commits, or uncommitted. Where that cannot be told, they did.
watched="src/recon/safety tests/safety"
commits="$(git rev-list --count --max-count=51 HEAD)" || exit 0
[ "$commits" -gt 50 ] || exit 0
# shellcheck disable=SC2086
[ -n "$(git log --format=%h --max-count=1 HEAD~50..HEAD -- $watched; git status --porcelain -- $watched)" ]
