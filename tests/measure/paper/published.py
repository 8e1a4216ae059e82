"""Published numbers: Peterlik, Sedef, Basdogan, Matyska, Computers & Graphics 34 (2010) 43-54, and others where stated.

"The paper" in this folder is that one. Numbers read off a figure, or given in words in the text, are marked."""

# Table 1: s of one Newton iteration on an Opteron 250 (2 GHz): (law, displacement order, nodes): unknowns, total.
NEWTON_ITERATION = {
    ("svk", 1, 501): {"unknowns": 1539, "assembly": 0.49, "solve": 0.05, "total": 0.54},
    ("mr", 1, 501): {"unknowns": 2040, "assembly": 1.05, "solve": 0.23, "total": 1.28},
    ("svk", 1, 2011): {"unknowns": 6069, "assembly": 3.22, "solve": 0.71, "total": 3.93},
    ("mr", 2, 501): {"unknowns": 12323, "assembly": 3.38, "solve": 3.18, "total": 6.56},
    ("mr", 1, 2011): {"unknowns": 8080, "assembly": 8.15, "solve": 1.74, "total": 9.89},
}

# Sec. 6.1: share of 520 paths of 100 mm that converges, %.
CONVERGED = {"svk": 47, "msvk": 95, "mr": 95}  # the last two "about"; Mooney-Rivlin fails in "less than 5 %"

# Sec. 6.2, Fig. 7: minutes on 64 cores by lattice points, least and most of all rows of Table 1. 1418: "about 1 h" (10,270
# tetrahedra). 4168: less than 45 min (501 nodes) to "about 3 h". 14146: not published.
BUILD_MINUTES = {514: (2, 28), 1418: (60, 60), 4168: (45, 180)}
BUILD_WORDS = {514: "2 to 28", 1418: "about 60", 4168: "less than 45 to about 180"}
DATASET_MB = {(501, 514): 3, (501, 14146): 81, (2011, 514): 11, (2011, 14146): 325}

# Sec. 6.3, Figs. 8 and 9: largest relative error of the force.
LARGEST_ERROR = {("trilinear", 14146): 30, ("rbf-cubic", 514): 20}  # %: "up to 30 %", "less than 20 %"

OTHERS = {
    "SOFA ModelOrderReduction": ("262.6 frames/s (gravity) and 172.7 (rotation) instead of 0.62, liver of 4293 nodes; no error is stated",
                                 "github.com/SofaDefrost/ModelOrderReduction, doc/sphinx/source/usage/examples/Liver/liver.md"),
    "hyperelastic bodies with friction": ("20 to 100 Hz", "Courtecuisse et al., IROS 2015"),
    "learned livers": ("mean error of the shape below 1 mm, within 3 mm at 99.96 % (one force) and 99.84 % (two forces) of the nodes; "
                       "more than 100 Hz; no error of a force; of an abstract",
                       "Pellicer-Valero et al., Expert Systems with Applications 143 (2020) 113083"),
}
