package recon.session

import recon.aircraft.AircraftState
import recon.aircraft.ReleasedPhoto

/**
 * What the app tells by the extension `recon 1`, and when (docs/icd.md, "Facts, photos and outcomes").
 *
 * Theory of operation. Each kind is sent at most once a second, over an open link with an aircraft that has
 * told its serial. *Facts* are compared each second, and sent when they have changed and after 10 s.
 * *Photos* get their index as they come, with or without a link, and wait, at most 256; when a link ends,
 * those of its last 10 s wait again, because nothing tells whether they arrived. *Outcomes* wait, at most 64.
 */
internal class Extension(private val appName: String, startedS: Long) {
    private val facts = Cadence(PERIOD_NS)
    private var series = PhotoSeries(startedS, 0, serial = null)
    private val waiting = ArrayDeque<NumberedPhoto>()
    private val sent = ArrayDeque<Pair<Long, NumberedPhoto>>()
    private val outcomes = ArrayDeque<Outcome>()
    private var lastFacts = ""
    private var factsSentNs = 0L
    private var photosFromNs = 0L
    private var outcomesFromNs = 0L
    private var isOpen = false

    val dueNs: Long
        get() = if (!isOpen) Long.MAX_VALUE else minOf(
            facts.dueNs,
            if (waiting.isEmpty()) Long.MAX_VALUE else photosFromNs,
            if (outcomes.isEmpty()) Long.MAX_VALUE else outcomesFromNs,
        )

    fun open(nowNs: Long) {
        isOpen = true
        lastFacts = ""
        facts.startAt(nowNs)
        photosFromNs = nowNs
        outcomesFromNs = nowNs
    }

    fun close(nowNs: Long) {
        isOpen = false
        facts.stop()
        val again = sent.filter { (sentNs, _) -> nowNs - sentNs <= SENT_AGAIN_NS }.map { it.second }
        sent.clear()
        again.asReversed().forEach(waiting::addFirst)
        while (waiting.size > MOST_PHOTOS) waiting.removeFirst()
    }

    /** The aircraft has told its serial: its facts come first. */
    fun identified(nowNs: Long) {
        if (isOpen) facts.startAt(nowNs)
    }

    fun photoTaken(photo: ReleasedPhoto) {
        // Another aircraft, another count: its first photo is no gap in the photos of the one before.
        val isOther = series.serial != null && photo.serial != null && photo.serial != series.serial
        if (isOther) series = PhotoSeries(series.number + 1, 0, photo.serial)
        series = series.copy(count = series.count + 1, serial = photo.serial ?: series.serial)
        waiting.addLast(NumberedPhoto(series.number, series.count, photo))
        if (waiting.size > MOST_PHOTOS) waiting.removeFirst()
    }

    /** Takes how an action ended; one like the last that waits is that one. */
    fun ended(outcome: Outcome) {
        if (outcome == outcomes.lastOrNull()) return
        outcomes.addLast(outcome)
        if (outcomes.size > MOST_OUTCOMES) outcomes.removeFirst()
    }

    /** The texts that are due by [nowNs]; [state] null: no aircraft, or none that reports. */
    fun due(state: AircraftState?, nowNs: Long): List<String> {
        if (!isOpen) return emptyList()
        val known = state?.takeIf { it.serial != null }
        val told = mutableListOf<String>()
        if (facts.isDue(nowNs) && known != null) facts(known, nowNs)?.let(told::add)
        // Without an aircraft they wait on; the next look is a period later.
        if (waiting.isNotEmpty() && nowNs >= photosFromNs) {
            photosFromNs = nowNs + PERIOD_NS
            if (known != null) photos(known.serial, nowNs)?.let(told::add)
        }
        if (outcomes.isNotEmpty() && nowNs >= outcomesFromNs) {
            outcomesFromNs = nowNs + PERIOD_NS
            if (known != null) told.add(outcomeText(outcomes.removeFirst()))
        }
        return told
    }

    private fun facts(state: AircraftState, nowNs: Long): String? {
        val text = factsText(state, appName, series)
        if (text == lastFacts && nowNs - factsSentNs < REPEAT_NS) return null
        lastFacts = text
        factsSentNs = nowNs
        return text
    }

    private fun photos(serialOfLink: String?, nowNs: Long): String? {
        waiting.removeAll { ageS(it.photo.takenNs, nowNs) > OLDEST_S }
        val first = waiting.firstOrNull() ?: return null
        val batch = waiting.takeWhile { it.series == first.series && it.photo.serial == first.photo.serial }
        val serial = first.photo.serial.takeIf { it != serialOfLink }
        var size = minOf(batch.size, MOST_PHOTOS_OF_TEXT)
        var text = photosText(batch.take(size), serial, nowNs)
        while (size > 1 && text.encodeToByteArray().size > LONGEST_APP_TEXT_BYTES) {
            text = photosText(batch.take(--size), serial, nowNs)
        }
        repeat(size) { sent.addLast(nowNs to waiting.removeFirst()) }
        while (sent.size > MOST_PHOTOS) sent.removeFirst()
        return text
    }

    private companion object {
        const val PERIOD_NS = 1_000_000_000L
        const val REPEAT_NS = 10_000_000_000L
        const val SENT_AGAIN_NS = 10_000_000_000L
        const val OLDEST_S = 3_600.0
        const val MOST_PHOTOS = 256
        const val MOST_OUTCOMES = 64
    }
}
