package recon.wire

/** What a deframer makes of a whole stream that comes in pieces of this size. */
fun deframed(stream: ByteArray, piece: Int, limits: Limits = Limits()): Pair<List<Packet>, Counters> {
    val deframer = Deframer(limits)
    val packets = mutableListOf<Packet>()
    fun drain() {
        while (true) packets.add((deframer.poll() ?: return).packet)
    }
    var from = 0
    while (from < stream.size) {
        val to = minOf(stream.size.toLong(), from.toLong() + piece).toInt()
        deframer.push(stream, 0, from, to)
        drain()
        from = to
    }
    deframer.finish()
    drain()
    return packets to deframer.counters
}

/** The rules of docs/icd.md, "Reading a stream", on a whole stream in memory: slow and plain. */
fun deframedPlainly(stream: ByteArray, limits: Limits = Limits()): List<Packet> {
    val packets = mutableListOf<Packet>()
    var at = 0
    while (at < stream.size) {
        val claim = if (isSyncAt(stream, at)) claimOf(stream, at, stream.size, limits) else null
        val isWhole = claim is Claim.Whole && claim.size <= stream.size - at &&
            hashOf(stream, at, at + claim.size - 2) == hashAt(stream, at + claim.size - 2)
        if (isWhole) packets.add(packetOf(stream, at, claim))
        at += if (isWhole) claim.size else 1
    }
    return packets
}

private fun isSyncAt(stream: ByteArray, at: Int) = at + 1 < stream.size && hashAt(stream, at) == SYNC
