package recon.link

import net.jqwik.api.ForAll
import net.jqwik.api.Property
import net.jqwik.api.constraints.IntRange
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertFailsWith
import kotlin.test.assertTrue

class StationAddressTest {

    @Test
    fun `hosts, ports, IPv6 and the text of a QR code are understood`() {
        assertEquals(StationAddress("laptop.local", 3001), StationAddress.parse(" laptop.local "))
        assertEquals(StationAddress("192.168.8.20", 3005), StationAddress.parse("recon://192.168.8.20:3005/"))
        assertEquals(StationAddress("fe80::1%wlan0", 3001), StationAddress.parse("[fe80::1%wlan0]"))
        assertEquals("[::1]:80", StationAddress.parse("[::1]:80").toString())
    }

    @Property
    fun `an address shown is understood again`(@ForAll @IntRange(min = 1, max = 65_535) port: Int) {
        for (host in listOf("a", "drone-base.lan", "10.0.0.1", "2001:db8::7")) {
            val address = StationAddress(host, port)
            assertEquals(address, StationAddress.parse(address.toString()))
        }
    }

    @Property
    fun `any other text is refused with a sentence`(@ForAll text: String) {
        try {
            val address = StationAddress.parse(text)
            assertEquals(address, StationAddress.parse(address.toString()))
        } catch (error: AddressError) {
            assertTrue(error.message.startsWith("Station address must be HOST or HOST:PORT"))
        }
    }

    @Test
    fun `ports out of range and empty texts are refused`() {
        val wrong = listOf("", "host:0", "host:65536", "host:", "::1", "a b", "http://host", "-host", "host:9999999999")
        for (text in wrong) {
            assertFailsWith<AddressError>(text) { StationAddress.parse(text) }
        }
    }

    @Test
    fun `waits stay below a second and begin anew after a link that lasted`() {
        val backoff = Backoff()
        val waits = List(5) { backoff.nextWaitNs(openNs = 0) / 1_000_000 }
        assertEquals(listOf(100L, 200L, 400L, 800L, 800L), waits)
        assertEquals(800_000_000L, backoff.nextWaitNs(openNs = 100_000_000))
        assertEquals(100_000_000L, backoff.nextWaitNs(openNs = 2_000_000_000))
    }
}
