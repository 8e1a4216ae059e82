#!/usr/bin/python3
"""Makes the liver-like organ that Palpate ships: liver-500.msh and liver-2000.msh beside this script.

    apt-get install python3-numpy gmsh
    deploy/scenes/liver/make_liver.py [--out DIR]

The shape is artificial, not a patient's liver: ellipsoids blended into one implicit body, with impressions of the
neighbouring organs. It resembles a liver where touch matters: a thick domed right lobe, a thin left lobe that ends in a
tip, and a hollow underside with a sharp lower edge. Metres.

    x  from the patient's right (-) to the left (+)        y  from the front (-) to the back (+)        z  upwards

implicit_body.py makes its surface and mesh. The committed files were made by Gmsh 4.8.4, Debian 12.
"""
import argparse
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from implicit_body import blend, ellipsoid, mesh_surface, press, surface_of

GRID_SPACING = 0.003  # m; the sharpest feature, the lower edge, has a radius of about 6 mm
MESHES = {  # file: (element size for about this number of nodes, m; Gmsh file version)
    "liver-500.msh": (0.0154, "2.2"),
    "liver-2000.msh": (0.0087, "4.1"),
}


def liver(p):
    """Returns an approximate signed distance at points p (n x 3): negative inside."""
    right = ellipsoid(p, (-0.046, 0.002, 0.002), (0.050, 0.063, 0.062), tilt_deg=8)
    lower_right = ellipsoid(p, (-0.062, -0.012, -0.032), (0.032, 0.042, 0.044), tilt_deg=-10)
    middle = ellipsoid(p, (0.004, -0.014, 0.010), (0.048, 0.047, 0.042), tilt_deg=-14)
    left = ellipsoid(p, (0.050, -0.022, 0.020), (0.056, 0.038, 0.023), tilt_deg=-6)
    body = blend(blend(right, lower_right, 0.03), blend(middle, left, 0.03), 0.03)

    stomach = ellipsoid(p, (0.064, 0.010, -0.050), (0.074, 0.076, 0.058), tilt_deg=-14)
    kidney = ellipsoid(p, (-0.036, 0.064, -0.064), (0.040, 0.052, 0.050))
    gallbladder = ellipsoid(p, (-0.014, -0.044, -0.052), (0.016, 0.050, 0.030))
    spine = ellipsoid(p, (0.020, 0.080, 0.010), (0.037, 0.046, 0.180))
    heart = ellipsoid(p, (0.040, -0.014, 0.092), (0.060, 0.056, 0.046))
    ligament = ellipsoid(p, (0.020, -0.084, -0.005), (0.012, 0.030, 0.055))  # notch of the falciform ligament
    for organ, width in ((stomach, 0.014), (kidney, 0.02), (gallbladder, 0.014), (spine, 0.025), (heart, 0.03),
                         (ligament, 0.02)):
        body = press(body, organ, width)
    return body


def main():
    here = pathlib.Path(__file__).resolve().parent
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--out", type=pathlib.Path, default=here, help="folder for the meshes (beside this script)")
    out = options.parse_args().out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    surface = surface_of(liver, (-0.13, -0.10, -0.10), (0.14, 0.09, 0.10), GRID_SPACING)
    for name, (size, version) in MESHES.items():
        mesh_surface(*surface, out / name, size, ("capsule", "liver"), version)
        print(f"wrote {out / name}")


if __name__ == "__main__":
    main()
