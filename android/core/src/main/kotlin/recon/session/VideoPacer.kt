package recon.session

/** Chooses the frames to send: the feed has 30 a second, the station asks for a few. */
class VideoPacer(private val settings: SessionSettings) {
    private var cadence: Cadence? = null

    /** Frames a second that are sent; 0 while the feed is off. */
    var targetFpsHz = 0f
        private set

    val isOn: Boolean get() = cadence != null

    /** Starts at the rate asked for, at most the setting's. */
    fun start(fpsHz: Float, nowNs: Long) {
        targetFpsHz = fpsHz.coerceAtMost(settings.fastestVideoHz.toFloat())
        cadence = Cadence((1e9 / targetFpsHz).toLong()).also { it.startAt(nowNs) }
    }

    fun stop() {
        cadence = null
        targetFpsHz = 0f
    }

    /** Whether the frame taken now is to be sent. */
    fun takes(nowNs: Long): Boolean = cadence?.isDue(nowNs) ?: false
}
