package recon.aircraft

import recon.session.hovering
import java.io.File
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertNull
import kotlin.test.assertTrue

class AircraftModelsTest {
    @Test
    fun `a model is told by DJI's product, and its camera where a series has several`() {
        assertEquals("Mini 4 Pro", aircraftModelOf("DJI_MINI_4_PRO", null)?.name)
        assertEquals("Mavic 3M", aircraftModelOf("DJI_MAVIC_3_ENTERPRISE_SERIES", "M3M")?.name)
        assertNull(aircraftModelOf("DJI_MAVIC_3_ENTERPRISE_SERIES", null))
        for (product in listOf(null, "UNRECOGNIZED")) assertNull(aircraftModelOf(product, null))
        val matrice = aircraftModelOf("M350_RTK", "ZENMUSE_H30T")!!
        assertEquals(CameraNumber(83, "wide"), matrice.numberWith("ZENMUSE_H30T")?.camera)
        for (camera in listOf(null, "ZENMUSE_P1")) assertEquals(DroneNumber(89, 0), matrice.numberWith(camera))
        assertNull(aircraftModelOf("DJI_MINI_3", null)!!.numberWith(null))
    }

    @Test
    fun `an aircraft is asked first, and the table is what is expected until it has answered`() {
        val mini = hovering().copy(capabilities = Capabilities(), facts = AircraftFacts(model = "Mini 3"))
        val expected = "sticks, camera control, photo reports; no missions, plans as files, photos by the mission"
        assertEquals(expected, functionWords(mini))
        val answered = mini.copy(
            capabilities = Capabilities(waypointMissions = Capability.SUPPORTED),
            facts = mini.facts.copy(reportsPhotos = false),
        )
        assertEquals(Capability.SUPPORTED, answered.has(ModelFunction.MISSIONS))
        assertEquals(Capability.UNSUPPORTED, answered.has(ModelFunction.PHOTO_REPORTS))
        val unknown = hovering().copy(capabilities = Capabilities(), facts = AircraftFacts(model = "Air 9"))
        assertEquals("not known yet", functionWords(unknown))
        val asked = unknown.copy(facts = AircraftFacts(reportsPhotos = true))
        assertEquals("photo reports", functionWords(asked))
        assertTrue(modelSentences().first().startsWith("Missions and sticks: Mini 4 Pro, Mavic 3E,"))
        assertEquals("Sticks only: Mini 3, Mini 3 Pro.", modelSentences()[1])
        assertEquals("Plans as files only: Matrice 3D, Matrice 3TD.", modelSentences()[2])
    }

    @Test
    fun `the guide has the table of models`() {
        val columns = ModelFunction.entries
        val rows = AIRCRAFT_MODELS.map { model -> row(model.name, columns.map { if (model.has(it)) "yes" else "no" }) }
        val table = listOf(row("aircraft", columns.map { it.shownName }), "|" + "---|".repeat(columns.size + 1)) + rows
        assertTrue(table.joinToString("\n") in GUIDE.readText(), "$GUIDE must have:\n" + table.joinToString("\n"))
    }

    private fun row(first: String, cells: List<String>) = "| $first | ${cells.joinToString(" | ")} |"
}

private val GUIDE = File("../../docs/how-to/connect-an-app.md")
