package recon.link

import recon.errors.ReconError

/** An address that cannot be used; the message shows the form that can. */
class AddressError(message: String) : ReconError(message)

/** Where the station listens for companion apps. */
data class StationAddress(val host: String, val port: Int) {

    override fun toString(): String = if (':' in host) "[$host]:$port" else "$host:$port"

    companion object {
        const val DEFAULT_PORT = 3001
        private const val SCHEME = "recon://"
        private val BRACKETED = Regex("""\[([0-9a-fA-F:.]+(?:%\w+)?)](?::(\d+))?""")
        private val PLAIN = Regex("""([A-Za-z0-9](?:[A-Za-z0-9._-]*[A-Za-z0-9])?)(?::(\d+))?""")

        /**
         * Parses `HOST`, `HOST:PORT`, `[IPv6]:PORT`, each also as `recon://...` from a QR code.
         * Raises [AddressError].
         */
        fun parse(text: String): StationAddress {
            val address = text.trim().removePrefix(SCHEME).removeSuffix("/")
            val match = BRACKETED.matchEntire(address) ?: PLAIN.matchEntire(address) ?: throw wrong(text)
            val digits = match.groups[2]?.value ?: return StationAddress(match.groupValues[1], DEFAULT_PORT)
            val port = digits.toIntOrNull()?.takeIf { it in 1..0xFFFF } ?: throw wrong(text)
            return StationAddress(match.groupValues[1], port)
        }

        private fun wrong(text: String) = AddressError(
            "Station address must be HOST or HOST:PORT with a port of 1 to 65535; got '${text.take(100)}'",
        )
    }
}
