"""The paper's organ, laws and lattices on available livers: meshes of about the paper's sizes, a fixed region, a moved
tip.

Uses reference livers (PALPATE_MESHES, or ../shared/meshes beside the sources) if they exist, otherwise the shipped ones;
`source` says which. All lengths in metres."""
import dataclasses
import os
import pathlib

from record import ROOT

REFERENCE = pathlib.Path(os.environ.get("PALPATE_MESHES", ROOT / ".." / "shared" / "meshes")).resolve()
SHIPPED = ROOT / "deploy" / "scenes" / "liver"

YOUNG, POISSON, C10, C01 = 15480.0, 0.49, 1300.0, 1280.0  # Pa: pig liver of the paper

MATERIALS = {
    "linear": f'law = "linear"\nyoung = {YOUNG}\npoisson = {POISSON}',
    "svk": f'law = "st-venant-kirchhoff"\nyoung = {YOUNG}\npoisson = {POISSON}',
    "msvk": f'law = "modified-st-venant-kirchhoff"\nyoung = {YOUNG}',
    "mr": f'law = "mooney-rivlin"\nc10 = {C10}\nc01 = {C01}',
}
LAWS = {"linear": "linear", "svk": "St. Venant-Kirchhoff", "msvk": "modified St. Venant-Kirchhoff", "mr": "Mooney-Rivlin"}

# Points of a lattice of 100 mm radius with this many spacings, without the origin, as in the paper.
LATTICES = {5: 514, 7: 1418, 10: 4168, 15: 14146}


@dataclasses.dataclass(frozen=True)
class Organ:
    name: str            # as in tables, such as liver-493
    mesh: pathlib.Path
    fixed: str           # TOML of [fixed]
    tip: tuple           # place of the active node, m
    source: str          # "reference" or "shipped"


def organ(nodes):
    """Returns the liver with about 500, 2000 or 6000 nodes."""
    reference = {500: "liver-493", 2000: "liver-2228", 6000: "liver-5984"}[nodes]
    if (REFERENCE / f"{reference}.msh").is_file():
        return Organ(reference, REFERENCE / f"{reference}.msh", 'below = { axis = "x", fraction = 0.15 }', (0.0582, 0.1344, 0.0025), "reference")
    shipped = SHIPPED / f"liver-{min(nodes, 2000)}.msh"
    return Organ(shipped.stem, shipped, "sphere = { center = [-0.035, 0.056, 0.025], radius = 0.024 }", (0.106, -0.020, 0.020), "shipped")


def scene(organ, law="mr", radius=0.1, divisions=5, displacement="P1", pressure=None, constraint="ln-det-F", patch=0.0, tool="rigid",
          max_force=1e6, accuracy="", active=None, name=None, storage=""):
    """Text of a scene file: `divisions` lattice spacings in `radius`. No point exceeds max_force = 1e6, as in the paper's
    experiments. `accuracy` and `storage` are lines of those sections; `active` replaces the tip."""
    incompressible = law in ("mr", "msvk")
    pressure = pressure or (("P1-stabilized" if displacement == "P1" else "P1") if incompressible else "none")
    place = active or f"near = [{', '.join(map(str, organ.tip))}]"
    return f"""\
name = "{name or f'{organ.name}-{law}'}"
mesh = "{organ.mesh}"
[material]
{MATERIALS[law]}
[discretization]
displacement = "{displacement}"
pressure = "{pressure}"
constraint = "{constraint}"
[fixed]
{organ.fixed}
[[active]]
name = "tip"
{place}
radius = {patch}
tool = "{tool}"
[workspace]
radius = {radius}
spacing = {radius / divisions!r}
max_force = {max_force}
{f'[accuracy]{chr(10)}{accuracy}{chr(10)}' if accuracy else ''}{f'[storage]{chr(10)}{storage}{chr(10)}' if storage else ''}"""


def directions():
    """The 26 directions of the paper's regular paths: unit vectors to the neighbours of a lattice point."""
    steps = (-1, 0, 1)
    every = [(i, j, k) for i in steps for j in steps for k in steps if (i, j, k) != (0, 0, 0)]
    length = lambda v: sum(x * x for x in v) ** 0.5
    return [tuple(x / length(v) for x in v) for v in every]
