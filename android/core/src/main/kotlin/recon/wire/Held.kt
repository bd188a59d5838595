package recon.wire

/**
 * Bytes received and not yet judged, with running checksums.
 *
 * `sumA[k]` and `sumB[k]` are A and B of the hash after all bytes before index k. The hash of any
 * part is then a difference of two entries, so that a stream of false headers costs a constant for
 * each of them and not the size that each of them claims.
 */
internal class Held {
    var bytes = ByteArray(SMALLEST)
        private set
    private var sumA = ByteArray(SMALLEST + 1)
    private var sumB = ByteArray(SMALLEST + 1)
    var start = 0
        private set
    var end = 0
        private set

    val size: Int get() = end - start

    /** Memory in use, in bytes: three for each byte of the buffer. */
    val capacityBytes: Int get() = 3 * bytes.size

    fun append(data: ByteArray, from: Int, count: Int) {
        makeRoom(count)
        data.copyInto(bytes, end, from, from + count)
        var a = sumA[end]
        var b = sumB[end]
        for (index in end until end + count) {
            a = (a + bytes[index]).toByte()
            b = (b + a).toByte()
            sumA[index + 1] = a
            sumB[index + 1] = b
        }
        end += count
    }

    fun advance(count: Int) {
        start += count
        if (start < end) return
        start = 0
        end = 0
        sumA[0] = 0
        sumB[0] = 0
        if (bytes.size > KEPT) resize(SMALLEST)
    }

    /** The hash of the first [count] bytes. */
    fun hashOfFirst(count: Int): Int {
        val to = start + count
        val a = sumA[to] - sumA[start]
        val b = sumB[to] - sumB[start] - count * sumA[start]
        return (a and 0xFF shl 8) or (b and 0xFF)
    }

    /** Bytes before the next sync, or before a last byte that may be its first half. */
    fun bytesBeforeSync(): Int {
        for (index in start until end) {
            if (bytes[index] != SYNC_FIRST) continue
            if (index + 1 == end || bytes[index + 1] == SYNC_SECOND) return index - start
        }
        return size
    }

    private fun makeRoom(count: Int) {
        if (end + count <= bytes.size) return
        resize(maxOf(SMALLEST, if (size + count <= bytes.size) bytes.size else 2 * (size + count)))
    }

    private fun resize(capacity: Int) {
        val length = size
        bytes = bytes.copyOfRange(start, end).copyOf(capacity)
        sumA = sumA.copyOfRange(start, end + 1).copyOf(capacity + 1)
        sumB = sumB.copyOfRange(start, end + 1).copyOf(capacity + 1)
        start = 0
        end = length
    }

    private companion object {
        const val SMALLEST = 4_096

        /** A larger buffer is given back once it is empty. */
        const val KEPT = 262_144
    }
}
