#!/usr/bin/env python3
"""deploy/kubernetes and what docs/operating.md says of it. ctest runs each case by itself; by hand
PALPATE_BIN_DIR=build/release/bin tests/deploy/kubernetes_test.py."""
import copy
import json
import os
import re
import shutil
import subprocess
import tempfile
import unittest

import yaml

import manifests
import pods

ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../.."))
# Pods do not have it, and the same dataset comes of the same kernels.
os.environ.pop("OPENBLAS_CORETYPE", None)
PROGRAMS = os.path.abspath(os.environ.get("PALPATE_BIN_DIR", f"{ROOT}/build/release/bin"))
BASE, LIVER = f"{ROOT}/deploy/kubernetes", f"{ROOT}/deploy/scenes/liver"


def typed():
    """The commands of the section: those that set up, and those for later."""
    section = manifests.read(f"{ROOT}/docs/operating.md").split("\n## On Kubernetes\n")[1].split("\n## ")[0]
    blocks = re.findall(r"(?:^    .*\n)+", section, re.M)
    return [re.sub(r"^    ", "", block, flags=re.M) for block in blocks]


def secrets_typed():
    return set(re.findall(r"create secret generic (\S+)", typed()[0]))


def liver():
    return manifests.built(LIVER)


def faults(objects):
    return manifests.faults(objects, secrets_typed(), ROOT)


def change(value, *path):
    """A change at a path: of a value, or without it when it is None."""
    def apply(entry):
        *ways, last = path
        for way in ways:
            entry = entry[way]
        if value is None:
            del entry[last]
        else:
            entry[last] = value
    return apply


POD = ("spec", "template", "spec")
MAIN = (*POD, "containers", 0)
# Mistakes in the manifests: of which object, what, and a part of what is said of it.
MISTAKES = {
    "a word of a container is misspelt": ("Deployment", change({}, *MAIN, "resource"), "resource"),
    "a word of a network policy is misspelt": ("NetworkPolicy", change([], "spec", "egres"), "egres"),
    "a number is a text": ("Deployment", change("4", "spec", "replicas"), "'4' is not of type 'integer'"),
    "a size is none": ("StatefulSet", change("20 GB", "spec", "volumeClaimTemplates", 0, "spec", "resources", "requests", "storage"),
                       "20 GB"),
    "something needed is missing": ("StatefulSet", change(None, "spec", "selector"), "selector"),
    "an older version of a kind": ("Deployment", change("extensions/v1beta1", "apiVersion"), "extensions/v1beta1"),
    "pods have another label than they are selected by":
        ("Deployment", change({"app.kubernetes.io/component": "worker"}, "spec", "template", "metadata", "labels"), "select"),
    "the service selects nobody": ("Service", change({"app": "palpate"}, "spec", "selector"), "does not select"),
    "the service has another name": ("Service", change("scheduler", "metadata", "name"), "there is no Service"),
    "a policy protects nobody": ("NetworkPolicy", change({"app": "palpate"}, "spec", "podSelector", "matchLabels"), "NetworkPolicy"),
    "a policy lets others out": ("NetworkPolicy", change(["Ingress"], "spec", "policyTypes"), "NetworkPolicy"),
    "a policy lets nobody in": ("NetworkPolicy", change({"app": "x"}, "spec", "ingress", 0, "from", 0, "podSelector", "matchLabels"),
                                "no pods are"),
    "a policy is about another port": ("NetworkPolicy", change(7412, "spec", "ingress", 0, "ports", 0, "port"), "the port"),
    "the scheduler listens elsewhere": ("StatefulSet", change(["palpate", "serve", "--listen", "tcp://0.0.0.0:1"], *MAIN, "args"),
                                        "the port"),
    "workers connect elsewhere": ("Deployment", change(["work", "--connect", "tcp://head:7411", "--drain", "10"], *MAIN, "args"),
                                  "do not connect"),
    "the secret has another name": ("Deployment", change("keys", *POD, "volumes", 0, "secret", "secretName"), "Secret keys"),
    "the scene has another name": ("StatefulSet", change("scene", *POD, "volumes", 0, "configMap", "name"), "ConfigMap scene"),
    "the mesh is too large": ("ConfigMap", change("x" * 2 ** 20, "data", "liver-500.msh"), "1 MiB"),
    "a volume is mounted nowhere": ("StatefulSet", change([], *MAIN, "volumeMounts"), "not mounted"),
    "keys are looked for where they are not": ("Deployment", change([{"name": "PALPATE_KEYS", "value": "/etc/keys"}], *MAIN, "env"),
                                              "/etc/keys is in nothing"),
    "workers are killed too early": ("Deployment", change(10, *POD, "terminationGracePeriodSeconds"), "killed"),
    "the scheduler is killed too early": ("StatefulSet", change(30, *POD, "terminationGracePeriodSeconds"), "killed"),
    "reading may not take long": ("StatefulSet", change(3, *MAIN, "startupProbe", "failureThreshold"), "startupProbe"),
    "a worker shares its core": ("Deployment", change("2", *MAIN, "resources", "limits", "cpu"), "cores"),
    "the image is of another version": ("Deployment", change("palpate:latest", *MAIN, "image"), "image"),
    "it may be root": ("Deployment", change(None, *POD, "securityContext", "runAsNonRoot"), "root"),
    "it may call what it likes": ("StatefulSet", change(None, *POD, "securityContext", "seccompProfile"), "root"),
    "it has a token": ("StatefulSet", change(None, *POD, "automountServiceAccountToken"), "token"),
    "it may gain privileges": ("StatefulSet", change(None, *MAIN, "securityContext", "allowPrivilegeEscalation"), "privileges"),
    "it sees the machine": ("StatefulSet", change({"name": "scene", "hostPath": {"path": "/"}}, *POD, "volumes", 0), "restricted pod"),
}


