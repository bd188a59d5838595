package recon.msdk5

import recon.aircraft.AircraftModel
import recon.aircraft.MissionPlan
import recon.aircraft.ModelFunction
import recon.aircraft.aircraftModelOf
import recon.mission.KmzError
import recon.mission.WpmlOptions
import recon.mission.kmzOf
import recon.mission.planOfKmz
import recon.mission.planProblem

/** The model that is connected; null while DJI does not tell it. */
internal val DjiSnapshot.model: AircraftModel? get() = aircraftModelOf(product, camera)

/**
 * The file of a mission for the aircraft that is connected, and sentences for the operator about it.
 *
 * A mission that looks straight down from its first waypoint is one of a survey. It takes the photos itself, at
 * the interval that the camera's timer is set to, where the model can and the camera is not in timer mode.
 */
internal class MissionFile(
    private val plan: MissionPlan, private val aircraft: DjiSnapshot?, camera: DjiReadings, createdMs: Long,
) {
    private val model = aircraft?.model
    private val drone = model?.numberWith(aircraft?.camera)
    private val isSurvey = plan.photoEveryS != null || plan.points.firstOrNull()?.gimbalPitchDeg in STRAIGHT_DOWN
    private val canTakePhotos = model?.has(ModelFunction.PHOTO_TIMER) == true && drone?.camera != null
    private val everyS = (plan.photoEveryS ?: camera.photoIntervalS?.takeIf { it > 0.0 && camera.cameraMode == SINGLE })
        .takeIf { isSurvey && canTakePhotos }

    val kmz: ByteArray by lazy {
        val options = WpmlOptions(createdMs, drone, aircraft?.goHomeHeightM?.toDouble())
        kmzOf(plan.copy(photoEveryS = everyS), options)
    }

    /** Why this file must not reach an aircraft, or null; one that cannot be read back must not. */
    fun problem(): String? = planProblem(plan) ?: try {
        planProblem(planOfKmz(kmz))
    } catch (error: KmzError) {
        error.message
    }

    /** What the operator should know about a file that was accepted. */
    fun note(check: FileCheck): String = listOfNotNull(namedAircraft(), photos(), checked(check)).joinToString("; ")

    private fun namedAircraft(): String =
        if (drone != null) "its file is for a ${model?.name}"
        else "its file names no aircraft: DJI does not tell the model (${aircraft?.product}, ${aircraft?.camera})"

    private fun photos(): String? = when {
        !isSurvey -> null
        everyS != null -> "it takes a photo every $everyS s from its first waypoint to its last: leave the timer off"
        else -> "it takes no photos: start the camera's timer"
    }

    private fun checked(check: FileCheck): String = when (check) {
        is FileCheck.Passed -> "DJI's check found no fault"
        is FileCheck.Absent -> "DJI's check was not made, because ${check.reason}"
        is FileCheck.Faulty -> "DJI's check found: ${faultWords(check.numbers)}"
    }

    private companion object {
        const val SINGLE = "PHOTO_NORMAL"
        val STRAIGHT_DOWN = -90.5..-89.5

        operator fun ClosedFloatingPointRange<Double>.contains(value: Double?) =
            value != null && value >= start && value <= endInclusive
    }
}
