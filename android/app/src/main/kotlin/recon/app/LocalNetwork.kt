package recon.app

import android.net.ConnectivityManager
import android.net.InetAddresses
import android.net.LinkProperties
import android.net.Network
import android.net.NetworkCapabilities
import android.net.NetworkRequest
import android.os.Build
import recon.link.StationAddress
import java.net.InetAddress
import java.net.Socket

/**
 * Leads connections to the Wi-Fi that the station is in. A field's Wi-Fi has no internet, and Android
 * then sends everything over the mobile network unless a socket is bound.
 */
class LocalNetwork(connectivity: ConnectivityManager) {
    @Volatile
    private var wifi: Pair<Network, LinkProperties>? = null

    init {
        val request = NetworkRequest.Builder()
            .addTransportType(NetworkCapabilities.TRANSPORT_WIFI)
            .removeCapability(NetworkCapabilities.NET_CAPABILITY_INTERNET)
            .build()
        connectivity.registerNetworkCallback(request, Changes())
    }

    /** Binds a socket that is not connected yet, if the station is in the Wi-Fi's own subnet. */
    fun tune(station: StationAddress, socket: Socket) {
        val (network, properties) = wifi ?: return
        val address = numeric(station.host) ?: return
        if (isOnLink(properties, address)) network.bindSocket(socket)
    }

    private inner class Changes : ConnectivityManager.NetworkCallback() {
        override fun onLinkPropertiesChanged(network: Network, properties: LinkProperties) {
            wifi = network to properties
        }

        override fun onLost(network: Network) {
            if (wifi?.first == network) wifi = null
        }
    }

    companion object {
        /** Whether an address is reached without a gateway. */
        fun isOnLink(properties: LinkProperties, address: InetAddress): Boolean =
            properties.routes.any { !it.isDefaultRoute && it.matches(address) }

        /** An address in digits; names are left to Android. */
        @NewerAndroid
        private fun numeric(host: String): InetAddress? = when {
            Build.VERSION.SDK_INT < Build.VERSION_CODES.Q -> DIGITS.find(host)?.let { InetAddress.getByName(host) }
            InetAddresses.isNumericAddress(host) -> InetAddresses.parseNumericAddress(host)
            else -> null
        }

        private val DIGITS = Regex("""^\d+\.\d+\.\d+\.\d+$""")
    }
}
