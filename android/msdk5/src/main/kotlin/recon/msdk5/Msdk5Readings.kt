package recon.msdk5

import dji.sdk.keyvalue.key.BatteryKey
import dji.sdk.keyvalue.key.FlightControllerKey
import dji.sdk.keyvalue.key.GimbalKey
import dji.sdk.keyvalue.key.ProductKey
import dji.sdk.keyvalue.key.RtkMobileStationKey

/** What changes seldom, but for the camera, by DJI's keys. */
internal fun msdk5Readings(keys: Msdk5Keys): DjiReadings {
    val home = keys.value(FlightControllerKey.KeyHomeLocation)
    val gimbal = keys.value(GimbalKey.KeyGimbalAttitude)
    return DjiReadings(
        isHomeSet = keys.value(FlightControllerKey.KeyIsHomeLocationSet),
        homeLatitudeDeg = home?.latitude,
        homeLongitudeDeg = home?.longitude,
        heightLimitM = keys.value(FlightControllerKey.KeyHeightLimit),
        distanceLimitM = keys.value(FlightControllerKey.KeyDistanceLimit),
        isDistanceLimited = keys.value(FlightControllerKey.KeyDistanceLimitEnabled),
        firmware = keys.value(ProductKey.KeyFirmwareVersion),
        cellsMv = listOf(keys.value(BatteryKey.KeyCellVoltages), keys.valueOfSecond(BatteryKey.KeyCellVoltages))
            .flatMap { it.orEmpty().filterNotNull() },
        batteryTemperaturesC = listOfNotNull(
            keys.value(BatteryKey.KeyBatteryTemperature), keys.valueOfSecond(BatteryKey.KeyBatteryTemperature),
        ),
        isRtkEnabled = keys.value(RtkMobileStationKey.KeyRTKEnable),
        rtkSolution = keys.value(RtkMobileStationKey.KeyRTKLocation)?.positioningSolution?.name,
        gimbalYawDeg = gimbal?.yaw,
        gimbalPitchDeg = gimbal?.pitch,
        gimbalRollDeg = gimbal?.roll,
    )
}
