package recon.wire

import net.jqwik.api.ForAll
import net.jqwik.api.Property
import net.jqwik.api.constraints.IntRange
import kotlin.random.Random
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertNull
import kotlin.test.assertTrue

private const val SECOND_NS = 1_000_000_000L
private val HOVER = EmergencyCommand(EmergencyCommand.HOVER)

class DeframerTest {

    @Property
    fun `a stream gives the same packets and counters however it was split`(
        @ForAll seed: Int,
        @ForAll @IntRange(min = 1, max = 400) piece: Int,
    ) {
        val stream = drawnStream(Random(seed))
        val (packets, counters) = deframed(stream, Int.MAX_VALUE)
        assertEquals(deframedPlainly(stream), packets)
        assertEquals(packets to counters, deframed(stream, piece))
        assertEquals(stream.size.toLong(), counters.bytesSkipped + packets.sumOf { encode(it).size.toLong() })
        assertTrue(counters.bytesDamaged <= counters.bytesSkipped)
    }

    @Test
    fun `half a packet fails after two seconds without a byte and gives up what it hid`() {
        val deframer = Deframer()
        deframer.push(falseHeader(1_000) + encode(HOVER), 0)
        assertNull(deframer.poll())
        deframer.tick(2 * SECOND_NS - 1)
        assertNull(deframer.poll())
        deframer.tick(2 * SECOND_NS)
        assertEquals(ArrivedPacket(HOVER, 0), deframer.poll())
        assertEquals(1, deframer.counters.abandoned)
        assertEquals(deframer.counters.bytesSkipped, deframer.counters.bytesDamaged)
    }

    @Test
    fun `half a packet fails when its first byte is ten seconds old, though bytes keep coming`() {
        val deframer = Deframer()
        deframer.push(falseHeader(60_000) + encode(HOVER), 0)
        for (second in 1..9) {
            deframer.push(byteArrayOf(0), second * SECOND_NS)
            assertNull(deframer.poll())
        }
        deframer.push(byteArrayOf(0), 10 * SECOND_NS)
        assertEquals(ArrivedPacket(HOVER, 0), deframer.poll())
    }

    @Test
    fun `a packet has the time at which its last byte came`() {
        val deframer = Deframer()
        val frame = encode(HOVER)
        deframer.push(frame, 0, 0, 4)
        deframer.push(frame, SECOND_NS, 4, frame.size)
        deframer.push(frame, SECOND_NS + 500_000_000)
        assertEquals(SECOND_NS, deframer.poll()?.arrivedNs)
        assertEquals(SECOND_NS + 500_000_000, deframer.poll()?.arrivedNs)
        assertNull(deframer.poll())
    }

    @Test
    fun `nothing pending never fails, and an empty read changes nothing`() {
        val deframer = Deframer()
        deframer.tick(100 * SECOND_NS)
        deframer.push(ByteArray(0), 100 * SECOND_NS)
        assertNull(deframer.poll())
        assertEquals(Counters(), deframer.counters)
    }

    @Test
    fun `memory follows the bytes that came and is given back`() {
        val deframer = Deframer()
        deframer.push(falseHeader(16_000_000), 0)
        assertNull(deframer.poll())
        assertTrue(deframer.bufferedBytes < 20_000)
        deframer.push(ByteArray(1_000_000), 1)
        assertNull(deframer.poll())
        assertTrue(deframer.bufferedBytes in 3_000_000..7_000_000)
        deframer.finish()
        assertNull(deframer.poll())
        assertEquals(0, deframer.pendingBytes)
        assertTrue(deframer.bufferedBytes < 20_000)
    }

    @Test
    fun `an hour of garbage keeps no marks of its arrival`() {
        val deframer = Deframer()
        for (second in 0..3_600L) {
            deframer.push(ByteArray(10), second * SECOND_NS)
            assertNull(deframer.poll())
        }
        deframer.push(encode(HOVER), 4_000 * SECOND_NS)
        assertEquals(4_000 * SECOND_NS, deframer.poll()?.arrivedNs)
        assertEquals(36_010, deframer.counters.bytesSkipped)
    }

    @Test
    fun `false headers that each claim megabytes cost work in proportion to the bytes`() {
        // 100,000 nested headers of 16 MB frames: hashed one by one they would cost 10^11 steps.
        val header = falseHeader(1_500_000)
        var stream = ByteArray(0)
        repeat(7) { stream = if (stream.isEmpty()) header else stream + stream }
        val nested = ByteArray(1_600_000) { stream[it % stream.size] }
        val (packets, counters) = deframed(nested, 65_536)
        assertEquals(emptyList(), packets)
        assertTrue(counters.badHash > 10_000)
    }

    private fun falseHeader(size: Int): ByteArray {
        val frame = encode(CompressedImage(1f, Bytes.EMPTY)).copyOf(HEADER_BYTES)
        return FieldWriter().apply { bytes(Bytes.copyOf(frame)); patchI32(2, size) }.toByteArray()
    }
}
