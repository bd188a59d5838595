package recon.companion

import java.io.IOException
import java.net.URI
import java.net.http.HttpClient
import java.net.http.HttpRequest
import java.net.http.HttpResponse
import java.time.Duration

/** Where the first pad is, WGS84 degrees and metres, and a sentence that tells where that is from. */
internal data class Home(val latitudeDeg: Double, val longitudeDeg: Double, val altitudeM: Double, val origin: String)

/** The field of the demonstration. */
private const val DEMO_LATITUDE_DEG = 41.9012
private const val DEMO_LONGITUDE_DEG = -93.6034
private const val DEMO_ALTITUDE_M = 275.0

private const val MOST_CHARACTERS = 8_000_000
private val PATIENCE: Duration = Duration.ofSeconds(3)

/** The site's origin in the state that the console's server tells (docs/api.md). */
private val SITE = Regex(
    """"site":\s*\{"name":\s*"(?:[^"\\]|\\.){0,1000}",\s*"latitude_deg":\s*([-0-9.eE+]{1,30}),""" +
        """\s*"longitude_deg":\s*([-0-9.eE+]{1,30}),\s*"ground_altitude_m":\s*([-0-9.eE+]{1,30})""",
)

/** The origin of the site of the station whose console is at this address, else the demonstration's field. */
internal fun homeOfStation(console: String): Home = try {
    val request = HttpRequest.newBuilder(URI.create("$console/api/state")).timeout(PATIENCE).build()
    val client = HttpClient.newBuilder().connectTimeout(PATIENCE).build()
    homeIn(client.send(request, HttpResponse.BodyHandlers.ofString()), console)
} catch (error: IOException) {
    demonstration("its console at $console does not answer")
} catch (error: IllegalArgumentException) {
    demonstration("'$console' is no address of a console")
}

private fun homeIn(answer: HttpResponse<String>, console: String): Home {
    if (answer.statusCode() != 200) return demonstration("its console at $console answered ${answer.statusCode()}")
    val found = SITE.find(answer.body().take(MOST_CHARACTERS))
    val numbers = found?.groupValues?.drop(1)?.mapNotNull { it.toDoubleOrNull() }
    if (numbers?.size != 3 || numbers.any { !it.isFinite() }) return demonstration("it has no site with an origin")
    return Home(numbers[0], numbers[1], numbers[2], "the origin of the station's site, by $console")
}

private fun demonstration(reason: String) = Home(
    DEMO_LATITUDE_DEG, DEMO_LONGITUDE_DEG, DEMO_ALTITUDE_M,
    "the demonstration's field, because the station's is not known: $reason; --home names another place",
)
