#!/usr/bin/python3
"""Writes index.html for the results of deploy/gallery in a folder: pictures, tables, links. Sources of material parameters and
verification results come from docs/gallery.md.

    deploy/scenes/gallery_index.py FOLDER NAME... [--markdown]     (prints only the tables, for docs/gallery.md)
"""
import html
import json
import pathlib
import re
import sys
import tomllib

SCENES = pathlib.Path(__file__).resolve().parent
MANUAL = SCENES.parents[1] / "docs" / "gallery.md"


def scene_file(name):
    return SCENES / name / ("liver-surface.toml" if name == "liver" else f"{name}.toml")


def title(name):
    """Returns the first sentence of the scene's comment."""
    comment = ""
    for line in scene_file(name).read_text(encoding="utf-8").splitlines():
        if not line.startswith("# "):
            break
        comment += line[2:] + " "
    return comment.split(". ")[0].split(": ")[0].strip().rstrip(".")


def seconds_of(folder, name):
    """Returns the elapsed and processor seconds of all runs of the build."""
    runs = [list(map(float, line.split())) for line in (folder / f"{name}.times").read_text(encoding="utf-8").splitlines()]
    return sum(run[0] for run in runs), sum(run[1] + run[2] for run in runs)


def percent(share):
    return "-" if share is None else f"{100 * share:.{1 if share < 0.1 else 0}f} %"


def size(file):
    return f"{file.stat().st_size / 1e6:.1f} MB" if file.exists() else "-"


def accuracy(report):
    """Yields the accuracy of forces between solved points: the dataset's bound and the measured error."""
    area = report["areas"][0]
    bound, measured = area["relative_bound"], area["probes"]["area"]
    yield "error bound of the force", f"median {percent(bound['median'])}, 95 % below {percent(bound['percentile_95'])}"
    yield "error at exact solutions held out", (
        f"median {percent(measured['relative']['median'])}, 95 % below {percent(measured['relative']['percentile_95'])}, "
        f"{percent(measured['within_target'])} of {measured['count']} within 3 % or 10 mN; "
        f"the bound holds at {percent(measured['bound_holds'])}")


def rows(folder, name):
    """Returns the table of a scene: (property, value)."""
    scene = tomllib.loads(scene_file(name).read_text(encoding="utf-8"))
    check = json.loads((folder / f"{name}.check").read_text(encoding="utf-8"))
    report = json.loads((folder / f"{name}.report").read_text(encoding="utf-8"))
    mesh, (dataset,) = check["mesh"], report["datasets"]
    extent = " x ".join(f"{1e3 * (b - a):.0f}" for a, b in zip(mesh["lowest"], mesh["highest"]))
    tags = {}
    for node in report["nodes"]:
        for tag, count in node["points"].items():
            tags[tag] = tags.get(tag, 0) + count
    failures = ", ".join(f"{found['points']} {cause}" for cause, found in report["failures"].items() if found["points"])
    elapsed, processor = seconds_of(folder, name)
    (active,) = scene["active"]
    unit = {"m": 1e3, "cm": 10, "mm": 1}[scene["length_unit"]]
    return [
        ("size", f"{extent} mm, {1e3 * mesh['volume']:.2f} litres"),
        ("mesh", f"{mesh['nodes']} nodes, {mesh['tetrahedra']} tetrahedra, edges {1e3 * mesh['edge']['mean']:.1f} mm"),
        ("materials", "; ".join(f"{region['group'] or name}: {region['law']}" for region in check["regions"])),
        ("held", f"{check['fixed_nodes']} nodes"),
        ("finger", f"radius {unit * active['radius']:.0f} mm, pressed by up to {1e3 * dataset['radius']:.0f} mm, "
                   f"cells of {1e3 * dataset['spacing']:.0f} mm" + (", split where needed" if scene["accuracy"]["levels"] else "")),
        ("computed", f"{len(check['active'])} places of the finger, {dataset['configurations']} configurations"),
        ("failed", failures or "none"),
        ("build", f"{elapsed:.0f} s, {processor:.0f} s of processors"),
        ("file, page", f"{size(folder / f'{name}.h5')}, {size(folder / f'{name}.html')}"),
        ("largest force solved", f"{max(node['largest_force'] for node in report['nodes']):.1f} N"),
        *accuracy(report),
    ]


