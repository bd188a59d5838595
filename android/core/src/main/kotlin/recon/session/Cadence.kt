package recon.session

/** A periodic due time that neither drifts with late calls nor catches up on missed ones. */
class Cadence(private val periodNs: Long) {
    var dueNs = Long.MAX_VALUE
        private set

    fun startAt(nowNs: Long) {
        dueNs = nowNs
    }

    fun stop() {
        dueNs = Long.MAX_VALUE
    }

    /** Whether it is due by [nowNs]; if so the next due time is in the future. */
    fun isDue(nowNs: Long): Boolean {
        if (nowNs < dueNs) return false
        dueNs += periodNs * (1 + (nowNs - dueNs) / periodNs)
        return true
    }
}
