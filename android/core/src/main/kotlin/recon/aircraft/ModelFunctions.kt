package recon.aircraft

/** Whether the aircraft has a function: as it answers itself, else as the table of models expects. */
fun AircraftState.has(function: ModelFunction): Capability {
    val asked = when (function) {
        ModelFunction.MISSIONS -> capabilities.waypointMissions
        ModelFunction.STICKS -> capabilities.virtualStick
        ModelFunction.CAMERA -> capabilities.camera
        ModelFunction.PHOTO_REPORTS -> capabilityOf(facts.reportsPhotos)
        ModelFunction.FILES, ModelFunction.PHOTO_TIMER -> Capability.UNKNOWN
    }
    if (asked != Capability.UNKNOWN) return asked
    return capabilityOf(AIRCRAFT_MODELS.find { it.name == facts.model }?.has(function))
}

/** What the aircraft can do, in words for a screen: "missions, sticks; no photo reports". */
fun functionWords(state: AircraftState): String {
    val (yes, no) = listOf(Capability.SUPPORTED, Capability.UNSUPPORTED).map { wanted ->
        ModelFunction.entries.filter { state.has(it) == wanted }.joinToString(", ") { it.shownName }
    }
    val words = listOf(yes, if (no.isEmpty()) "" else "no $no").filter { it.isNotEmpty() }
    return words.joinToString("; ").ifEmpty { "not known yet" }
}

/** The models in sentences for the first screen: what is expected of each, before an aircraft has answered. */
fun modelSentences(): List<String> {
    val (flown, filesOnly) = AIRCRAFT_MODELS.partition { it.has(ModelFunction.STICKS) }
    val (missions, sticksOnly) = flown.partition { it.has(ModelFunction.MISSIONS) }
    return listOf(
        "Missions and sticks: ${names(missions)}.",
        "Sticks only: ${names(sticksOnly)}.",
        "Plans as files only: ${names(filesOnly)}.",
        "Each aircraft is asked for what it can do once it is connected.",
    )
}

private fun names(models: List<AircraftModel>) = models.joinToString(", ") { it.name }

private fun capabilityOf(value: Boolean?) = when (value) {
    null -> Capability.UNKNOWN
    true -> Capability.SUPPORTED
    false -> Capability.UNSUPPORTED
}
