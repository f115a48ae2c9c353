"""Explanations of what reading UPPAAL's XML and layout side files reports."""

from __future__ import annotations

from tachk.base.diagnostics.explanation import Explanation

XML_CODES: dict[str, Explanation] = {
    "E0120": Explanation(
        "not well-formed XML",
        "The file breaks a rule of XML itself: a tag is not closed, or `<` or `&` stands in a label as such instead of "
        "as &lt; or &amp;. UPPAAL cannot open it either.",
    ),
    "E0121": Explanation(
        "entity in XML",
        "Entities let a file grow without bound or draw in other files, and no UPPAAL model needs them. Only &lt; &gt; "
        "&amp; &quot; &apos; and characters by number are read.",
    ),
    "E0122": Explanation(
        "XML too deep or too large",
        "UPPAAL's format nests six levels. A file with far more is damaged or hostile.",
    ),
    "E0123": Explanation(
        "not a UPPAAL model",
        "The root of a UPPAAL model is the element <nta>. Other XML is not read.",
    ),
    "E0124": Explanation(
        "incomplete element",
        "A template has no name, or an edge has no source or target, or an edge refers to a location that its template "
        "does not have.",
    ),
    "E0125": Explanation(
        "broken layout file",
        "The file NAME.layout.json beside NAME.ta keeps the picture of the model. tachk convert writes it. "
        "Without it, tachk lays out a new picture.",
    ),
    "W0120": Explanation(
        "unknown kind of label",
        "UPPAAL passes over labels of kinds that it does not know. tachk corrects a misspelt kind; any other label "
        "stays in the file and has no effect.",
    ),
    "W0121": Explanation(
        "location renamed",
        "The name of a location must be an identifier, not a reserved word, and occur once in its template. In the "
        "text and in queries the location has the name that the message tells; the XML keeps its own.",
    ),
    "W0122": Explanation(
        "label given twice",
        "An edge or location has one label of each kind. Of several labels, UPPAAL and tachk take the last one.",
    ),
    "W0123": Explanation(
        "kept but not checked",
        "The construct belongs to statistical model checking, games or scenarios. tachk keeps it for the export to "
        "UPPAAL, and does not check queries that depend on it.",
    ),
}