def plain(text):
    """Removes Markdown links and markup."""
    return re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", text).replace("`", "").replace("*", "")


def written(name):
    """Returns the properties of a scene that the manual gives, (property, value). Empty for an unknown scene."""
    manual = MANUAL.read_text(encoding="utf-8")
    section = next((part for part in manual.split("\n## ") if f"deploy/scenes/{name}/" in part), "")
    materials = re.search(r"^Materials: (.+?)\n\n", section + "\n\n", re.M | re.S)
    if not materials:
        return []
    lines = [line.strip("| ").split(" | ") for line in manual.splitlines() if line.startswith("|")]
    names = next(line for line in lines if name in line)
    return [("materials", plain(materials[1].replace("\n", " ")))] + [
        (what, plain(values[names.index(name)])) for what, *values in lines
        if len(values) == len(names) and what.startswith(("grade", "forces by", "finer mesh"))]


def table(folder, name):
    """Returns the table of a scene as HTML."""
    every = {**dict(rows(folder, name)), **dict(written(name))}
    return "".join(f"<tr><td>{html.escape(what)}<td>{html.escape(value)}" for what, value in every.items())


def links(folder, name):
    """Returns links to the existing pages of a scene, and the name of its dataset."""
    there = [(f"{name}.html", "Touch it"), (f"{name}-report.html", "Report: accuracy and speed")]
    parts = [f'<a href="{file}">{words}</a>' for file, words in there if (folder / file).exists()]
    return " &middot; ".join([*parts, f"dataset: {name}.h5"])


def grades():
    """Returns the meanings of the grades from the manual: (letter, sentence)."""
    return [(letter, plain(value)) for letter, value in
            re.findall(r"^\| ([A-C]) \| (.+?) \|$", MANUAL.read_text(encoding="utf-8"), re.M)]


def page(folder, names):
    parts = ["""<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>Palpate: gallery</title><style>
body { font: 16px/1.5 system-ui, sans-serif; max-width: 64em; margin: 2em auto; padding: 0 1em; color: #222 }
section { margin: 3em 0 } img { width: 100%; border-radius: 6px } td { padding: .15em 1em .15em 0; vertical-align: top }
td { overflow-wrap: anywhere } td:first-child { color: #777; white-space: nowrap }
@media (max-width: 600px) { body { margin: 1em auto } td { display: block; padding: 0 } td:first-child { padding-top: .5em } }
</style><h1>Palpate: gallery</h1><p>Bodies that can be touched anywhere. Click a picture to touch its body.</p>"""]
    for name in names:
        touch, picture = (folder / f"{name}.{ending}" for ending in ("html", "png"))
        shown = f'<img src="{name}.png" alt="{name}">' if picture.exists() else f"<h3>{name}: no picture</h3>"
        linked = f'<a href="{name}.html">{shown}</a>' if touch.exists() else shown
        parts.append(f"<section><h2>{html.escape(title(name))}</h2>{linked}<p>{links(folder, name)}</p>"
                     f"<table>{table(folder, name)}</table></section>")
    meanings = "".join(f"<tr><td>{letter}<td>{html.escape(meaning)}" for letter, meaning in grades())
    parts.append(f"<section><h2>Grades</h2><table>{meanings}</table></section>")
    return "\n".join(parts) + "</html>\n"


def main():
    folder, names = pathlib.Path(sys.argv[1]), [word for word in sys.argv[2:] if word != "--markdown"]
    if "--markdown" in sys.argv:
        for name in names:
            print(f"\n{name}\n\n| | |\n| --- | --- |")
            print("".join(f"| {what} | {value} |\n" for what, value in rows(folder, name)), end="")
        return
    (folder / "index.html").write_text(page(folder, names), encoding="utf-8")


if __name__ == "__main__":
    main()
