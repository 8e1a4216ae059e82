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


def name_once(known, what, name, value, source, line):
    """known[name] = value, of a node or an element that has this number in the file."""
    if name in known:
        wrong(source, line, f"{what} {name} is defined twice; number each once")
    known[name] = value


def node_numbers(ids, number_of, source, line):
    try:
        return [number_of[i] for i in ids]
    except KeyError as missing:
        wrong(source, line, f"node {missing} is used and not defined")


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
