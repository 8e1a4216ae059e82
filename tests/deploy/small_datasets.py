"""Small datasets that the programs build here, for tests of their readers in Python."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PACKAGE = ROOT / "deploy" / "python"
EXAMPLES = ROOT / "deploy" / "examples" / "python"
BIN = pathlib.Path(os.environ.get("PALPATE_BIN_DIR", ROOT / "build/release/bin")).resolve()
LIBRARY = BIN.parent / "lib" / "libpalpate.so.0"
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(PACKAGE), "PALPATE_LIBRARY": str(LIBRARY), "PYTHONDONTWRITEBYTECODE": "1"}
os.environ["PALPATE_LIBRARY"] = str(LIBRARY)
sys.path[:0] = [str(PACKAGE), str(ROOT / "tests" / "support")]

try:
    import h5py
    from kuhn_box import box, write_gmsh
    # The sanitizer's run-time must be loaded first; otherwise it ends Python.
    if any(name in LIBRARY.read_bytes() for name in (b"__asan_init", b"__tsan_init")):
        raise ImportError(f"NOT TESTED: {LIBRARY} has a sanitizer in it")
    import palpate
    missing = ""
except (ImportError, OSError) as error:  # NumPy and h5py belong to the packages of the tests
    palpate, missing = None, str(error)

SCENE = """name = "{name}"
mesh = "block.msh"
[material]
law = "mooney-rivlin"
c10 = 1300
c01 = 1280
[fixed]
below = {{ axis = "z", fraction = 0.1 }}
{active}
[workspace]
radius = {radius}
spacing = {spacing}
"""
TIP = """[[active]]
name = "tip"
near = [0.05, 0.05, 0.1]
[[active]]
name = "rim"
near = [0.1, 0.05, 0.1]
"""
FINGER = """[[active]]
name = "finger"
surface = { box = { lowest = [0.02, 0.02, 0.09], highest = [0.08, 0.08, 0.11] } }
tool = "finger"
radius = 0.02
"""


class WithDatasets(unittest.TestCase):
    """A cube of 10 cm, touched at "tip" and "rim", in `file` of `folder`."""

    @classmethod
    def setUpClass(cls):
        if palpate is None:
            raise unittest.SkipTest(missing)
        cls.directory = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.directory.name)
        write_gmsh(cls.folder / "block.msh", *box((4, 4, 4), 0.025))
        cls.file = cls.build("nodes", TIP, 0.02, 0.01)

    @classmethod
    def tearDownClass(cls):
        if palpate is not None:
            cls.directory.cleanup()

    @classmethod
    def build(cls, name, active, radius, spacing, rest=""):
        (cls.folder / f"{name}.toml").write_text(SCENE.format(name=name, active=active, radius=radius, spacing=spacing) + rest,
                                                 encoding="utf-8")
        cls.run_program("build", cls.folder / f"{name}.toml", "-o", cls.folder / f"{name}.h5", "-q", codes=(0, 3))
        return cls.folder / f"{name}.h5"

    @classmethod
    def run_program(cls, *words, codes=(0,)):
        done = subprocess.run([str(word) for word in (BIN / "palpate", *words)], capture_output=True, text=True, check=False)
        if done.returncode not in codes:
            raise AssertionError(f"{words}: {done.returncode}\n{done.stdout}{done.stderr}")
        return done.stdout

    def run_python(self, *words, **environment):
        return subprocess.run([sys.executable, *map(str, words)], capture_output=True, text=True, check=False, cwd=self.folder,
                              env={**ENVIRONMENT, **environment})


