#!/bin/sh
# Guess:   a server of foxglove-sdk takes clients of the published Foxglove WebSocket protocol, foxglove.websocket.v1.
# True:    foxglove-sdk 0.30.3 refuses them with HTTP 400 and takes foxglove.sdk.v1 alone, though the messages are those of the published protocol.
# Why:     its handshake looks for that one name (rust/foxglove/src/websocket/handshake.rs in github.com/foxglove/foxglove-sdk).
# Matters: Lichtblick 1.21 and older, and other clients by the published protocol, cannot read the gateway's topics; the guide says which can.

set -eu
FOLDER=$(mktemp -d)
trap 'rm -rf "$FOLDER"' EXIT
python3 -m venv "$FOLDER/venv"
"$FOLDER/venv/bin/pip" install --quiet --disable-pip-version-check foxglove-sdk==0.30.3 websockets==16.0

cat > "$FOLDER/look.py" <<'END'
import json
import logging
from importlib.metadata import version

import foxglove
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

logging.disable()
print(f"foxglove-sdk {version('foxglove-sdk')}, websockets {version('websockets')}")
server = foxglove.start_server(host="127.0.0.1", port=0)
channel = foxglove.Channel("/count", schema={"type": "object"})
for name in ("foxglove.websocket.v1", "foxglove.sdk.v1"):
    try:
        with connect(f"ws://127.0.0.1:{server.port}", subprotocols=[name]) as client:
            said = [json.loads(client.recv())["op"] for _ in range(2)]
            one = {"op": "subscribe", "subscriptions": [{"id": 7, "channelId": channel.id()}]}
            client.send(json.dumps(one))
            while not channel.has_sinks():
                pass
            channel.log({"n": 1}, log_time=5)
            said.append(client.recv().hex())
            print(f"{name}: {' '.join(said)}")
    except InvalidStatus as refused:
        print(f"{name}: HTTP {refused.response.status_code}")
server.stop()
END

# The last message by the published protocol: opcode 1, subscription 7 and time 5, little-endian.
cat > "$FOLDER/expected" <<'END'
foxglove.websocket.v1: HTTP 400
foxglove.sdk.v1: serverInfo advertise 010700000005000000000000007b226e223a20317d
END
"$FOLDER/venv/bin/python" "$FOLDER/look.py" | tee "$FOLDER/seen"
tail -n +2 "$FOLDER/seen" | diff "$FOLDER/expected" - || { echo "changed since the finding was written"; exit 1; }
echo "as it was found"
