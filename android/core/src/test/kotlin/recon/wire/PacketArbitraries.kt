package recon.wire

import kotlin.random.Random

/** Draws packets of every kind, with any value that the wire can carry. */
fun drawnPacket(random: Random): Packet = when (random.nextInt(11)) {
    0 -> CoreTelemetry(
        random.u8(), random.f64(), random.f64(), random.f64(), random.f64(),
        random.f32(), random.f32(), random.f32(), random.f64(), random.f64(), random.f64(),
    )
    1 -> ExtendedTelemetry(
        random.nextInt(0x10000), random.nextInt(-128, 128), random.u8(), random.u8(), random.u8(), random.u8(),
        random.nextInt(-128, 128), random.u8(), random.u8(), random.nextInt(0x10000), random.bytes(257),
    )
    2 -> {
        val rows = random.nextInt(9)
        val cols = random.nextInt(9)
        Image(random.f32(), rows, cols, Bytes.copyOf(random.nextBytes(3 * rows * cols)))
    }
    3 -> Acknowledgment(random.u8(), random.u8())
    4 -> MessageString(random.u8(), random.bytes(400))
    5 -> CompressedImage(random.f32(), random.bytes(3_000))
    6 -> VirtualStickCommand(random.u8(), random.f32(), random.f32(), random.f32(), random.f32(), random.f32())
    7 -> ExecuteWaypointMission(random.u8(), random.u8(), List(random.nextInt(1, 100)) { drawnWaypoint(random) })
    8 -> CameraControl(random.u8(), random.f32())
    9 -> EmergencyCommand(random.u8())
    else -> UnknownPacket(random.nextInt(6, 252), random.bytes(300))
}

private fun drawnWaypoint(random: Random) = Waypoint(
    random.f64(), random.f64(), random.f64(), random.f32(), random.f32(), random.f32(), random.f32(),
)

private fun Random.u8() = nextInt(256)

private fun Random.f32() = Float.fromBits(nextInt())

private fun Random.f64() = Double.fromBits(nextLong())

private fun Random.bytes(below: Int) = Bytes.copyOf(nextBytes(nextInt(below)))

/** Packets, garbage and damaged packets in any order. */
fun drawnStream(random: Random): ByteArray {
    var stream = ByteArray(0)
    repeat(random.nextInt(1, 9)) { stream += drawnPart(random) }
    return stream
}

fun drawnPart(random: Random): ByteArray {
    val frame = encode(drawnPacket(random))
    return when (random.nextInt(6)) {
        0 -> random.nextBytes(random.nextInt(40))
        1 -> frame.copyOf(random.nextInt(frame.size))
        2 -> frame.also { it[random.nextInt(it.size)] = random.nextInt().toByte() }
        3 -> byteArrayOf(SYNC_FIRST, SYNC_SECOND) + random.nextBytes(random.nextInt(12))
        else -> frame
    }
}
