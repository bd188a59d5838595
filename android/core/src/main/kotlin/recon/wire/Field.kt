package recon.wire

import java.nio.Buffer
import java.nio.ByteBuffer

/**
 * Reads the fields of a payload in order; most significant byte first (docs/icd.md, "Types").
 *
 * Floats keep their bits, those of a NaN too. Raises [WireError.Short] beyond the end.
 */
class FieldReader(bytes: ByteArray, from: Int = 0, to: Int = bytes.size) {
    private val buffer: ByteBuffer = ByteBuffer.wrap(bytes, from, to - from)

    /** Bytes not yet read. */
    val remaining: Int get() = buffer.remaining()

    fun u8(): Int = wanted(1).get().toInt() and 0xFF

    fun u16(): Int = wanted(2).short.toInt() and 0xFFFF

    fun u24(): Int = (wanted(3).get().toInt() and 0xFF shl 16) or u16()

    fun u32(): Long = wanted(4).int.toLong() and 0xFFFF_FFFF

    fun u64(): ULong = wanted(8).long.toULong()

    fun i8(): Int = wanted(1).get().toInt()

    fun i16(): Int = wanted(2).short.toInt()

    fun i24(): Int = u24() shl 8 shr 8

    fun i32(): Int = wanted(4).int

    fun i64(): Long = wanted(8).long

    fun f32(): Float = wanted(4).float

    fun f64(): Double = wanted(8).double

    /** A count of bytes (u32) and as many bytes of UTF-8, kept as they are. */
    fun string(): Bytes {
        val count = u32()
        if (count > remaining) throw WireError.Short("The string", clipped(count), remaining)
        return bytes(count.toInt())
    }

    fun bytes(count: Int): Bytes {
        val array = ByteArray(count)
        wanted(count).get(array)
        return Bytes.copyOf(array)
    }

    fun skip(count: Int) {
        advance(wanted(count), count)
    }

    private fun wanted(count: Int): ByteBuffer {
        if (buffer.remaining() < count) throw WireError.Short("The field", count, buffer.remaining())
        return buffer
    }
}

private fun clipped(count: Long): Int = count.coerceAtMost(Int.MAX_VALUE.toLong()).toInt()

/** Writes the fields of a payload in order. Raises [WireError.OutOfRange] for a value that does not fit. */
class FieldWriter {
    private var buffer: ByteBuffer = ByteBuffer.allocate(128)

    fun u8(field: String, value: Int) = integer(field, value.toLong(), 0, 0xFF, 1)

    fun u16(field: String, value: Int) = integer(field, value.toLong(), 0, 0xFFFF, 2)

    fun u24(field: String, value: Int) = integer(field, value.toLong(), 0, 0xFF_FFFF, 3)

    fun u32(field: String, value: Long) = integer(field, value, 0, 0xFFFF_FFFF, 4)

    fun u64(value: ULong) = i64(value.toLong())

    fun i8(field: String, value: Int) = integer(field, value.toLong(), -0x80, 0x7F, 1)

    fun i16(field: String, value: Int) = integer(field, value.toLong(), -0x8000, 0x7FFF, 2)

    fun i24(field: String, value: Int) = integer(field, value.toLong(), -0x80_0000, 0x7F_FFFF, 3)

    fun i32(value: Int) {
        room(4).putInt(value)
    }

    fun i64(value: Long) {
        room(8).putLong(value)
    }

    fun f32(value: Float) {
        room(4).putFloat(value)
    }

    fun f64(value: Double) {
        room(8).putDouble(value)
    }

    fun string(value: Bytes) {
        i32(value.size)
        bytes(value)
    }

    fun bytes(value: Bytes) {
        room(value.size)
        value.copyTo(buffer.array(), buffer.position())
        advance(buffer, value.size)
    }

    fun toByteArray(): ByteArray = buffer.array().copyOf(buffer.position())

    /** Replaces four bytes written before: the size, known only at the end. */
    internal fun patchI32(at: Int, value: Int) {
        buffer.putInt(at, value)
    }

    internal val size: Int get() = buffer.position()

    private fun integer(field: String, value: Long, least: Long, most: Long, bytes: Int) {
        if (value !in least..most) throw WireError.OutOfRange(field, "$least to $most", value)
        val target = room(bytes)
        for (shift in (bytes - 1) * 8 downTo 0 step 8) target.put((value shr shift).toByte())
    }

    private fun room(count: Int): ByteBuffer {
        if (buffer.remaining() < count) {
            val capacity = maxOf(2 * buffer.capacity(), buffer.position() + count)
            buffer = ByteBuffer.allocate(capacity).put(buffer.array(), 0, buffer.position())
        }
        return buffer
    }
}

/** As a [Buffer]: Android 8 and 9 lack the same function of [ByteBuffer], to which the compiler would refer. */
private fun advance(buffer: Buffer, count: Int) {
    buffer.position(buffer.position() + count)
}
