package recon.wire

import kotlin.random.Random
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertNotNull

/** Inputs of each fuzz test: `make fuzz-android` runs a million, the tests fewer. */
val FUZZ_INPUTS: Int = System.getProperty("fuzz.inputs", "20000").toInt()

class WireFuzzTest {

    @Test
    fun `no input raises anything but a wire error with a sentence`() {
        var damaged = 0
        var delivered = 0
        repeat(FUZZ_INPUTS) { input ->
            val random = Random(input)
            val part = drawnPart(random) + drawnPart(random)
            val (packets, counters) = deframed(part, random.nextInt(1, 500), Limits(maxJpegBytes = 5_000))
            delivered += packets.size
            try {
                decode(part)
            } catch (error: WireError) {
                damaged++
                assertNotNull(error.message.firstOrNull { it == ' ' })
            }
            assertEquals(part.size.toLong(), counters.bytesSkipped + packets.sumOf { encode(it).size.toLong() })
        }
        // Both kinds of input must be frequent, or the test shows nothing.
        assertEquals(true, damaged > FUZZ_INPUTS / 2 && delivered > FUZZ_INPUTS / 2)
    }
}
