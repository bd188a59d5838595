package recon.aircraft

/** A camera by DJI's number; [lens] is what it stores a photo of, as WPML names it ("visable" is DJI's word). */
data class CameraNumber(val enumValue: Int, val lens: String)

/** DJI's numbers of an aircraft and its camera in mission files; no camera: not known which, or none is published. */
data class DroneNumber(val enumValue: Int, val subEnumValue: Int, val camera: CameraNumber? = null)

/** What can be done with an aircraft, as DJI's documents and public threads tell. */
enum class ModelFunction(val shownName: String) {
    MISSIONS("missions"),
    STICKS("sticks"),
    FILES("plans as files"),
    CAMERA("camera control"),
    PHOTO_TIMER("photos by the mission"),
    PHOTO_REPORTS("photo reports"),
}

/**
 * An aircraft of DJI. [product] and [camera] are the names of DJI's `ProductType` and `CameraType`: no product,
 * DJI's SDK does not fly it; no camera, the product has one kind, or takes payloads.
 */
data class AircraftModel(
    val name: String,
    val product: String?,
    val camera: String?,
    val number: DroneNumber?,
    val functions: Set<ModelFunction>,
    val takesPayloads: Boolean = false,
) {
    fun has(function: ModelFunction): Boolean = function in functions

    /** The numbers for a mission file with the camera that is connected, by the name of its `CameraType`. */
    fun numberWith(connected: String?): DroneNumber? =
        if (takesPayloads) number?.copy(camera = PAYLOADS[connected?.removePrefix("ZENMUSE_")]) else number
}

private val ENTERPRISE = ModelFunction.entries.toSet()
private val MINI_4 = ENTERPRISE - ModelFunction.PHOTO_TIMER
private val MINI_3 = MINI_4 - ModelFunction.MISSIONS - ModelFunction.FILES
private val FILES_ONLY = setOf(ModelFunction.FILES, ModelFunction.PHOTO_TIMER)

private const val MAVIC_3E = "DJI_MAVIC_3_ENTERPRISE_SERIES"
private const val MATRICE_4 = "DJI_MATRICE_4_SERIES"
private const val MATRICE_4D = "DJI_MATRICE_4D_SERIES"

/**
 * The models, with what is documented of each. An aircraft that is connected is asked first: this table
 * tells its numbers, and what to expect before it has answered. The station has the same numbers for plans
 * that other apps fly; `vectors/wpml/aircraft.json` holds what both must agree on.
 */
val AIRCRAFT_MODELS: List<AircraftModel> = listOf(
    AircraftModel("Mini 3", "DJI_MINI_3", null, null, MINI_3),
    AircraftModel("Mini 3 Pro", "DJI_MINI_3_PRO", null, null, MINI_3),
    // DJI Fly's own files state this number; DJI's answer on the model's own was that any may be used.
    AircraftModel("Mini 4 Pro", "DJI_MINI_4_PRO", null, DroneNumber(68, 0), MINI_4),
    enterprise("Mavic 3E", MAVIC_3E, "M3E", DroneNumber(77, 0, CameraNumber(66, "wide"))),
    enterprise("Mavic 3T", MAVIC_3E, "M3T", DroneNumber(77, 1, CameraNumber(67, "wide"))),
    enterprise("Mavic 3M", MAVIC_3E, "M3M", DroneNumber(77, 2, CameraNumber(68, "visable"))),
    enterprise("Mavic 3TA", MAVIC_3E, "M3TA", DroneNumber(77, 3, CameraNumber(129, "wide"))),
    enterprise("Matrice 30", "M30_SERIES", "M30", DroneNumber(67, 0, CameraNumber(52, "wide"))),
    enterprise("Matrice 30T", "M30_SERIES", "M30T", DroneNumber(67, 1, CameraNumber(53, "wide"))),
    AircraftModel("Matrice 3D", null, null, DroneNumber(91, 0, CameraNumber(80, "wide")), FILES_ONLY),
    AircraftModel("Matrice 3TD", null, null, DroneNumber(91, 1, CameraNumber(81, "wide")), FILES_ONLY),
    enterprise("Matrice 4E", MATRICE_4, "M4E", DroneNumber(99, 0, CameraNumber(88, "wide"))),
    enterprise("Matrice 4T", MATRICE_4, "M4T", DroneNumber(99, 1, CameraNumber(89, "wide"))),
    enterprise("Matrice 4D", MATRICE_4D, "M4D", DroneNumber(100, 0, CameraNumber(98, "wide"))),
    enterprise("Matrice 4TD", MATRICE_4D, "M4TD", DroneNumber(100, 1, CameraNumber(99, "wide"))),
    enterprise("Matrice 300", "M300_RTK", null, DroneNumber(60, 0), takesPayloads = true),
    enterprise("Matrice 350", "M350_RTK", null, DroneNumber(89, 0), takesPayloads = true),
    enterprise("Matrice 400", "DJI_MATRICE_400", null, DroneNumber(103, 0), takesPayloads = true),
)

/** Cameras that are mounted by hand, by their names. */
val PAYLOADS: Map<String, CameraNumber> = mapOf(
    "H20" to CameraNumber(42, "wide"),
    "H20T" to CameraNumber(43, "wide"),
    "H20N" to CameraNumber(61, "wide"),
    "H30" to CameraNumber(82, "wide"),
    "H30T" to CameraNumber(83, "wide"),
)

/** The model by the names of DJI's `ProductType` and `CameraType`; null while they do not tell it. */
fun aircraftModelOf(product: String?, camera: String?): AircraftModel? {
    val series = AIRCRAFT_MODELS.filter { it.product != null && it.product == product }
    return series.singleOrNull() ?: series.singleOrNull { it.camera == camera }
}

private fun enterprise(
    name: String, product: String, camera: String?, number: DroneNumber, takesPayloads: Boolean = false,
) = AircraftModel(name, product, camera, number, ENTERPRISE, takesPayloads)
