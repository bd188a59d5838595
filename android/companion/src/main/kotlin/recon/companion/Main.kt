package recon.companion

import picocli.CommandLine
import picocli.CommandLine.Command
import picocli.CommandLine.Option
import picocli.CommandLine.ParameterException
import recon.aircraft.AltitudeReference
import recon.errors.ReconError
import recon.geo.LatLon
import recon.geo.LocalPlane
import recon.link.CompanionApp
import recon.link.CompanionListener
import recon.link.FrameEncoder
import recon.link.RawFrameEncoder
import recon.link.StationAddress
import recon.session.HoverOnGround
import recon.session.LinkLossAction
import recon.session.Output
import recon.session.SessionSettings
import recon.sim.SimulatedAircraft
import recon.sim.SimulatedSettings
import java.util.concurrent.Callable
import java.util.concurrent.CountDownLatch
import kotlin.system.exitProcess

/** PID 2 of the first revision, or PID 5 of the later ones. */
enum class ImageFormat { RAW, JPEG }

@Command(
    name = "recon-companion",
    mixinStandardHelpOptions = true,
    versionProvider = Version::class,
    sortOptions = false,
    description = ["Companion apps with simulated aircraft, connected to a station until Ctrl+C."],
)
class RunCompanions : Callable<Int> {
    @Option(
        names = ["--station"],
        paramLabel = "HOST:PORT",
        required = true,
        description = ["Where the station listens."],
    )
    lateinit var station: String

    @Option(names = ["--vehicles"], defaultValue = "1", description = ["Number of aircraft. [\${DEFAULT-VALUE}]"])
    var vehicles = 1

    @Option(
        names = ["--serial"],
        defaultValue = "SIM-1",
        description = ["Serial of the first; the others count on. [\${DEFAULT-VALUE}]"],
    )
    lateinit var serial: String

    @Option(
        names = ["--home"],
        paramLabel = "LAT,LON,ALT",
        description = ["Pad of the first, WGS84 degrees and metres. [the origin of the station's site]"],
    )
    var home: String? = null

    @Option(
        names = ["--console"],
        paramLabel = "URL",
        description = ["Where the station's console tells its site, without --home. [http://HOST:8080]"],
    )
    var console: String? = null

    @Option(
        names = ["--spacing-m"],
        defaultValue = "20",
        description = ["Pads stand in a row to the east. [\${DEFAULT-VALUE}]"],
    )
    var spacingM = 20.0

    @Option(names = ["--airborne-m"], description = ["Start hovering at this height above takeoff."])
    var airborneM: Double? = null

    @Option(
        names = ["--go-home-m"],
        defaultValue = "40",
        description = ["Go-home height of the first; the others are set 8 m apart. [\${DEFAULT-VALUE}]"],
    )
    var goHomeM = 40.0

    @Option(
        names = ["--endurance-min"],
        defaultValue = "25",
        description = ["Minutes on a battery. [\${DEFAULT-VALUE}]"],
    )
    var enduranceMin = 25.0

    @Option(
        names = ["--waypoint-altitude"],
        defaultValue = "TAKEOFF",
        description = [
            "As the vehicle's waypoint_altitude in site.toml: \${COMPLETION-CANDIDATES}. [\${DEFAULT-VALUE}]",
        ],
    )
    lateinit var waypointAltitude: AltitudeReference

    @Option(
        names = ["--mission-on-lost-link"],
        defaultValue = "HOLD",
        description = ["\${COMPLETION-CANDIDATES}. [\${DEFAULT-VALUE}]"],
    )
    lateinit var missionOnLostLink: LinkLossAction

    @Option(
        names = ["--hover-on-ground"],
        defaultValue = "IGNORE",
        description = ["\${COMPLETION-CANDIDATES}. [\${DEFAULT-VALUE}]"],
    )
    lateinit var hoverOnGround: HoverOnGround

