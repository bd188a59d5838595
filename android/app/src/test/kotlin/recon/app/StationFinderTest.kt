package recon.app

import android.content.Context
import android.net.nsd.INsdManager
import android.net.nsd.NsdManager
import android.net.nsd.NsdServiceInfo
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.RobolectricTestRunner
import org.robolectric.RuntimeEnvironment
import org.robolectric.annotation.Implementation
import org.robolectric.annotation.Implements
import org.robolectric.shadow.api.Shadow
import recon.link.StationAddress
import java.net.InetAddress
import kotlin.test.assertEquals
import kotlin.test.assertNotNull
import kotlin.test.assertNull

/** Android's mDNS, by the hand of a test. */
@Implements(NsdManager::class)
class FakeNsdManager {
    var search: NsdManager.DiscoveryListener? = null
    val asked = ArrayDeque<Pair<NsdServiceInfo, NsdManager.ResolveListener>>()
    var type = ""

    @Implementation
    @Suppress("TestFunctionName", "UNUSED_PARAMETER")
    fun __constructor__(context: Context?, service: INsdManager?) = Unit

    @Implementation
    @Suppress("UNUSED_PARAMETER")
    fun discoverServices(type: String, protocol: Int, listener: NsdManager.DiscoveryListener) {
        this.type = type
        search = listener
    }

    @Implementation
    @Suppress("UNUSED_PARAMETER")
    fun stopServiceDiscovery(listener: NsdManager.DiscoveryListener) {
        search = null
    }

    @Implementation
    fun resolveService(service: NsdServiceInfo, listener: NsdManager.ResolveListener) {
        asked += service to listener
    }
}

@RunWith(RobolectricTestRunner::class)
class StationFinderTest {
    private val nsd = RuntimeEnvironment.getApplication().getSystemService(NsdManager::class.java)
    private val fake: FakeNsdManager = Shadow.extract(nsd)
    private var shown = emptyList<FoundStation>()
    private val finder = StationFinder(nsd) { shown = it }

    @Test
    fun `a station that announces itself is shown with its address, until it leaves`() {
        finder.start()
        assertEquals("_recon._tcp", fake.type)
        fake.search!!.onServiceFound(service("Field laptop"))
        resolve("192.168.8.20", 3001)
        assertEquals(listOf(FoundStation("Field laptop", StationAddress("192.168.8.20", 3001))), shown)
        fake.search!!.onServiceLost(service("Field laptop"))
        assertEquals(emptyList(), shown)
        finder.stop()
        assertNull(fake.search)
    }

    @Test
    fun `addresses are asked for one at a time, and one that fails does not stop the others`() {
        finder.start()
        listOf("one", "two").forEach { fake.search!!.onServiceFound(service(it)) }
        val (service, listener) = fake.asked.removeFirst()
        assertEquals(0, fake.asked.size)
        listener.onResolveFailed(service, 0)
        resolve("192.168.8.21", 3001)
        assertEquals(listOf("two"), shown.map { it.name })
    }

    @Test
    fun `a network full of announcements does not fill the screen`() {
        finder.start()
        repeat(50) { fake.search!!.onServiceFound(service("station $it")) }
        while (fake.asked.isNotEmpty()) resolve("192.168.8.20", 3001)
        assertEquals(StationFinder.MOST_STATIONS, shown.size)
    }

    @Test
    fun `a search that could not begin is begun again`() {
        finder.start()
        fake.search!!.onStartDiscoveryFailed("_recon._tcp", 0)
        fake.search = null
        finder.start()
        assertNotNull(fake.search)
    }

    private fun service(name: String) = NsdServiceInfo().apply { serviceName = name }

    private fun resolve(host: String, port: Int) {
        val (service, listener) = fake.asked.removeFirst()
        @Suppress("DEPRECATION")
        service.host = InetAddress.getByName(host)
        service.port = port
        listener.onServiceResolved(service)
    }
}
