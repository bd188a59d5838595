package recon.wire

import net.jqwik.api.ForAll
import net.jqwik.api.Property
import kotlin.random.Random
import kotlin.test.Test
import kotlin.test.assertContentEquals
import kotlin.test.assertEquals
import kotlin.test.assertFailsWith
import kotlin.test.assertNotEquals

class CodecTest {

    @Property
    fun `encoded and decoded, a packet is the same`(@ForAll seed: Int) {
        val packet = drawnPacket(Random(seed))
        val frame = encode(packet)
        assertContentEquals(frame, encode(decode(frame)))
        assertEquals(packet.pid, decode(frame).pid)
    }

    @Property
    fun `every primitive type keeps its value`(@ForAll bits: Long) {
        val out = FieldWriter()
        val small = bits.toInt()
        out.u8("a", small and 0xFF)
        out.u16("b", small and 0xFFFF)
        out.u24("c", small and 0xFF_FFFF)
        out.u32("d", bits and 0xFFFF_FFFF)
        out.u64(bits.toULong())
        out.i8("e", small.toByte().toInt())
        out.i16("f", small.toShort().toInt())
        out.i24("g", small shl 8 shr 8)
        out.i32(small)
        out.i64(bits)
        val reader = FieldReader(out.toByteArray())
        assertEquals(small and 0xFF, reader.u8())
        assertEquals(small and 0xFFFF, reader.u16())
        assertEquals(small and 0xFF_FFFF, reader.u24())
        assertEquals(bits and 0xFFFF_FFFF, reader.u32())
        assertEquals(bits.toULong(), reader.u64())
        assertEquals(small.toByte().toInt(), reader.i8())
        assertEquals(small.toShort().toInt(), reader.i16())
        assertEquals(small shl 8 shr 8, reader.i24())
        assertEquals(small, reader.i32())
        assertEquals(bits, reader.i64())
        assertEquals(0, reader.remaining)
    }

    @Test
    fun `the document's examples`() {
        assertEquals("daa70000000b0301fd8d16", hex(encode(Acknowledgment(1, 253))))
        assertEquals("daa70000000aff008a7d", hex(encode(EmergencyCommand(EmergencyCommand.HOVER))))
    }

    @Test
    fun `what the wire cannot carry is refused with field, range and value`() {
        assertMessage("positive must be 0 to 255; got 256") { encode(Acknowledgment(256, 1)) }
        assertMessage(
            "Size of packet 1 must be that of a packet with a serial of at most 256 bytes, not 300; got 325 bytes",
        ) { encode(extended(serial = "S".repeat(300))) }
        assertMessage("pixels must be 12 bytes for 2 rows of 2; got 3") { Image(1f, 2, 2, Bytes.of("abc")) }
        assertMessage(
            "Size of packet 2 must be that of a packet with an image of at most 0 x 0, not 1 x 1; got 20 bytes",
        ) { encode(Image(1f, 1, 1, Bytes.of("abc")), Limits.FROM_STATION) }
        assertMessage("Size of packet 253 must be 51 to 3971 in steps of 40; got 11 bytes") {
            encode(ExecuteWaypointMission(0, 0, emptyList()))
        }
    }

    @Test
    fun `bytes that are no frame are refused with what was expected`() {
        assertMessage("The packet needs 7 bytes; got 1") { decode(byteArrayOf(SYNC_FIRST)) }
        assertMessage("Sync must be DA A7; got 00 01") { decode(byteArrayOf(0, 1, 2)) }
        assertMessage("Hash must be 8A7D; got 8A7C") { decode(bytesOf("daa70000000aff008a7c")) }
        assertMessage("Size of packet 255 must be 10; got 11 bytes") { decode(bytesOf("daa70000000aff008a7d00")) }
        assertMessage("The packet needs 10 bytes; got 9") { decode(bytesOf("daa70000000aff008a")) }
        assertMessage("The string needs 2147483647 bytes; got 0") { FieldReader(bytesOf("ffffffff")).string() }
        assertMessage("The field needs 8 bytes; got 1") { FieldReader(byteArrayOf(0)).f64() }
    }

    @Test
    fun `bytes are compared by content`() {
        assertEquals(Bytes.of("ab"), Bytes.copyOf(byteArrayOf(0, 97, 98), from = 1))
        assertEquals(Bytes.of("ab").hashCode(), Bytes.of("ab").hashCode())
        assertNotEquals<Any>(Bytes.of("ab"), "ab")
        assertNotEquals(Bytes.of("ab"), Bytes.of("ac"))
        assertEquals("Bytes(2)", Bytes.of("ab").toString())
        assertEquals(98, Bytes.of("ab")[1])
    }

    @Test
    fun `text from outside loses what could control a screen`() {
        assertEquals("a\uFFFD[31mb\uFFFD\uFFFDc", Bytes.of("a\u001b[31mb\u202e\nc").shownText())
        assertEquals("\uFFFDok", Bytes.copyOf(byteArrayOf(-1, 'o'.code.toByte(), 'k'.code.toByte())).shownText())
        val long = shownText("x".repeat(LONGEST_SHOWN_TEXT + 1))
        assertEquals(LONGEST_SHOWN_TEXT, long.length)
        assertEquals('…', long.last())
    }

    private fun extended(serial: String) = ExtendedTelemetry(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, Bytes.of(serial))

    private fun assertMessage(expected: String, work: () -> Any) {
        assertEquals(expected, assertFailsWith<WireError> { work() }.message)
    }
}
