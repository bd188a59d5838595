package recon.msdk5

import recon.aircraft.Answer
import recon.aircraft.MissionAction

/**
 * One call to DJI. [refusal] tells its failure; null goes on with the next step, because what was to be ended
 * has ended already, or the next step ends it.
 */
internal class Step(val refusal: (DjiError) -> Answer.Refused? = ::refusalOf, val start: (Done) -> Unit) {
    /** The same step, whose failure does not keep the next one from being begun. */
    fun optional() = Step({ null }, start)
}

internal fun refusalOf(error: DjiError) = Answer.Refused("$error", error.code)

internal fun refusalOf(action: MissionAction, error: DjiError): Answer.Refused {
    val step = if (action == MissionAction.START && isOfContent(error)) MissionAction.LOAD else action
    return Answer.Refused(missionFailure(step, error), error.code, step)
}

/**
 * Carries out orders as steps that follow one another by DJI's callbacks, each order answered once.
 *
 * Theory of operation. The newest order wins: steps of an older one that have not begun are dropped, and it
 * is refused. DJI's callbacks come from any thread, late, twice, or never: only the first of a step counts,
 * and no step is begun [longestNs] after its order, because by then the operator has read that it failed.
 * All is guarded by [monitor], which DJI's callbacks take in turn.
 */
internal class OrderSteps(private val monitor: Any, private val clockNs: () -> Long, private val longestNs: Long) {
    /** Number of the newest order. */
    var newest = 0
        private set

    /** Runs the steps of an order that replaces the one before; returns its number. */
    fun run(steps: List<Step>, answered: (Answer) -> Unit): Int = synchronized(monitor) {
        val order = ++newest
        next(steps, { if (order == newest) null else SUPERSEDED }, clockNs() + longestNs, answered)
        order
    }

    /** Runs steps beside the newest order, which goes on. */
    fun runBeside(steps: List<Step>, answered: (Answer) -> Unit) =
        synchronized(monitor) { next(steps, { null }, clockNs() + longestNs, answered) }

    private fun next(steps: List<Step>, obstacle: () -> String?, endsNs: Long, answered: (Answer) -> Unit) {
        if (steps.isEmpty()) return answered(Answer.Accepted)
        val reason = obstacle() ?: TOO_LATE.takeIf { clockNs() > endsNs }
        if (reason != null) return answered(Answer.Refused(reason))
        val step = steps.first()
        var isDone = false
        step.start { error ->
            synchronized(monitor) {
                if (isDone) return@synchronized
                isDone = true
                val refusal = error?.let(step.refusal)
                if (refusal != null) answered(refusal) else next(steps.drop(1), obstacle, endsNs, answered)
            }
        }
    }

    private companion object {
        const val SUPERSEDED = "a newer order came before it was carried out"
        const val TOO_LATE = "DJI's SDK took too long to answer, and the rest was not begun"
    }
}
