"""XML elements with their lines."""
import xml.parsers.expat

from body import wrong


class Element:
    """An XML element, and the line in which it begins."""

    def __init__(self, tag, attributes, line):
        self.tag, self.attributes, self.line = tag, attributes, line
        self.text, self.children = "", []

    def all(self, *tags):
        return [child for child in self.children if child.tag in tags]


def xml_of(path, data):
    """Returns the elements of an XML file. path: for errors."""
    root = Element("", {}, 0)
    open_elements = [root]
    parser = xml.parsers.expat.ParserCreate()

    def begin(tag, attributes):
        element = Element(tag, attributes, parser.CurrentLineNumber)
        open_elements[-1].children.append(element)
        open_elements.append(element)

    def text(more):
        open_elements[-1].text += more

    parser.StartElementHandler = begin
    parser.EndElementHandler = lambda tag: open_elements.pop()
    parser.CharacterDataHandler = text
    parser.buffer_text = True
    try:
        parser.Parse(data, True)
    except xml.parsers.expat.ExpatError as error:
        wrong(path, error.lineno, f"this is not XML: {xml.parsers.expat.errors.messages[error.code]}")
    except (LookupError, ValueError) as error:  # raised by Python's codecs for encodings that expat does not know
        wrong(path, 1, f"the encoding that this line names cannot be read ({error}); save the file as UTF-8")
    return root
