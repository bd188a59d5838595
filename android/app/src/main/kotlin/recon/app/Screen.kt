package recon.app

import android.app.Activity
import android.view.View
import android.view.ViewGroup
import android.widget.Button
import android.widget.EditText
import android.widget.TextView
import recon.aircraft.modelSentences
import recon.link.StationAddress
import recon.session.Severity
import java.text.SimpleDateFormat
import java.util.Date
import java.util.Locale

/** The views of the one screen, and how the host's state looks on them. */
class Screen(private val activity: Activity) {
    val addressView: EditText = activity.findViewById(R.id.address)
    private val setup: View = activity.findViewById(R.id.setup)
    private val rows: View = activity.findViewById(R.id.status)
    private val stations: ViewGroup = activity.findViewById(R.id.stations)
    private val problem: TextView = activity.findViewById(R.id.address_problem)
    private val messages: TextView = activity.findViewById(R.id.messages)
    private val release: View = activity.findViewById(R.id.release)
    private val allow: View = activity.findViewById(R.id.allow)
    private val disconnect: View = activity.findViewById(R.id.disconnect)
    private val time = SimpleDateFormat("HH:mm:ss", Locale.ROOT)

    fun onConnect(pressed: () -> Unit) = onPress(R.id.connect, pressed)

    fun onScan(pressed: () -> Unit) = onPress(R.id.scan, pressed)

    fun onRelease(pressed: () -> Unit) = onPress(R.id.release, pressed)

    fun onAllow(pressed: () -> Unit) = onPress(R.id.allow, pressed)

    fun onDisconnect(pressed: () -> Unit) = onPress(R.id.disconnect, pressed)

    fun onShare(pressed: () -> Unit) = onPress(R.id.share, pressed)

    fun showNote(note: String) {
        activity.findViewById<TextView>(R.id.note).text = note
        activity.findViewById<TextView>(R.id.models).text = modelSentences().joinToString("\n")
    }

    /** [text] null: the address can be used. */
    fun showAddressProblem(text: String?) {
        problem.text = text
        problem.visibility = visible(text != null)
    }

    /** One button for each station that announces itself. */
    fun showStations(found: List<FoundStation>, chosen: (StationAddress) -> Unit) {
        stations.removeAllViews()
        for (station in found) {
            activity.layoutInflater.inflate(R.layout.station, stations)
            val button = stations.getChildAt(stations.childCount - 1) as Button
            button.text = activity.getString(R.string.found_station, station.name, station.address.toString())
            button.setOnClickListener { chosen(station.address) }
        }
    }

    fun show(host: CompanionHost) {
        val isRunning = host.station != null
        setup.visibility = visible(!isRunning)
        rows.visibility = visible(isRunning)
        disconnect.visibility = visible(isRunning)
        release.visibility = visible(!host.isReleased)
        allow.visibility = visible(host.isReleased)
        val status = host.status ?: CONNECTING
        val link = activity.getString(R.string.link_to, host.station?.toString().orEmpty())
        show(R.id.link, link, status.link)
        show(R.id.aircraft, activity.getString(R.string.aircraft), status.aircraft)
        show(R.id.functions, activity.getString(R.string.functions), status.functions)
        show(R.id.control, activity.getString(R.string.control), status.control)
        show(R.id.altitude_reference, activity.getString(R.string.altitude_reference), status.altitudeReference)
        show(R.id.link_loss, activity.getString(R.string.lost_link_choice), status.missionOnLinkLoss)
        show(R.id.last_order, activity.getString(R.string.last_order), status.lastOrder)
        activity.findViewById<View>(R.id.hover_row).visibility = visible(status.hoverOnGround != null)
        status.hoverOnGround?.let { show(R.id.hover_row, activity.getString(R.string.hover_choice), it) }
        messages.text = host.messages.reversed().take(SHOWN_MESSAGES).joinToString("\n", transform = ::line)
            .ifEmpty { activity.getString(R.string.no_messages) }
    }

    private fun show(id: Int, label: String, row: Row) {
        val view = activity.findViewById<View>(id)
        view.findViewById<TextView>(R.id.row_label).text = label
        val words = view.findViewById<TextView>(R.id.row_words)
        words.text = row.words
        val (plate, text) = COLORS.getValue(row.level)
        words.setTextColor(activity.getColor(text))
        words.setBackgroundColor(activity.getColor(plate))
    }

    private fun line(message: Message): String {
        val mark = if (message.severity == Severity.INFO) "" else "${message.severity.name.lowercase()}: "
        return "${time.format(Date(message.atMs))}  $mark${message.text}"
    }

    private fun onPress(id: Int, pressed: () -> Unit) =
        activity.findViewById<View>(id).setOnClickListener { pressed() }

    private fun visible(isShown: Boolean) = if (isShown) View.VISIBLE else View.GONE

    private companion object {
        const val SHOWN_MESSAGES = 6
        val COLORS = mapOf(
            Level.NORMAL to (R.color.background to R.color.text),
            Level.CAUTION to (R.color.caution to R.color.on_caution),
            Level.PROBLEM to (R.color.problem to R.color.on_problem),
        )
        val NOTHING = Row("-")
        val CONNECTING = Status(
            Row("Connecting"), NOTHING, NOTHING, NOTHING, NOTHING, NOTHING, hoverOnGround = null, lastOrder = NOTHING,
            isReleased = false, isFlyingForStation = false,
        )
    }
}