class Kubernetes(unittest.TestCase):
    def testTheManifestsAreOfTheirSchemasAndFitTogether(self):
        self.assertEqual(faults(liver()), [])
        self.assertEqual(len(liver()), 7)

    def testEveryPlantedMistakeIsFound(self):
        for mistake, (kind, make, part) in MISTAKES.items():
            with self.subTest(mistake):
                objects = copy.deepcopy(liver())
                make(manifests.of_kind(objects, kind)[0])
                self.assertIn(part, "\n".join(faults(objects)))

    def testKustomizeMakesTheSameOfThem(self):
        if not shutil.which("kubectl"):
            self.skipTest("there is no kubectl: what kustomize makes of the folders was NOT compared")
        for folder in BASE, LIVER:
            said = subprocess.run(["kubectl", "kustomize", folder], capture_output=True, text=True, check=True).stdout
            # Names of config maps end in a hash of what is in them.
            theirs = list(yaml.safe_load_all(re.sub(r"(name: palpate-scene)-\w+", r"\1", said)))
            by_name = {"key": manifests.named}
            self.assertEqual(sorted(theirs, **by_name), sorted(manifests.built(folder), **by_name))

    def testCommandsOfTheManualAreAboutWhatThereIs(self):
        objects = liver()
        names = {manifests.named(entry) for entry in objects}
        setting_up, later = typed()
        self.assertIn("kubectl apply --server-side -k deploy/scenes/liver", setting_up)
        for folder in re.findall(r"(?:-k|-f) (\S+)", setting_up):
            self.assertTrue(os.path.exists(os.path.join(ROOT, folder)), folder)
        spaces = set(re.findall(r"kubectl -n (\S+)", setting_up + later))
        self.assertEqual(spaces, {entry["metadata"]["namespace"] for entry in objects if entry["kind"] != "Namespace"})
        self.assertEqual({f"Namespace {space}" for space in spaces}, {n for n in names if n.startswith("Namespace")})
        for scaled in re.findall(r"scale deployment (\S+)", later):
            self.assertIn(f"Deployment {scaled}", names)
        asked = set(re.findall(r"(?:exec|cp) ([\w-]+)-0[: ]", later))
        self.assertEqual({f"StatefulSet {name}" for name in asked}, {n for n in names if n.startswith("StatefulSet")})
        copied = re.search(r"cp \S+:(\S+)", later)[1]
        self.assertEqual(copied, manifests.after("-o", manifests.words_of(manifests.component(objects, "scheduler")["spec"]["template"]
                                                                          ["spec"]["containers"][0])))


