package recon.wire

/** Immutable bytes, compared by content: a serial, a text, pixels or a file as it came. */
class Bytes private constructor(private val array: ByteArray) {

    val size: Int get() = array.size

    operator fun get(index: Int): Byte = array[index]

    fun copyTo(target: ByteArray, at: Int) {
        array.copyInto(target, at)
    }

    fun toByteArray(): ByteArray = array.copyOf()

    override fun equals(other: Any?): Boolean = other is Bytes && array.contentEquals(other.array)

    override fun hashCode(): Int = array.contentHashCode()

    override fun toString(): String = "Bytes($size)"

    companion object {
        val EMPTY = Bytes(ByteArray(0))

        fun copyOf(array: ByteArray, from: Int = 0, to: Int = array.size): Bytes = Bytes(array.copyOfRange(from, to))

        /** The UTF-8 bytes of a text. */
        fun of(text: String): Bytes = Bytes(text.encodeToByteArray())
    }
}
