package recon.wire

/**
 * A packet of the drone interface; fields are documented in docs/icd.md, in the same order.
 *
 * Values are kept as they came, outside their enumerations too: a codec does not judge meaning.
 */
sealed interface Packet {
    val pid: Int

    fun write(out: FieldWriter)
}

/** How packets of one PID are sized and read: each packet declares its own, [PacketTable] lists them. */
internal class PacketFormat(
    val pid: Int,
    /** Bytes of the payload that [rule] reads. */
    val lengthBytes: Int = 0,
    /** What holds before those bytes are in. */
    val widest: (Limits) -> SizeRule,
    val rule: (FieldReader, Limits) -> SizeRule = { _, limits -> widest(limits) },
    val read: (FieldReader) -> Packet,
)

internal fun fixedFormat(pid: Int, payloadBytes: Int, read: (FieldReader) -> Packet): PacketFormat {
    val size = SizeRule.Exactly(FRAME_BYTES + payloadBytes.toLong())
    return PacketFormat(pid, widest = { size }, read = read)
}

/** The formats of all packets. An object of its own: packets initialise without it, and it after them. */
internal object PacketTable {
    private val byPid: Map<Int, PacketFormat> = listOf(
        CoreTelemetry.FORMAT,
        ExtendedTelemetry.FORMAT,
        Image.FORMAT,
        Acknowledgment.FORMAT,
        MessageString.FORMAT,
        CompressedImage.FORMAT,
        VirtualStickCommand.FORMAT,
        ExecuteWaypointMission.FORMAT,
        CameraControl.FORMAT,
        EmergencyCommand.FORMAT,
    ).associateBy { it.pid }

    fun formatOf(pid: Int): PacketFormat = byPid[pid] ?: unknownFormat(pid)

    fun isKnown(pid: Int): Boolean = pid in byPid
}

private fun unknownFormat(pid: Int) = PacketFormat(
    pid,
    widest = { SizeRule.Between(FRAME_BYTES.toLong(), FRAME_BYTES + it.maxUnknownBytes.toLong()) },
    read = { UnknownPacket(pid, it.bytes(it.remaining)) },
)

/** A well-framed packet whose PID docs/icd.md does not have. */
data class UnknownPacket(override val pid: Int, val payload: Bytes) : Packet {
    override fun write(out: FieldWriter) = out.bytes(payload)
}
