package recon.app

import android.net.ConnectivityManager
import android.net.IpPrefix
import android.net.LinkProperties
import android.net.Network
import android.net.RouteInfo
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.RobolectricTestRunner
import org.robolectric.RuntimeEnvironment
import org.robolectric.Shadows.shadowOf
import org.robolectric.shadows.ShadowNetwork
import recon.link.StationAddress
import java.net.InetAddress
import java.net.Socket
import kotlin.test.assertEquals
import kotlin.test.assertFalse
import kotlin.test.assertTrue

@RunWith(RobolectricTestRunner::class)
class LocalNetworkTest {
    private val connectivity = RuntimeEnvironment.getApplication().getSystemService(ConnectivityManager::class.java)
    private val network = LocalNetwork(connectivity)
    private val wifi: Network = ShadowNetwork.newInstance(7)

    @Test
    fun `only addresses in the Wi-Fi's own subnet are on its link`() {
        val properties = subnet()
        assertTrue(LocalNetwork.isOnLink(properties, InetAddress.getByName("192.168.8.20")))
        assertFalse(LocalNetwork.isOnLink(properties, InetAddress.getByName("192.168.9.20")))
        assertFalse(LocalNetwork.isOnLink(properties, InetAddress.getByName("127.0.0.1")))
    }

    @Test
    fun `a socket to the station is bound to the Wi-Fi while there is one`() {
        assertEquals(0, bound("192.168.8.20"))
        callback().onLinkPropertiesChanged(wifi, subnet())
        assertEquals(1, bound("192.168.8.20"))
        assertEquals(0, bound("10.0.0.5"))
        assertEquals(0, bound("laptop.local"))
        callback().onLost(wifi)
        assertEquals(0, bound("192.168.8.20"))
    }

    private fun callback() = shadowOf(connectivity).networkCallbacks.single()

    private fun bound(host: String): Int {
        Socket().use { socket ->
            network.tune(StationAddress(host, 3001), socket)
            return if (shadowOf(wifi).isSocketBound(socket)) 1 else 0
        }
    }

    private fun subnet() = LinkProperties().apply {
        interfaceName = "wlan0"
        val gateway = InetAddress.getByName("192.168.8.1")
        addRoute(RouteInfo(IpPrefix(InetAddress.getByName("192.168.8.0"), 24), null, "wlan0", RouteInfo.RTN_UNICAST))
        addRoute(RouteInfo(IpPrefix(InetAddress.getByName("0.0.0.0"), 0), gateway, "wlan0", RouteInfo.RTN_UNICAST))
    }
}
