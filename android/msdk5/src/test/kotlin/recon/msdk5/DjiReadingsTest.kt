package recon.msdk5

import recon.aircraft.AircraftFacts
import recon.aircraft.Attitude
import recon.aircraft.CameraMode
import recon.aircraft.RtkState
import recon.geo.LatLon
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertNull

class DjiReadingsTest {
    @Test
    fun `DJI's values are facts in the units of the interface`() {
        val readings = DjiReadings(
            isHomeSet = true, homeLatitudeDeg = 45.0, homeLongitudeDeg = -93.0, heightLimitM = 120,
            distanceLimitM = 2_000, isDistanceLimited = true, firmware = "01.02", cellsMv = listOf(3_912, 3_905),
            batteryTemperaturesC = listOf(30.5, 31.5), isRtkEnabled = true, rtkSolution = "FIXED_POINT",
            storageLeftMb = 100, storageLeftPhotos = 7, gimbalYawDeg = 10.0, gimbalPitchDeg = -90.0,
            gimbalRollDeg = 0.0, cameraMode = "PHOTO_INTERVAL", photoIntervalS = 2.0, isExposureLocked = false,
            exposureMode = "MANUAL", whiteBalance = WhiteBalance("SUNNY", null), tellsFiles = true,
            takesExposureLock = true,
        )
        val expected = AircraftFacts(
            LatLon(45.0, -93.0), 120.0, 2_000.0, "Mavic 3E", "01.02", listOf(3.912, 3.905), 31.5, RtkState.FIXED, 100,
            7, Attitude(10.0, -90.0, 0.0), CameraMode.INTERVAL, 2.0, isExposureLocked = true,
            isWhiteBalanceLocked = true, reportsPhotos = true, locksCamera = true, "registered with DJI", true,
        )
        assertEquals(expected, factsOf(FLYING, readings))
    }

    @Test
    fun `what DJI does not tell, or tells as unknown, is not known`() {
        val nothing = AircraftFacts(model = "Mavic 3E", djiCheck = "registered with DJI", isDjiCheckPassed = true)
        assertEquals(nothing, factsOf(FLYING, DjiReadings()))
        val unknown = DjiReadings(
            isHomeSet = false, homeLatitudeDeg = 45.0, homeLongitudeDeg = 0.0, distanceLimitM = 50,
            isDistanceLimited = false, firmware = " ", rtkSolution = "UNKNOWN", cameraMode = "UNKNOWN",
            photoIntervalS = 0.0, whiteBalance = WhiteBalance("UNKNOWN", null),
        )
        assertEquals(nothing, factsOf(FLYING, unknown))
        assertNull(factsOf(FLYING, unknown.copy(isHomeSet = true, homeLatitudeDeg = 0.0)).home)
        assertNull(factsOf(FLYING.copy(product = "UNRECOGNIZED"), unknown).model)
        assertEquals("DJI_AIR_9", factsOf(FLYING.copy(product = "DJI_AIR_9"), unknown).model)
        assertEquals(RtkState.OFF, factsOf(FLYING, unknown.copy(isRtkEnabled = false)).rtk)
        assertEquals(false, factsOf(FLYING, unknown.copy(whiteBalance = WhiteBalance("AUTO", 50))).isWhiteBalanceLocked)
        val modes = mapOf("VIDEO_NORMAL" to CameraMode.VIDEO, "PHOTO_AEB" to CameraMode.OTHER)
        for ((name, mode) in modes) assertEquals(mode, factsOf(FLYING, unknown.copy(cameraMode = name)).cameraMode)
    }
}
