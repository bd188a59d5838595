package recon.mission

import org.w3c.dom.Element
import recon.aircraft.MissionPlan
import recon.aircraft.PlanPoint
import recon.geo.LatLon
import java.io.ByteArrayInputStream
import java.io.ByteArrayOutputStream
import java.io.IOException
import java.util.zip.ZipEntry
import java.util.zip.ZipInputStream
import java.util.zip.ZipOutputStream

private const val TEMPLATE = "wpmz/template.kml"
private const val WAYLINES = "wpmz/waylines.wpml"
private const val LARGEST_FILE_BYTES = 4 * 1024 * 1024
private const val MOST_ENTRIES = 100
private const val BUFFER_BYTES = 16_384

/** The mission file that DJI's SDK takes: a zip archive with template and wayline. Same plan, same bytes. */
fun kmzOf(plan: MissionPlan, options: WpmlOptions): ByteArray {
    val writer = WpmlWriter(plan, options)
    val out = ByteArrayOutputStream()
    ZipOutputStream(out).use { zip ->
        for ((name, content) in listOf(TEMPLATE to writer.template(), WAYLINES to writer.waylines())) {
            zip.putNextEntry(ZipEntry(name).apply { time = options.createdMs })
            zip.write(content)
            zip.closeEntry()
        }
    }
    return out.toByteArray()
}

/**
 * The plan in a mission file's wayline: what the aircraft would fly. The adapter reads each file back
 * before it uploads it. Raises [KmzError] for anything that [kmzOf] does not write.
 */
fun planOfKmz(kmz: ByteArray): MissionPlan {
    val folder = parsedKml(waylinesOf(kmz)).only("Document")
    val config = folder.only("missionConfig")
    val wayline = folder.only("Folder")
    if (wayline.text("executeHeightMode") != WpmlWriter.HEIGHT_MODE) {
        throw KmzError("executeHeightMode must be ${WpmlWriter.HEIGHT_MODE}; got ${wayline.text("executeHeightMode")}")
    }
    val placemarks = wayline.children("Placemark")
    val modes = placemarks.map { it.only("waypointTurnParam").text("waypointTurnMode") }
    return MissionPlan(
        placemarks.map(::pointOf),
        isCurved = WpmlWriter.COORDINATED in modes,
        landsAtEnd = config.text("finishAction") == "autoLand",
        photoEveryS = placemarks.firstNotNullOfOrNull(::photoEveryS),
    )
}

private fun photoEveryS(placemark: Element): Double? = placemark.children("actionGroup")
    .map { it.only("actionTrigger") }.firstOrNull { it.text("actionTriggerType") == "multipleTiming" }
    ?.let { numberOf(it.text("actionTriggerParam")) }

private fun pointOf(placemark: Element): PlanPoint {
    val (longitude, latitude) = placemark.only("Point").text("coordinates").split(",").map(::numberOf).takeIf {
        it.size == 2
    } ?: throw KmzError("coordinates must be longitude,latitude; got ${placemark.only("Point").text("coordinates")}")
    val actions = placemark.children("actionGroup").flatMap { it.children("action") }
        .associate { it.text("actionActuatorFunc") to it.only("actionActuatorFuncParam") }
    return PlanPoint(
        LatLon(latitude, longitude),
        numberOf(placemark.text("executeHeight")),
        numberOf(placemark.text("waypointSpeed")),
        numberOf(placemark.only("waypointTurnParam").text("waypointTurnDampingDist")),
        loiterS = actions["hover"]?.let { numberOf(it.text("hoverTime")) },
        gimbalPitchDeg = actions["gimbalRotate"]?.let { numberOf(it.text("gimbalPitchRotateAngle")) },
    )
}

private fun waylinesOf(kmz: ByteArray): ByteArray {
    try {
        ZipInputStream(ByteArrayInputStream(kmz)).use { zip ->
            repeat(MOST_ENTRIES) {
                val entry = zip.nextEntry ?: throw KmzError("Mission file must be a zip archive with $WAYLINES")
                if (entry.name == WAYLINES) return zip.readBounded()
            }
        }
    } catch (error: IOException) {
        throw KmzError("Mission file must be a whole zip archive; got ${error.message}", error)
    } catch (error: IllegalArgumentException) {
        // The library's answer to an entry name that is not UTF-8.
        throw KmzError("Mission file must be a zip archive with plain names; got ${error.message}", error)
    }
    throw KmzError("Mission file must have at most $MOST_ENTRIES entries")
}

private fun ZipInputStream.readBounded(): ByteArray {
    val content = ByteArrayOutputStream()
    val buffer = ByteArray(BUFFER_BYTES)
    while (true) {
        val count = read(buffer)
        if (count < 0) return content.toByteArray()
        content.write(buffer, 0, count)
        if (content.size() > LARGEST_FILE_BYTES) throw KmzError("$WAYLINES must have at most $LARGEST_FILE_BYTES bytes")
    }
}

private fun Element.children(name: String): List<Element> =
    (0 until childNodes.length).map { childNodes.item(it) }.filterIsInstance<Element>().filter { it.localName == name }

private fun Element.only(name: String): Element {
    val found = children(name)
    return found.singleOrNull() ?: throw KmzError("$localName must have one $name; got ${found.size}")
}

private fun Element.text(name: String): String = only(name).textContent.trim()

private fun numberOf(text: String): Double =
    text.trim().toDoubleOrNull()?.takeIf { it.isFinite() }
        ?: throw KmzError("A number was expected; got '${text.take(40)}'")
