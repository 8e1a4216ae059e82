"""Numbers and lines of files that people can read."""
from body import wrong


def numbers(text, source, line, count=None, kind=float, commas=False):
    """commas: between the numbers; else one is the decimal sign of another country, and refused."""
    words = (text.replace(",", " ") if commas else text).split()
    try:
        found = [kind(word) for word in words]
    except ValueError:
        wrong(source, line, f"\"{text.strip()[:60]}\" where numbers are expected")
    if count is not None and len(found) != count:
        wrong(source, line, f"{len(found)} numbers where {count} are expected")
    return found


def node_numbers(ids, number_of, source, line):
    try:
        return [number_of[i] for i in ids]
    except KeyError as missing:
        wrong(source, line, f"node {missing} is used and not defined")


def define(known, number, value, what, source, line):
    """known[number] is value from here on, and was nothing before."""
    if number in known:
        wrong(source, line, f"{what} {number} is defined twice; give each a number of its own")
    known[number] = value


def whole(number, what, source, line):
    """A number that was read together with others, which need not be whole."""
    if not float(number).is_integer():
        wrong(source, line, f"{what} {number:g} is not a whole number; write one here")
    return int(number)


MARKS = {b"\xff\xfe": "UTF-16", b"\xfe\xff": "UTF-16"}


def bytes_of(path):
    """Of a file of text, without the mark that some programs for Windows begin UTF-8 with."""
    data = path.read_bytes()
    if data[:2] in MARKS:
        wrong(path, 1, f"its text is {MARKS[data[:2]]}: save it as UTF-8 or ASCII")
    return data.removeprefix(b"\xef\xbb\xbf")


class ByteLines:
    """A file whose lines of text stand between arrays of bytes: where it is read next."""

    def __init__(self, path, data):
        self.path, self.data, self.at = path, data, 0

    def line(self):
        end = self.data.find(b"\n", self.at)
        end = len(self.data) if end < 0 else end
        text = self.data[self.at:end].decode("utf-8", "replace").strip()
        self.at = end + 1
        return text


def data_lines(path, comment="#"):
    """(number, text) of lines that say something; what follows `comment` says nothing."""
    try:
        with open(path, "rb") as file:
            mark = file.read(2)
        if mark in MARKS:
            wrong(path, 1, f"its text is {MARKS[mark]}: save it as UTF-8 or ASCII")
        with open(path, encoding="utf-8-sig", errors="replace") as lines:
            for number, line in enumerate(lines, 1):
                text = line.split(comment)[0].strip()
                if text:
                    yield number, text
    except OSError as error:
        wrong(path, None, error.strerror)
