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


def data_lines(path, comment="#"):
    """(number, text) of lines that say something; what follows `comment` says nothing."""
    try:
        with open(path, encoding="utf-8", errors="replace") as lines:
            for number, line in enumerate(lines, 1):
                text = line.split(comment)[0].strip()
                if text:
                    yield number, text
    except OSError as error:
        wrong(path, None, error.strerror)
