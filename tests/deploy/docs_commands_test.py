#!/usr/bin/env python3
"""Checks that verbs, options and scripts in the documentation exist, and that promtool confirms an alert. pages_run_test.py
runs the commands. By hand PALPATE_BIN_DIR=build/release/bin tests/deploy/docs_commands_test.py."""
import functools
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BIN = pathlib.Path(os.environ.get("PALPATE_BIN_DIR", ROOT / "build/release/bin")).resolve()
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]


def commands():
    """(page:line, command) for each command line in code of the pages, without comments, with its continuation lines."""
    for page in PAGES:
        fenced, pending = "", ""
        for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
            if line.startswith("```"):
                fenced = "" if fenced else line[3:].strip() or "text"
                continue
            code = line if fenced in ("sh", "bash") else line[4:] if not fenced and line.startswith("    ") else ""
            text = pending + re.sub(r"(^|\s)#.*", "", code).strip()
            pending = text[:-1] if text.endswith("\\") else ""
            if text and not pending:
                for command in filter(None, re.split(r"\s*(?:&&|\|)\s*", text)):
                    yield f"{page.relative_to(ROOT)}:{number}", re.sub(r"^(sudo|time|nohup|[A-Z_]+=\S+) ", "", command.strip())


@functools.cache
def help_of(*verb):
    """The help of a verb, or of its sub-verb (`key new`)."""
    done = subprocess.run([BIN / "palpate", *verb, "--help"], capture_output=True, text=True, check=False)
    return done.stdout if done.returncode == 0 else ""


class DocsCommands(unittest.TestCase):
    maxDiff = None

    def testEveryVerbAndOptionOfThePagesExists(self):
        wrong, seen = [], 0
        for where, command in commands():
            words = command.split()
            if words[0] != "palpate" or len(words) < 2 or not words[1].isalpha() or not words[1].islower():
                continue
            seen += 1
            text = help_of(words[1])
            if re.search(r"^Subcommands:", text, re.M) and len(words) > 2:
                text = help_of(*words[1:3])
            if not text:
                wrong.append(f"{where}: there is no verb {words[1]}: {command}")
                continue
            own = words[:words.index("--")] if "--" in words else words  # words after -- belong to another program
            for option in re.findall(r"(?<!\S)(--[a-z][a-z-]*)", " ".join(own)):
                if not re.search(rf"(^|[\s,]){option}\b", text):
                    wrong.append(f"{where}: palpate {words[1]} has no {option}: {command}")
        self.assertEqual(wrong, [])
        self.assertGreater(seen, 60)

    def testEveryScriptOfThePagesExists(self):
        wrong, seen = [], 0
        for where, command in commands():
            script = command.split()[0]
            if not re.match(r"(deploy|tests)/[a-z_/-]+(\.py)?$", script):
                continue
            seen += 1
            if not os.access(ROOT / script, os.X_OK):
                wrong.append(f"{where}: {script} cannot be run")
        self.assertEqual(wrong, [])
        self.assertGreater(seen, 10)

    @unittest.skipUnless(shutil.which("promtool"), "NOT TESTED: promtool (Debian: prometheus)")
    def testTheAlertForReadyTransitionsFiresOnlyWithoutWorkers(self):
        page = (ROOT / "docs/metrics.md").read_text(encoding="utf-8")
        alert = re.search(r"^- `(palpate_ready_transitions .*)`$", page, re.M)[1]
        series = {f'palpate_ready_transitions{{instance="{build}",job="palpate"}}': "5 5" for build in ("busy", "idle")}
        series['palpate_workers{instance="busy",job="palpate",host="node1",state="busy"}'] = "2 2"
        expected = [{"exp_labels": {"instance": "idle", "job": "palpate"}}]
        with tempfile.TemporaryDirectory() as folder:
            rules, tests = pathlib.Path(folder, "rules.json"), pathlib.Path(folder, "tests.json")
            rules.write_text(json.dumps({"groups": [{"name": "docs", "rules": [{"alert": "NoWorkers", "expr": alert}]}]}))
            tests.write_text(json.dumps({"rule_files": [str(rules)], "tests": [
                {"interval": "1m", "input_series": [{"series": name, "values": values} for name, values in series.items()],
                 "alert_rule_test": [{"eval_time": "1m", "alertname": "NoWorkers", "exp_alerts": expected}]}]}))
            done = subprocess.run(["promtool", "test", "rules", tests], capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
