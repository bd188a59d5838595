package recon.companion

import com.sun.net.httpserver.HttpServer
import java.net.InetAddress
import java.net.InetSocketAddress
import kotlin.test.AfterTest
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertTrue

class SiteOfStationTest {
    private val server = HttpServer.create(InetSocketAddress(InetAddress.getLoopbackAddress(), 0), 0)
    private val console = "http://127.0.0.1:${server.address.port}"
    private var body = ""
    private var status = 200

    init {
        server.createContext("/api/state") { exchange ->
            val bytes = body.encodeToByteArray()
            exchange.sendResponseHeaders(status, bytes.size.toLong())
            exchange.responseBody.use { it.write(bytes) }
        }
        server.start()
    }

    @AfterTest
    fun stop() = server.stop(0)

    @Test
    fun `the first pad is at the origin of the station's site`() {
        body = """{"links":[],"site":{"name":"a \"b\"","latitude_deg":48.5,"longitude_deg":-1.25,"ground_altitude_m":90.0}}"""
        assertEquals(Home(48.5, -1.25, 90.0, "the origin of the station's site, by $console"), homeOfStation(console))
    }

    @Test
    fun `without a site, or an answer, it is the demonstration's field, and why is said`() {
        for ((answer, code, reason) in listOf(
            Triple("""{"site":{"name":"a","latitude_deg":null,"longitude_deg":null}}""", 200, "no site with an origin"),
            Triple("not JSON", 200, "no site with an origin"),
            Triple("", 401, "answered 401"),
        )) {
            body = answer
            status = code
            val home = homeOfStation(console)
            assertEquals(41.9012, home.latitudeDeg)
            assertTrue(reason in home.origin && "--home" in home.origin, home.origin)
        }
        assertTrue("does not answer" in homeOfStation("http://127.0.0.1:1").origin)
        assertTrue("no address" in homeOfStation("not an address").origin)
    }
}