    @Option(
        names = ["--images"],
        defaultValue = "JPEG",
        description = ["\${COMPLETION-CANDIDATES}. [\${DEFAULT-VALUE}]"],
    )
    lateinit var images: ImageFormat

    @CommandLine.Spec
    lateinit var spec: CommandLine.Model.CommandSpec

    override fun call(): Int {
        if (vehicles !in 1..MOST_VEHICLES) throw wrong("--vehicles must be 1 to $MOST_VEHICLES; got $vehicles")
        val place = homePlace()
        println("home: ${place.origin}: ${place.latitudeDeg}, ${place.longitudeDeg}, ${place.altitudeM} m")
        val companions = (0 until vehicles).map { companion(it, place) }
        val end = CountDownLatch(1)
        Runtime.getRuntime().addShutdownHook(Thread {
            companions.forEach { it.close() }
            end.countDown()
        })
        companions.forEach { it.start() }
        end.await()
        return 0
    }

    private fun companion(index: Int, place: Home): CompanionApp {
        val settings = SessionSettings(
            altitudeReference = waypointAltitude,
            missionOnLinkLoss = missionOnLostLink,
            hoverOnGround = hoverOnGround,
            appName = "Recon companion ${Version.TEXT}, simulated aircraft",
            startedS = System.currentTimeMillis() / 1_000,
        )
        val aircraft = aircraftSettings(index, place)
        return CompanionApp(settings, SimulatedAircraft(aircraft), address(), encoder(), Printed(aircraft.serial))
    }

    private fun aircraftSettings(index: Int, place: Home): SimulatedSettings {
        val pad = LocalPlane(LatLon(place.latitudeDeg, place.longitudeDeg)).position(0.0, index * spacingM)
        return SimulatedSettings(
            serial = serialOf(serial, index),
            home = pad,
            takeoffAltitudeM = place.altitudeM,
            // Vehicles that return at once are separated by their heights.
            goHomeHeightM = goHomeM + 8.0 * index,
            enduranceMin = enduranceMin,
            startHeightM = airborneM,
        )
    }

    private fun homePlace(): Home {
        val named = home ?: return homeOfStation(console ?: "http://${address().host}:8080")
        val numbers = named.split(",").mapNotNull { it.trim().toDoubleOrNull() }
        if (numbers.size != 3) throw wrong("--home must be LAT,LON,ALT; got '$named'")
        return Home(numbers[0], numbers[1], numbers[2], "as --home names it")
    }

    private fun address(): StationAddress = try {
        StationAddress.parse(station)
    } catch (error: ReconError) {
        throw wrong(error.message)
    }

    private fun wrong(message: String) = ParameterException(spec.commandLine(), message)

    private fun encoder(): FrameEncoder = if (images == ImageFormat.RAW) RawFrameEncoder else JpegEncoder

    private companion object {
        /** Each has four threads of its own. */
        const val MOST_VEHICLES = 64
    }
}

/** `SIM-3` and 2 is `SIM-5`; a serial without a number at its end gets one. */
internal fun serialOf(first: String, index: Int): String {
    if (index == 0) return first
    val digits = first.takeLastWhile { it.isDigit() }
    val number = digits.toLongOrNull() ?: return "$first-${index + 1}"
    return first.dropLast(digits.length) + (number + index)
}

private class Printed(private val serial: String) : CompanionListener {
    override fun notice(notice: Output.Notice) = println("$serial: ${notice.severity.name.lowercase()}: ${notice.text}")
}

class Version : CommandLine.IVersionProvider {
    override fun getVersion() = arrayOf(TEXT)

    companion object {
        /** As in the jar's manifest; empty when run from classes. */
        val TEXT: String = Version::class.java.`package`?.implementationVersion.orEmpty()
    }
}

fun main(arguments: Array<String>) {
    val commandLine = CommandLine(RunCompanions()).setCaseInsensitiveEnumValuesAllowed(true)
    exitProcess(commandLine.execute(*arguments))
}