# Notes the secrets that it is told to make, and nothing else.
KUBECTL = """#!/usr/bin/python3
import os, shutil, sys
words = sys.argv[1:]
if "secret" in words:
    (folder,) = [word.split("=", 1)[1] for word in words if word.startswith("--from-file=")]
    shutil.copytree(folder, os.path.join(os.environ["NOTED"], words[words.index("generic") + 1]))
"""


@unittest.skipIf(os.geteuid() != 0, "not root: the manifests were NOT run")
@unittest.skipUnless(all(shutil.which(tool) for tool in ("bwrap", "nsenter", "setpriv", "ip")),
                     "no bubblewrap or util-linux: the manifests were NOT run")
class KubernetesRun(unittest.TestCase):
    def setUp(self):
        if re.search("lib[at]san", subprocess.run(["ldd", f"{PROGRAMS}/palpate"], capture_output=True, text=True, check=True).stdout):
            self.skipTest("programs with sanitizers are too slow for this and were NOT run by the manifests")
        self.folder = tempfile.mkdtemp(prefix="palpate-kubernetes-")
        self.addCleanup(shutil.rmtree, self.folder)
        os.chmod(self.folder, 0o755)
        # Beside each other, and where another user reaches them.
        programs = os.path.join(self.folder, "programs")
        os.mkdir(programs)
        for program in "palpate", "palpate-scheduler", "palpate-worker":
            shutil.copy(os.path.join(PROGRAMS, program), programs)
        objects = liver()
        scene = manifests.of_kind(objects, "ConfigMap")[0]
        # A third of the points: nobody waits for the others.
        scene["data"]["scene.toml"] = re.sub(r"spacing = [\d.]+", "spacing = 0.03", scene["data"]["scene.toml"])
        self.scene = scene["data"]
        self.scheduler, self.worker = manifests.component(objects, "scheduler"), manifests.component(objects, "worker")
        self.cluster = pods.Cluster(programs, {scene["metadata"]["name"]: self.scene}, self.set_up_as_told(programs))
        self.addCleanup(self.cluster.close)

    def set_up_as_told(self, programs):
        """Types the commands of the manual; the contents of the secrets that come of it."""
        noted, bin_folder = os.path.join(self.folder, "secrets"), os.path.join(self.folder, "bin")
        os.mkdir(noted)
        os.mkdir(bin_folder)
        with open(os.path.join(bin_folder, "kubectl"), "w", encoding="utf-8") as file:
            file.write(KUBECTL)
        os.chmod(file.name, 0o755)
        os.symlink(f"{ROOT}/deploy", os.path.join(self.folder, "deploy"))
        subprocess.run(["bash", "-euo", "pipefail", "-c", typed()[0]], cwd=self.folder, check=True, stdout=subprocess.DEVNULL,
                       env={"PATH": f"{bin_folder}:{programs}:/usr/bin:/bin", "NOTED": noted})
        return {name: {key: manifests.read(os.path.join(noted, name, key)) for key in os.listdir(os.path.join(noted, name))}
                for name in os.listdir(noted)}

    def undisturbed(self):
        """The dataset of the same scene, built without any of this."""
        for name, text in self.scene.items():
            with open(os.path.join(self.folder, name), "w", encoding="utf-8") as file:
                file.write(text)
        subprocess.run([f"{self.folder}/programs/palpate", "build", "scene.toml", "-o", "out.h5", "-q"], cwd=self.folder,
                       stdout=subprocess.DEVNULL, check=False)
        with open(os.path.join(self.folder, "out.h5"), "rb") as file:
            return file.read()

    def recorded(self, scheduler):
        asked = scheduler.execute(["palpate", "status", "--json"])
        return json.loads(asked.stdout)["recorded"] if asked.returncode == 0 else -1

    def ended(self, scheduler):
        """When it noted that it has nothing more to do; None before. A container that is begun again finds the note of the one
        before, which it removes, but not at once."""
        try:
            return os.stat(os.path.join(scheduler.volumes["run"], "ended")).st_mtime_ns
        except FileNotFoundError:
            return None

    def testABuildByTheManifestsEndsWithTheSameDatasetThoughPodsComeAndGo(self):
        workers = [self.cluster.start(self.worker, f"palpate-worker-{n}") for n in range(2)]
        scheduler = self.cluster.start(self.scheduler, "palpate-scheduler-0")
        self.assertTrue(pods.eventually(lambda: scheduler.answers("startupProbe"), scheduler), scheduler.said())
        self.assertTrue(pods.eventually(lambda: self.recorded(scheduler) >= 10, scheduler), scheduler.said() + workers[0].said())

        self.assertEqual(scheduler.execute(["palpate", "pause"]).returncode, 0)
        for command in re.findall(r"exec palpate-scheduler-0 -- (.*?) *(?:#.*)?$", typed()[1], re.M):
            told = scheduler.execute(command.split())
            self.assertEqual(told.returncode, 0, told.stdout)
        told = workers[0].execute(["palpate", "status", "tcp://palpate-scheduler:7411"])
        self.assertIn("refused", told.stdout, "a worker's key is for work alone")
        self.assertNotEqual(scheduler.execute(["touch", "/usr/here"]).returncode, 0, "its root can be written")
        self.assertEqual(workers[1].end(), 130, workers[1].said())  # scaled away
        self.assertEqual(scheduler.end(), 130, scheduler.said())  # drained from its node

        scheduler = self.cluster.start(self.scheduler, "palpate-scheduler-0")
        self.assertTrue(pods.eventually(lambda: scheduler.answers("startupProbe"), scheduler), scheduler.said())
        self.assertEqual(scheduler.execute(["palpate", "resume"]).returncode, 0)
        # Workers were dismissed by the scheduler that ended, or not yet: whatever ends is begun again.
        self.assertTrue(pods.eventually(lambda: workers[0].kept() and "sealed after" in scheduler.said(), scheduler), scheduler.said())
        self.assertIn("going on", scheduler.said())

        # It stays, counts as well, and ends at once when it is told to; begun again there is nothing to do.
        before = None
        for last in False, True:
            self.assertTrue(pods.eventually(lambda: self.ended(scheduler) not in (None, before), scheduler), scheduler.said())
            before = self.ended(scheduler)
            self.assertTrue(scheduler.answers("startupProbe") and scheduler.answers("livenessProbe"))
            self.assertEqual(scheduler.end(), 0)
            if not last:
                scheduler.begin()
        with open(os.path.join(self.cluster.root, "claim-data-palpate-scheduler-0/dataset.h5"), "rb") as file:
            self.assertEqual(file.read(), self.undisturbed())

    def testASceneThatIsWrongEndsThePodWithItsReason(self):
        self.scene["scene.toml"] = self.scene["scene.toml"].replace("mooney-rivlin", "money-rivlin")
        scheduler = self.cluster.start(self.scheduler, "palpate-scheduler-0")
        self.assertEqual(scheduler.process.wait(60), 2)
        self.assertIn("money-rivlin", scheduler.said())

    def testKeysAsASecretIsMountedAreRefused(self):
        """Why the manifests copy them first."""
        worker = copy.deepcopy(self.worker)
        container = manifests.pod_of(worker)["containers"][0]
        container["env"] = [{"name": "PALPATE_KEYS", "value": "/etc/palpate/keys"}]
        container["volumeMounts"].append({"name": "keys", "mountPath": "/etc/palpate/keys", "readOnly": True})
        pod = self.cluster.start(worker, "palpate-worker-0")
        self.assertNotEqual(pod.process.wait(60), 0)
        self.assertIn("others may read or change it", pod.said())


if __name__ == "__main__":
    unittest.main()
