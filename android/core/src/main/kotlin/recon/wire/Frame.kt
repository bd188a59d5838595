package recon.wire

/** Bytes around every payload: sync, size and PID before it, the hash after it. */
internal const val FRAME_BYTES = 9
internal const val HEADER_BYTES = 7
internal const val SYNC = 0xDAA7
internal const val SYNC_FIRST = 0xDA.toByte()
internal const val SYNC_SECOND = 0xA7.toByte()

/** What the first bytes of a frame claim about it. */
internal sealed interface Claim {
    /** Too few bytes to judge the size; [bytes] of the frame are wanted. */
    data class Wants(val bytes: Int) : Claim

    /** A possible frame of [size] bytes. */
    data class Whole(val pid: Int, val size: Int) : Claim

    data class Impossible(val pid: Int, val rule: SizeRule, val size: Long) : Claim
}

/** Judges the size of the frame that begins at [from], of which the bytes up to [to] are in. */
internal fun claimOf(bytes: ByteArray, from: Int, to: Int, limits: Limits): Claim {
    if (to - from < HEADER_BYTES) return Claim.Wants(HEADER_BYTES)
    val header = FieldReader(bytes, from + 2, from + HEADER_BYTES)
    val size = header.u32()
    val pid = header.u8()
    val format = PacketTable.formatOf(pid)
    val hasLengths = to - from >= HEADER_BYTES + format.lengthBytes
    val payload = FieldReader(bytes, from + HEADER_BYTES, to)
    val rule = if (hasLengths) format.rule(payload, limits) else format.widest(limits)
    if (!rule.allows(size)) return Claim.Impossible(pid, rule, size)
    return if (hasLengths) Claim.Whole(pid, size.toInt()) else Claim.Wants(HEADER_BYTES + format.lengthBytes)
}

/** The packet of a frame whose size and hash are good. */
internal fun packetOf(bytes: ByteArray, from: Int, claim: Claim.Whole): Packet =
    PacketTable.formatOf(claim.pid).read(FieldReader(bytes, from + HEADER_BYTES, from + claim.size - 2))

/** The hash of [bytes] in a range: A in the upper byte, B in the lower (docs/icd.md, "The frame"). */
internal fun hashOf(bytes: ByteArray, from: Int, to: Int): Int {
    var a = 0
    var b = 0
    for (index in from until to) {
        a += bytes[index]
        b += a
    }
    return (a and 0xFF shl 8) or (b and 0xFF)
}

internal fun hashAt(bytes: ByteArray, at: Int): Int = FieldReader(bytes, at, at + 2).u16()

/** The frame of a packet. Raises [WireError] when a value does not fit its field or the limits. */
fun encode(packet: Packet, limits: Limits = Limits()): ByteArray {
    val out = FieldWriter()
    out.u16("sync", SYNC)
    out.i32(0)
    out.u8("pid", packet.pid)
    packet.write(out)
    val size = out.size + 2
    out.patchI32(2, size)
    val written = out.toByteArray()
    val claim = claimOf(written, 0, written.size, limits)
    if (claim is Claim.Impossible) throw WireError.Size(packet.pid, claim.rule, size.toLong())
    out.u16("hash", hashOf(written, 0, written.size))
    return out.toByteArray()
}

/** The packet of exactly one frame. Raises [WireError]. */
fun decode(frame: ByteArray, limits: Limits = Limits()): Packet {
    if (frame.size >= 2 && hashAt(frame, 0) != SYNC) throw WireError.Sync(hashAt(frame, 0))
    val claim = when (val claim = claimOf(frame, 0, frame.size, limits)) {
        is Claim.Wants -> throw WireError.Short("The packet", claim.bytes, frame.size)
        is Claim.Impossible -> throw WireError.Size(claim.pid, claim.rule, claim.size)
        is Claim.Whole -> claim
    }
    if (frame.size < claim.size) throw WireError.Short("The packet", claim.size, frame.size)
    if (frame.size > claim.size) {
        throw WireError.Size(claim.pid, SizeRule.Exactly(claim.size.toLong()), frame.size.toLong())
    }
    val expected = hashOf(frame, 0, frame.size - 2)
    val came = hashAt(frame, frame.size - 2)
    if (came != expected) throw WireError.Hash(expected, came)
    return packetOf(frame, 0, claim)
}
