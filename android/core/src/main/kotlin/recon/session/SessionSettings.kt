package recon.session

import recon.aircraft.AltitudeReference

/** What happens to a running mission when the link to the station is lost. */
enum class LinkLossAction(val shownName: String) {
    CONTINUE("continue"),
    HOLD("hold"),
    RETURN("return"),
}

/** What a hover does to an aircraft on the ground; the protocol cannot tell a stop from a takeoff. */
enum class HoverOnGround(val shownName: String) {
    IGNORE("ignore"),
    TAKEOFF("takeoff"),
}

/** Settings of one app; those that a person chooses come first and are reported to the station. */
data class SessionSettings(
    val altitudeReference: AltitudeReference = AltitudeReference.TAKEOFF,
    /** A mission without a station has no separation from other traffic: by default it holds. */
    val missionOnLinkLoss: LinkLossAction = LinkLossAction.HOLD,
    val hoverOnGround: HoverOnGround = HoverOnGround.IGNORE,
    val appName: String = "Recon companion",
    /** When the app started, seconds since 1970: the number of its first series of photos. */
    val startedS: Long = 0,

    /** Reconnections within this time do not count as a lost link for a mission. */
    val missionLinkLossDelayNs: Long = 5_000_000_000,
    val corePeriodNs: Long = 100_000_000,
    val extendedPeriodNs: Long = 500_000_000,
    /** Older state is not sent: the controller has lost its aircraft. */
    val stateTimeoutNs: Long = 2_000_000_000,
    /** DJI accepts 5 to 25 Hz. */
    val stickPeriodNs: Long = 100_000_000,
    /** Zero velocity for this long after a stick's timeout, then a hover gives the sticks back. */
    val stickNeutralNs: Long = 2_000_000_000,
    /** From the first stick until the flight mode shows what the aircraft and its pilot make of it. */
    val stickModeSettlesNs: Long = 1_000_000_000,
    /** A longer timeout is no dead-man: refused. */
    val longestStickTimeoutS: Double = 60.0,
    /** The station waits 2 s for an acknowledgment; an answer that takes longer is announced. */
    val slowAnswerNs: Long = 1_500_000_000,
    /** Without an answer for this long the command is refused; KMZ uploads take several seconds. */
    val answerTimeoutNs: Long = 20_000_000_000,
    /** From the acceptance of a mission until state must show it flown. */
    val missionStartNs: Long = 5_000_000_000,
    val landingConfirmationPeriodNs: Long = 1_000_000_000,
    /** One write to the socket that takes longer means that the station has stopped reading. */
    val stalledWriteNs: Long = 5_000_000_000,
    val fastestVideoHz: Double = 10.0,
    /** On a link that carries little, images come at this rate at least, with less quality then. */
    val slowestVideoHz: Double = 0.2,
    /** The same sentence is not repeated to the station within this time. */
    val repeatedReportNs: Long = 5_000_000_000,
)
