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

/** The file of a mission for the aircraft that is connected, and sentences for the operator about it. */
internal class MissionFile(private val plan: MissionPlan, private val aircraft: DjiSnapshot?, createdMs: Long) {
    private val model = aircraft?.model
    private val drone = model?.numberWith(aircraft?.camera)
    private val takesPhotos = model?.has(ModelFunction.PHOTO_TIMER) == true && drone?.camera != null
    private val flown = if (takesPhotos) plan else plan.copy(photoEveryS = null)

    val kmz: ByteArray = kmzOf(flown, WpmlOptions(createdMs, drone, aircraft?.goHomeHeightM?.toDouble()))

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
        plan.photoEveryS == null -> null
        takesPhotos -> "it takes a photo every ${plan.photoEveryS} s from its first waypoint to its last"
        else -> "it takes no photos with this aircraft: start the camera's timer at ${plan.photoEveryS} s"
    }

    private fun checked(check: FileCheck): String = when (check) {
        is FileCheck.Passed -> "DJI's check found no fault"
        is FileCheck.Absent -> "DJI's check was not made, because ${check.reason}"
        is FileCheck.Faulty -> "DJI's check found: ${faultWords(check.numbers)}"
    }
}
