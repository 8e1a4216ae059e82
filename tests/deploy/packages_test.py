#!/usr/bin/env python3
"""Checks deploy/packages, manual pages, completion and the site. deploy/demo --packages tries the packages in a bare
Debian. ctest runs each case separately; by hand PALPATE_BIN_DIR=build/release/bin tests/deploy/packages_test.py."""
import gzip
import html.parser
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BIN = pathlib.Path(os.environ.get("PALPATE_BIN_DIR", ROOT / "build/release/bin")).resolve()


def output(*words, **options):
    done = subprocess.run(list(map(str, words)), capture_output=True, text=True, check=False, **options)
    if done.returncode != 0:
        raise AssertionError(f"{words}: {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def verbs():
    return re.findall(r"^  ([a-z]+) +[A-Z]", output(BIN / "palpate", "--help"), re.M)


class Packages(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def needs(self, *programs):
        for program in programs:
            if shutil.which(program) is None:
                self.skipTest(f"{program} is not installed: this is NOT tested")
        if re.search("lib[at]san", output("ldd", BIN / "palpate")):
            self.skipTest("programs with a sanitizer are not packaged")

    def testContentsMatchNamesAndNeedNoMpi(self):
        self.needs("dpkg-deb", "dpkg-shlibdeps")
        output("cpack", "-B", self.folder, cwd=BIN.parent)
        packages = {path.name.split("_")[0]: path for path in self.folder.glob("*.deb")}
        self.assertEqual(sorted(packages), ["libpalpate-dev", "libpalpate0", "palpate", "palpate-viewer", "python3-palpate"])
        holds = {name: output("dpkg-deb", "-c", path) for name, path in packages.items()}
        for name, files in {"palpate": ("bin/palpate\n", "bin/palpate-scheduler", "bin/palpate-worker", "bin/palpate-answers", "bin/palpate-verify", "palpate/scenes/liver/liver.toml",
                                        "bash-completion/completions/palpate", "doc/palpate/docs/scene.md", "systemd/palpate-work.service"),
                            "palpate-viewer": ("bin/palpate-viewer",), "libpalpate0": ("libpalpate.so.0 ->", "libpalpate.so.0.1.0"),
                            "libpalpate-dev": ("include/palpate.h", "include/palpate/palpate_device.h", "palpate.pc", "PalpateConfig.cmake",
                                               r"libpalpate.so ->", "examples/c/touch.c"),
                            "python3-palpate": ("python3/dist-packages/palpate/__init__.py", "palpate/py.typed")}.items():
            for file in (*files, f"doc/{name}/copyright", f"doc/{name}/changelog.gz"):
                self.assertRegex(holds[name], file)
        # No file is in two packages.
        files = [line.split()[5] for text in holds.values() for line in text.splitlines() if not line.startswith("d")]
        self.assertEqual(len(files), len(set(files)))
        self.assertNotIn("__pycache__", "".join(holds.values()))
        needs = {name: output("dpkg-deb", "-f", path, "Depends") for name, path in packages.items()}
        self.assertNotRegex("".join(needs.values()), "mpi")
        self.assertIn("libmumps-seq-5.5", needs["palpate"])
        self.assertNotRegex(needs["palpate"], "libglfw|libgl1|libopengl")  # only the viewer needs a display
        self.assertNotRegex(needs["libpalpate0"], "mumps|zmq|sqlite|protobuf|glfw")
        for name in ("libpalpate-dev", "python3-palpate"):
            self.assertIn("libpalpate0 (= ", needs[name])
        self.assertEqual(output("dpkg-deb", "-f", packages["python3-palpate"], "Architecture").strip(), "all")
        output("dpkg-deb", "-e", packages["libpalpate0"], self.folder / "control")
        self.assertIn("ldconfig", (self.folder / "control/triggers").read_text(encoding="utf-8"))

    def testEveryVerbHasAManualPage(self):
        self.needs("help2man")
        output(ROOT / "deploy/manual_pages", BIN, self.folder)
        pages = {path.name: gzip.open(path, "rt", encoding="utf-8").read() for path in self.folder.glob("*/*.1.gz")}
        for verb in verbs():
            if verb == "verify":  # a separate program
                continue
            page = pages[f"palpate-{verb}.1.gz"]
            self.assertIn(f".TH PALPATE-{verb.upper()}", page)
            self.assertRegex(page, rf"\npalpate-{verb} \\- \w")
            self.assertIn(".SH OPTIONS", page)
        self.assertTrue({"palpate.1.gz", "palpate-verify.1.gz", "palpate-worker.1.gz", "palpate-answers.1.gz", "palpate-viewer.1.gz"} <= set(pages))

    def testTheShellCompletesVerbsOptionsAndFiles(self):
        def completed(*words):
            line = " ".join(f"'{word}'" for word in (BIN / "palpate", *words))
            script = (f"source '{ROOT}/deploy/completions/palpate'; compopt() {{ :; }}; COMP_WORDS=({line}); "
                      f"COMP_CWORD={len(words)}; _palpate; printf '%s\\n' \"${{COMPREPLY[@]}}\"")
            return output("bash", "-c", script, cwd=self.folder).split()

        self.assertEqual(sorted(set(verbs())), sorted(set(completed("")) - {"--help", "--version"}))
        self.assertEqual(completed("qu"), ["query"])
        self.assertIn("--displacement", completed("query", "--dis"))
        self.assertIn("--json", completed("query", "liver.h5", "--"))
        (self.folder / "liver.h5").touch()
        self.assertEqual(completed("query", "li"), ["liver.h5"])

    def testVersionsNameTheSourcesOfABuild(self):
        text = output(BIN / "palpate", "--version")
        self.assertRegex(text, r"^palpate [0-9.]+\ncommit \S+, \w+( with [a-z ]+ sanitizer)?\n")
        for library in ("GNU", "Eigen", "MUMPS", "OpenBLAS", "HDF5", "SQLite", "ZeroMQ", "Protobuf"):
            self.assertRegex(text, library + r" [0-9]+\.[0-9]")


class Links(html.parser.HTMLParser):
    """The links of a page, the files that it loads, and its anchors."""

    def __init__(self, text):
        super().__init__()
        self.links, self.loads, self.places = [], [], set()
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        self.places.add(attributes.get("id"))
        to = attributes.get("href") or attributes.get("src")
        if to and not to.startswith("data:") and attributes.get("rel") != "canonical":
            (self.links if tag == "a" else self.loads).append(to)


class Site(unittest.TestCase):
    def testLinksOfTheSiteAreValidAndPagesLoadNothingExternal(self):
        if shutil.which("mkdocs") is None:
            self.skipTest("mkdocs is not installed: the site is NOT tested")
        with tempfile.TemporaryDirectory() as gallery:
            for name in ("index.html", "liver.html", "liver.png", "liver.h5", "skin.part.html"):
                (pathlib.Path(gallery) / name).write_text("<a href=liver.html>liver</a>", encoding="utf-8")
            output("env", f"PALPATE_GALLERY={gallery}", ROOT / "deploy/site")
        self.assertEqual({path.name for path in (ROOT / "build/site/gallery").iterdir()}, {"index.html", "liver.html", "liver.png"})
        self.assertIn('href="gallery/index.html"', (ROOT / "build/site/gallery.html").read_text(encoding="utf-8"))
        output("env", "PALPATE_GALLERY=none", "PALPATE_DATASET=none", ROOT / "deploy/site")
        pages = {path: Links(path.read_text(encoding="utf-8")) for path in (ROOT / "build/site").rglob("*.html")}
        self.assertGreater(len(pages), len(list((ROOT / "docs").rglob("*.md"))))
        for name, part in (("options", 'id="palpate-build"'), ("c", "palpate_contact_update"), ("python", "Contact.update")):
            self.assertIn(part, (ROOT / f"build/site/reference-{name}.html").read_text(encoding="utf-8"))
        wrong = []
        for page, found in pages.items():
            if page.name == "404.html":  # its links start at the root of a server
                continue
            for link in found.links + found.loads:
                parts = urllib.parse.urlsplit(link)
                if parts.scheme and link in found.links:
                    continue
                target = (page.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else page
                if not target.exists() or (target in pages and parts.fragment and parts.fragment not in pages[target].places):
                    wrong.append(f"{page}: {link}")
        self.assertEqual(wrong, [])

    def testTheFirstPageHasTheOrganOfTheGalleryOrOfADataset(self):
        if shutil.which("mkdocs") is None:
            self.skipTest("mkdocs is not installed: the site is NOT tested")
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        (folder / "gallery").mkdir()
        for name in ("index.html", "liver.html"):
            (folder / "gallery" / name).write_text("<p>liver</p>", encoding="utf-8")
        dataset = folder / "organ.h5"
        dataset.touch()
        share = folder / "palpate"  # tests/system/share_test.cpp tests the real one, which needs Emscripten

        def embedded(gallery="", organ="", script="exit 1"):
            share.write_text(f"#!/bin/sh\n{script}\n", encoding="utf-8")
            share.chmod(0o755)
            said = output(ROOT / "deploy/site", env={**os.environ, "PALPATE_GALLERY": str(folder / gallery), "PALPATE_DATASET": str(organ),
                                                     "PALPATE_BIN_DIR": str(folder)})
            text = (ROOT / "build/site/index.html").read_text(encoding="utf-8")
            self.assertRegex(text, '<p><img [^>]*src="figures/')  # for browsers without JavaScript or WebGL
            pages = re.findall(r'<iframe[^>]* src="([^"]+)"', text)
            self.assertEqual("without an organ" in said, not pages, said)
            return [(page, (ROOT / "build/site" / page).read_text(encoding="utf-8").strip()) for page in pages]

        self.assertEqual(embedded(gallery="gallery"), [("gallery/liver.html", "<p>liver</p>")])
        self.assertEqual(embedded(organ=dataset, script='echo "$1 $2" > "$4"'), [("organ.html", f"share {dataset}")])
        self.assertEqual(embedded(organ=dataset), [])
        self.assertEqual(embedded(organ=folder / "missing.h5"), [])


if __name__ == "__main__":
    unittest.main()
