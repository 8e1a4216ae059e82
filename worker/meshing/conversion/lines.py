"""Numbers and lines of text files, with errors that name the line."""
from body import wrong


def numbers(text, source, line, count=None, kind=float, commas=False):
    """Returns the numbers in a text. commas: whether commas separate numbers; if not, a comma (as a decimal sign) is an error."""
    words = (text.replace(",", " ") if commas else text).split()
    try:
        found = [kind(word) for word in words]
    except ValueError:
        wrong(source, line, f"expected numbers, found \"{text.strip()[:60]}\"")
    if count is not None and len(found) != count:
        wrong(source, line, f"expected {count} numbers, found {len(found)}")
    return found


def node_numbers(ids, number_of, source, line):
    try:
        return [number_of[i] for i in ids]
    except KeyError as missing:
        wrong(source, line, f"node {missing} is used but not defined")


def define(known, number, value, what, source, line):
    """Sets known[number] to value; it is an error if the number is already known."""
    if number in known:
        wrong(source, line, f"{what} {number} is defined twice; give each its own number")
    known[number] = value


def whole(number, what, source, line):
    """Returns a number as an integer; it is an error if it is not whole."""
    if not float(number).is_integer():
        wrong(source, line, f"{what} {number:g} is not a whole number; correct it")
    return int(number)


MARKS = {b"\xff\xfe": "UTF-16", b"\xfe\xff": "UTF-16"}


def bytes_of(path):
    """Returns the bytes of a text file, without a UTF-8 byte order mark."""
    data = path.read_bytes()
    if data[:2] in MARKS:
        wrong(path, 1, f"the text is {MARKS[data[:2]]}: save it as UTF-8 or ASCII")
    return data.removeprefix(b"\xef\xbb\xbf")


class ByteLines:
    """A file with lines of text and binary arrays, and the position of the next read."""

    def __init__(self, path, data):
        self.path, self.data, self.at = path, data, 0

    def line(self):
        end = self.data.find(b"\n", self.at)
        end = len(self.data) if end < 0 else end
        text = self.data[self.at:end].decode("utf-8", "replace").strip()
        self.at = end + 1
        return text


def data_lines(path, comment="#"):
    """Yields (number, text) of the lines that are not empty, without comments, which begin with `comment`."""
    try:
        with open(path, "rb") as file:
            mark = file.read(2)
        if mark in MARKS:
            wrong(path, 1, f"the text is {MARKS[mark]}: save it as UTF-8 or ASCII")
        with open(path, encoding="utf-8-sig", errors="replace") as lines:
            for number, line in enumerate(lines, 1):
                text = line.split(comment)[0].strip()
                if text:
                    yield number, text
    except OSError as error:
        wrong(path, None, error.strerror)
