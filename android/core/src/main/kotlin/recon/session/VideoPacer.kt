package recon.session

/**
 * Chooses the frames to send and how well they are encoded: the feed has 30 a second, the station asks
 * for a few, and the link carries what it carries.
 *
 * Measured is how long an image takes to be written. One that takes most of the time between two images
 * is more than the link carries: images come less often, by half as much again each time, down to the
 * settings' slowest rate, and then with less quality. While they are written quickly, quality comes back
 * first, and then the rate.
 */
class VideoPacer(private val settings: SessionSettings) {
    private var askedNs = 0L
    private var periodNs = 0L
    private var dueNs = Long.MAX_VALUE
    private var qualityStep = 0

    /** Frames a second that the station asks for, and the setting allows; 0 while the feed is off. */
    var targetFpsHz = 0f
        private set

    val isOn: Boolean get() = targetFpsHz > 0f

    /** Of a JPEG file, in percent. */
    val quality: Int get() = QUALITIES[qualityStep]

    /** Starts at the rate asked for, at most the setting's. */
    fun start(fpsHz: Float, nowNs: Long) {
        targetFpsHz = fpsHz.coerceAtMost(settings.fastestVideoHz.toFloat())
        askedNs = (1e9 / targetFpsHz).toLong()
        periodNs = askedNs
        dueNs = nowNs
    }

    fun stop() {
        targetFpsHz = 0f
        dueNs = Long.MAX_VALUE
    }

    /** Whether the frame taken now is to be sent. */
    fun takes(nowNs: Long): Boolean {
        if (nowNs < dueNs) return false
        dueNs += periodNs * (1 + (nowNs - dueNs) / periodNs)
        return true
    }

    /** Takes how long the last image took to be written. */
    fun written(tookNs: Long) {
        if (!isOn) return
        val slowestNs = maxOf(askedNs, (1e9 / settings.slowestVideoHz).toLong())
        when {
            tookNs > periodNs * TOO_LONG && periodNs < slowestNs -> periodNs = minOf(periodNs * 3 / 2, slowestNs)
            tookNs > periodNs * TOO_LONG -> qualityStep = minOf(qualityStep + 1, QUALITIES.lastIndex)
            tookNs > periodNs * QUICK -> Unit
            qualityStep > 0 -> qualityStep--
            else -> periodNs = maxOf(periodNs * 9 / 10, askedNs)
        }
    }

    private companion object {
        val QUALITIES = listOf(85, 65, 45, 25)

        /** Share of the period from which on a write is too long: telemetry and answers need room between. */
        const val TOO_LONG = 0.6
        const val QUICK = 0.3
    }
}
