package recon.wire

import com.google.gson.JsonArray
import com.google.gson.JsonObject
import org.junit.jupiter.api.DynamicTest
import org.junit.jupiter.api.TestFactory
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertFailsWith
import kotlin.test.assertTrue

/** The golden packets of `vectors/`, in both directions, and its damaged streams. */
class VectorsTest {

    @Test
    fun `every packet of the interface has vectors`() {
        val vectors = vectorFolders().flatMap(::vectorsOf)
        assertEquals(setOf(0, 1, 2, 3, 4, 5, 252, 253, 254, 255), vectors.map { it.description["pid"].asInt }
            .filter(PacketTable::isKnown).toSet())
        assertTrue(vectorsOf("bad").size > 30)
    }

    @TestFactory
    fun `a golden packet decodes to its fields and encodes to its bytes`() =
        vectorFolders().flatMap(::vectorsOf).map { vector ->
            DynamicTest.dynamicTest(vector.name) {
                val packet = decode(vector.bytes)
                assertEquals(vector.description["pid"].asInt, packet.pid)
                assertEquals(sorted(vector.description["fields"].asJsonObject), sorted(described(packet)))
                assertEquals(hex(vector.bytes), hex(encode(packet)))
            }
        }

    @TestFactory
    fun `a damaged stream gives the frames and counters of its description`() =
        vectorsOf("bad").map { vector ->
            DynamicTest.dynamicTest(vector.name) {
                assertDecodeError(vector)
                for (piece in listOf(1, 7, 1_000, Int.MAX_VALUE)) assertDeframed(vector, piece)
            }
        }

    private fun assertDecodeError(vector: Vector) {
        val kind = vector.description["decode"].takeIf { !it.isJsonNull }?.asString ?: return
        val error = assertFailsWith<WireError> { decode(vector.bytes) }
        assertEquals(kind, error::class.simpleName!!.lowercase(), error.message)
    }

    private fun assertDeframed(vector: Vector, piece: Int) {
        val (packets, counters) = deframed(vector.bytes, piece)
        val frames = JsonArray().apply { packets.forEach { add(hex(encode(it))) } }
        assertEquals(vector.description["frames"], frames, "in pieces of $piece")
        val shown = mapOf(
            "bad_hash" to counters.badHash,
            "bad_size" to counters.badSize,
            "abandoned" to counters.abandoned,
            "unknown_pid" to counters.unknownPid,
            "bytes_skipped" to counters.bytesSkipped,
        )
        for ((name, expected) in vector.description["counters"].asJsonObject.entrySet()) {
            assertEquals(expected.asLong, shown[name], "$name in pieces of $piece")
        }
    }

    private fun sorted(fields: JsonObject): Map<String, Any> = fields.entrySet().associate { (name, value) ->
        name to if (value.isJsonArray) value.asJsonArray.map { sorted(it.asJsonObject) } else value
    }
}
