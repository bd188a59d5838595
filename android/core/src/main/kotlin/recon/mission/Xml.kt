package recon.mission

import org.w3c.dom.Document
import org.w3c.dom.Element
import org.xml.sax.SAXException
import java.io.ByteArrayInputStream
import java.io.ByteArrayOutputStream
import java.io.IOException
import javax.xml.parsers.DocumentBuilderFactory
import javax.xml.parsers.ParserConfigurationException
import javax.xml.transform.OutputKeys
import javax.xml.transform.TransformerFactory
import javax.xml.transform.dom.DOMSource
import javax.xml.transform.stream.StreamResult

internal const val KML = "http://www.opengis.net/kml/2.2"
internal const val WPML = "http://www.dji.com/wpmz/1.0.2"
private const val PREFIX = "wpml:"

/** Adds an element; `wpml:` in its name is DJI's namespace. */
internal fun Element.add(name: String, text: String? = null, content: Element.() -> Unit = {}): Element {
    val space = if (name.startsWith(PREFIX)) WPML else KML
    val child = ownerDocument.createElementNS(space, name)
    if (text != null) child.textContent = text
    child.content()
    appendChild(child)
    return child
}

/** A KML file with this content of its Document element. */
internal fun kmlFile(content: Element.() -> Unit): ByteArray {
    val document = factory().newDocumentBuilder().newDocument()
    val root = document.createElementNS(KML, "kml")
    root.setAttribute("xmlns:wpml", WPML)
    document.appendChild(root)
    root.add("Document", content = content)
    return serialized(document)
}

/** The root of a KML file from outside, without document types or entities. Raises [KmzError]. */
internal fun parsedKml(file: ByteArray): Element {
    if (String(file, Charsets.ISO_8859_1).contains("<!DOCTYPE")) throw KmzError("Mission file must have no DOCTYPE")
    try {
        val builder = factory().newDocumentBuilder().apply { setErrorHandler(null) }
        return builder.parse(ByteArrayInputStream(file)).documentElement
    } catch (error: SAXException) {
        throw KmzError("Mission file must be XML; got ${error.message}", error)
    } catch (error: IOException) {
        throw KmzError("Mission file must be XML in UTF-8; got ${error.message}", error)
    }
}

private fun factory() = DocumentBuilderFactory.newInstance().apply {
    isNamespaceAware = true
    isExpandEntityReferences = false
    // Android's parser does not know the feature; there the DOCTYPE is refused by its text alone.
    try {
        setFeature("http://apache.org/xml/features/disallow-doctype-decl", true)
    } catch (_: ParserConfigurationException) {
        return@apply
    }
}

private fun serialized(document: Document): ByteArray {
    val out = ByteArrayOutputStream()
    val transformer = TransformerFactory.newInstance().newTransformer()
    transformer.setOutputProperty(OutputKeys.ENCODING, "UTF-8")
    transformer.setOutputProperty(OutputKeys.INDENT, "yes")
    transformer.transform(DOMSource(document), StreamResult(out))
    return out.toByteArray()
}
