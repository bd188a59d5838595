package recon.link

/**
 * Waits between attempts to connect: 0.2 s, doubled up to 1 s.
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
        const val FIRST_NS = 200_000_000L
        const val LONGEST_NS = 1_000_000_000L
        const val STEADY_NS = 2_000_000_000L
    }
}
