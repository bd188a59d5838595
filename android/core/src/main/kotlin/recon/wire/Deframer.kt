package recon.wire

/** What a deframer has seen (docs/icd.md, "Counters"). */
data class Counters(
    var packets: Long = 0,
    var badHash: Long = 0,
    var badSize: Long = 0,
    var unknownPid: Long = 0,
    var abandoned: Long = 0,
    var bytesSkipped: Long = 0,
    /** Those of [bytesSkipped] inside a frame of a possible size that was damaged or never completed. */
    var bytesDamaged: Long = 0,
)

/** A packet, and when its last byte came, however long a false header withheld it. */
data class ArrivedPacket(val packet: Packet, val arrivedNs: Long)

/**
 * Finds the packets in one direction of one connection (docs/icd.md, "Reading a stream").
 *
 * Theory of operation. Bytes are held from the first that may begin a frame. [poll] judges the frame
 * at the front and does one of four things: it waits for more bytes, returns the packet, or gives up
 * one byte and searches the next sync behind it, because the size is impossible, or because the hash
 * differs. A frame that waits for 2 s without a byte, whose first byte is 10 s old, or that meets the
 * end of the stream, gives up one byte in the same way. So every intact packet of a damaged stream is
 * found, and packets and counters do not depend on how the bytes were split.
 *
 * Time is an argument, in nanoseconds of any one clock. A call of [poll] does work in proportion to
 * the bytes held at most, and returns after one packet.
 */
class Deframer(private val limits: Limits = Limits()) {
    val counters = Counters()
    private val held = Held()
    private val arrivals = Arrivals(limits.ageTimeoutNs)

    /** Stream position of the first byte held, or of the next to come. */
    private var position = 0L
    private var lastByteNs = 0L
    private var deliveredNs = Long.MIN_VALUE

    /** Half a packet that begins before this position has waited too long. */
    private var giveUpBefore = 0L
    private var damagedBefore = 0L

    val pendingBytes: Int get() = held.size

    /** Memory in use, in bytes. */
    val bufferedBytes: Int get() = held.capacityBytes

    /** Takes in bytes received at [nowNs]; their packets come from [poll]. */
    fun push(data: ByteArray, nowNs: Long, from: Int = 0, to: Int = data.size) {
        tick(nowNs)
        if (from == to) return
        held.append(data, from, to - from)
        lastByteNs = nowNs
        arrivals.forgetBefore(position)
        arrivals.note(end, nowNs)
    }

    /** Lets half a packet fail that has waited too long by [nowNs]; what is behind it comes from [poll]. */
    fun tick(nowNs: Long) {
        if (held.size == 0) return
        val isStalled = nowNs - lastByteNs >= limits.stallTimeoutNs
        giveUpBefore = maxOf(giveUpBefore, if (isStalled) end else arrivals.endOfOlderThan(nowNs))
    }

    /** Ends the stream: what is held is searched for whole packets by [poll]. */
    fun finish() {
        giveUpBefore = end
    }

    /** The next packet, or null until more bytes or time have come. */
    fun poll(): ArrivedPacket? {
        while (skipToSync()) {
            when (val claim = claimOf(held.bytes, held.start, held.end, limits)) {
                is Claim.Impossible -> {
                    counters.badSize++
                    skip(1)
                }
                is Claim.Wants -> if (!abandon(0)) return null
                is Claim.Whole ->
                    if (claim.size <= held.size) judge(claim)?.let { return it }
                    else if (!abandon(claim.size)) return null
            }
        }
        return null
    }

    private val end: Long get() = position + held.size

    private fun skipToSync(): Boolean {
        skip(held.bytesBeforeSync())
        return held.size > 0
    }

    /** Gives up the half frame at the front if it has waited too long. */
    private fun abandon(frameBytes: Int): Boolean {
        if (position >= giveUpBefore) return false
        counters.abandoned++
        damagedBefore = maxOf(damagedBefore, position + frameBytes)
        skip(1)
        return true
    }

    private fun judge(claim: Claim.Whole): ArrivedPacket? {
        if (hashAt(held.bytes, held.start + claim.size - 2) != held.hashOfFirst(claim.size - 2)) {
            counters.badHash++
            damagedBefore = maxOf(damagedBefore, position + claim.size)
            skip(1)
            return null
        }
        val packet = packetOf(held.bytes, held.start, claim)
        counters.packets++
        if (!PacketTable.isKnown(claim.pid)) counters.unknownPid++
        advance(claim.size)
        return ArrivedPacket(packet, arrivalOf(position - 1))
    }

    private fun arrivalOf(position: Long): Long {
        // Marks are coarse by a thousandth of the patience: never before that of an earlier packet.
        deliveredNs = maxOf(deliveredNs, arrivals.of(position) ?: lastByteNs)
        return deliveredNs
    }

    private fun skip(count: Int) {
        counters.bytesSkipped += count
        counters.bytesDamaged += (damagedBefore - position).coerceIn(0L, count.toLong())
        advance(count)
    }

    private fun advance(count: Int) {
        held.advance(count)
        position += count
    }
}

/** When the bytes of a stream came; bytes shortly after one another share a mark. */
private class Arrivals(private val ageTimeoutNs: Long) {
    private class Mark(var end: Long, val atNs: Long)

    private val marks = ArrayDeque<Mark>()

    /** Notes that the bytes up to stream position [end] had come by [nowNs]. */
    fun note(end: Long, nowNs: Long) {
        val last = marks.lastOrNull()
        if (last != null && nowNs - last.atNs <= ageTimeoutNs / MARKS) last.end = end else marks.add(Mark(end, nowNs))
    }

    /** When the byte at [position] came; forgets everything before it. */
    fun of(position: Long): Long? {
        forgetBefore(position)
        return marks.firstOrNull()?.atNs
    }

    fun forgetBefore(position: Long) {
        while (marks.isNotEmpty() && marks.first().end <= position) marks.removeFirst()
    }

    /** The position before which every byte is older than the age limit. */
    fun endOfOlderThan(nowNs: Long): Long = marks.lastOrNull { nowNs - it.atNs >= ageTimeoutNs }?.end ?: 0L

    private companion object {
        const val MARKS = 1024
    }
}
