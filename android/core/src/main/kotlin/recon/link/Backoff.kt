package recon.link

/**
 * Waits between attempts to connect: 0.1 s, doubled up to 0.8 s. With a station in reach the app is so
 * connected again within a second, however often its links have ended.
 *
 * A link that the station closes at once does not count as a success: the waits go on growing.
 */
class Backoff {
    private var nextNs = FIRST_NS

    /** Nanoseconds to wait before the next attempt, after a link that was open for [openNs]. */
    fun nextWaitNs(openNs: Long): Long {
        if (openNs >= STEADY_NS) nextNs = FIRST_NS
        return nextNs.also { nextNs = minOf(2 * it, LONGEST_NS) }
    }

    private companion object {
        const val FIRST_NS = 100_000_000L
        const val LONGEST_NS = 800_000_000L
        const val STEADY_NS = 2_000_000_000L
    }
}
