package recon.session

import recon.aircraft.AircraftCommand

/** A command that the aircraft has not answered. */
class Call(
    val id: Long,
    val command: AircraftCommand,
    val what: String,
    sourcePid: Int?,
    val issuedNs: Long,
) {
    /** PID to acknowledge; null for the session's own commands, and those of a link that has ended. */
    var sourcePid = sourcePid
        internal set

    /** A newer order to move came before the answer: an acceptance is undone. */
    var isSuperseded = false

    /** The operator has been shown that the answer takes long. */
    var isAnnounced = false
}

/** The unanswered calls, oldest first. */
class Calls(private val settings: SessionSettings) {
    private val open = LinkedHashMap<Long, Call>()
    private val givenUp = LinkedHashSet<Long>()
    private var count = 0L

    /** Whether a mission waits for its answer: a second one is refused until then. */
    val hasMission: Boolean get() = open.values.any { it.command is AircraftCommand.FlyMission && !it.isSuperseded }

    val isFull: Boolean get() = open.size >= MOST_OPEN

    val dueNs: Long get() = open.values.minOfOrNull(::dueOf) ?: Long.MAX_VALUE

    fun begin(command: AircraftCommand, what: String, sourcePid: Int?, nowNs: Long): Call {
        val call = Call(++count, command, what, sourcePid, nowNs)
        open[call.id] = call
        return call
    }

    /** The call that this answer ends; null for one that has ended already. */
    fun end(id: Long): Call? = open.remove(id)

    /** Whether this answer comes for a mission whose operator was told that there is none; asked once. */
    fun wasGivenUp(id: Long): Boolean = givenUp.remove(id)

    /** The link of these calls has ended: on the next one an acknowledgment would answer another command. */
    fun forgetSources() {
        open.values.forEach { it.sourcePid = null }
    }

    /** Undoes missions that are accepted after a newer order to move. */
    fun supersedeMissions() {
        open.values.filter { it.command is AircraftCommand.FlyMission }.forEach { it.isSuperseded = true }
    }

    /** Calls that take long, each once. */
    fun slow(nowNs: Long): List<Call> =
        open.values.filter { !it.isAnnounced && nowNs - it.issuedNs >= settings.slowAnswerNs }
            .onEach { it.isAnnounced = true }

    /** Calls without an answer for too long; they are forgotten, but for missions that may still be accepted. */
    fun expired(nowNs: Long): List<Call> =
        open.values.filter { nowNs - it.issuedNs >= settings.answerTimeoutNs }.onEach(::giveUp)

    private fun giveUp(call: Call) {
        open.remove(call.id)
        if (call.command is AircraftCommand.FlyMission) givenUp.add(call.id)
        while (givenUp.size > MOST_OPEN) givenUp.remove(givenUp.first())
    }

    private fun dueOf(call: Call): Long =
        call.issuedNs + if (call.isAnnounced) settings.answerTimeoutNs else settings.slowAnswerNs

    private companion object {
        const val MOST_OPEN = 64
    }
}
