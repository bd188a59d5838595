package recon.app

import android.net.nsd.NsdManager
import android.net.nsd.NsdServiceInfo
import recon.link.StationAddress

/** A station that announces itself in the local network. */
data class FoundStation(val name: String, val address: StationAddress)

/**
 * Stations found by mDNS (service type `_recon._tcp`). [changed] is called on a thread of Android's with
 * all that are found. A station's addresses are asked for one station at a time: Android refuses more.
 */
class StationFinder(private val nsd: NsdManager, private val changed: (List<FoundStation>) -> Unit) {
    private val found = LinkedHashMap<String, StationAddress>()
    private val waiting = ArrayDeque<NsdServiceInfo>()
    private var isResolving = false
    private var search: Search? = null

    fun start() {
        if (search != null) return
        search = Search().also { nsd.discoverServices(SERVICE_TYPE, NsdManager.PROTOCOL_DNS_SD, it) }
    }

    fun stop() {
        search?.let(nsd::stopServiceDiscovery)
        search = null
    }

    @Synchronized
    private fun seen(service: NsdServiceInfo) {
        waiting += service
        resolveNext()
    }

    @Synchronized
    private fun lost(service: NsdServiceInfo) {
        if (found.remove(service.serviceName) != null) report()
    }

    @Synchronized
    private fun resolved(service: NsdServiceInfo?) {
        isResolving = false
        @Suppress("DEPRECATION")
        val host = service?.host?.hostAddress
        if (service != null && host != null && found.size < MOST_STATIONS) {
            found[service.serviceName] = StationAddress(host, service.port)
            report()
        }
        resolveNext()
    }

    private fun resolveNext() {
        if (isResolving) return
        val service = waiting.removeFirstOrNull() ?: return
        isResolving = true
        @Suppress("DEPRECATION")
        nsd.resolveService(service, Resolution())
    }

    private fun report() = changed(found.map { FoundStation(it.key, it.value) })

    private inner class Search : NsdManager.DiscoveryListener {
        override fun onServiceFound(service: NsdServiceInfo) = seen(service)

        override fun onServiceLost(service: NsdServiceInfo) = lost(service)

        override fun onDiscoveryStarted(type: String) = Unit

        override fun onDiscoveryStopped(type: String) = Unit

        override fun onStartDiscoveryFailed(type: String, code: Int) = Unit.also { search = null }

        override fun onStopDiscoveryFailed(type: String, code: Int) = Unit
    }

    private inner class Resolution : NsdManager.ResolveListener {
        override fun onServiceResolved(service: NsdServiceInfo) = resolved(service)

        override fun onResolveFailed(service: NsdServiceInfo, code: Int) = resolved(null)
    }

    companion object {
        const val SERVICE_TYPE = "_recon._tcp"

        /** Any host in the network can announce anything. */
        const val MOST_STATIONS = 5
    }
}
