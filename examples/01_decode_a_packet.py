"""Decode packets from bytes: a hover command and an acknowledgment with noise between them.

Run: uv run python examples/01_decode_a_packet.py
"""

from recon import wire

NOISE = bytes.fromhex("da00ff")


def main() -> None:
    """Encode two packets, insert noise, and decode the packets again."""
    stream = (
        wire.encode(wire.EmergencyCommand(action=0))
        + NOISE
        + wire.encode(wire.Acknowledgment(positive=1, source_pid=255))
    )
    print(stream.hex())

    deframer = wire.Deframer()
    for byte in stream:
        for packet in deframer.feed(bytes([byte]), now_ns=0):
            print(packet)
    print("skipped bytes:", deframer.counters.bytes_skipped)


if __name__ == "__main__":
    main()
