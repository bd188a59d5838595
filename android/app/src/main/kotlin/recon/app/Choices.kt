package recon.app

import android.app.Activity
import android.view.View
import android.widget.AdapterView
import android.widget.Spinner
import recon.aircraft.AltitudeReference
import recon.session.HoverOnGround
import recon.session.LinkLossAction

/** The settings on the screen. Each list of choices has the order of its enumeration. */
class Choices(private val activity: Activity, settings: AppSettings) {
    init {
        bind(R.id.waypoint_altitude, settings.altitudeReference.ordinal) {
            settings.altitudeReference = AltitudeReference.entries[it]
        }
        bind(R.id.lost_link, settings.missionOnLinkLoss.ordinal) {
            settings.missionOnLinkLoss = LinkLossAction.entries[it]
        }
        bind(R.id.hover, settings.hoverOnGround.ordinal) { settings.hoverOnGround = HoverOnGround.entries[it] }
    }

    private fun bind(id: Int, initial: Int, chosen: (Int) -> Unit) {
        val spinner = activity.findViewById<Spinner>(id)
        // The settings are the truth, not the view's own saved state.
        spinner.isSaveEnabled = false
        spinner.setSelection(initial)
        spinner.onItemSelectedListener = object : AdapterView.OnItemSelectedListener {
            override fun onItemSelected(parent: AdapterView<*>?, view: View?, position: Int, id: Long) =
                chosen(position)

            override fun onNothingSelected(parent: AdapterView<*>?) = Unit
        }
    }
}
