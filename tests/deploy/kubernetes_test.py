#!/usr/bin/env python3
"""Checks deploy/kubernetes and its section in docs/operating.md. ctest runs each case separately."""
import copy
import os
import re
import unittest

import yaml

import manifests

ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../.."))


def typed():
    """The commands of the section: those for setting up, and those for later use."""
    section = manifests.read(f"{ROOT}/docs/operating.md").split("\n## On Kubernetes\n")[1].split("\n## ")[0]
    blocks = re.findall(r"(?:^    .*\n)+", section, re.M)
    return [re.sub(r"^    ", "", block, flags=re.M) for block in blocks]


def liver():
    return manifests.built(f"{ROOT}/deploy/scenes/liver")


def change(value, *path):
    """Sets the value at a path, or removes it if the value is None."""
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
# Mistakes in the manifests: the object, the change, and a part of the expected message.
MISTAKES = {
    "a word is misspelt": ("Deployment", change({}, *MAIN, "resource"), "resource"),
    "a number is a text": ("Deployment", change("4", "spec", "replicas"), "'4' is not of type 'integer'"),
    "something needed is missing": ("StatefulSet", change(None, "spec", "selector"), "selector"),
    "an older version of a kind": ("Deployment", change("extensions/v1beta1", "apiVersion"), "extensions/v1beta1"),
    "a policy is about another port": ("NetworkPolicy", change(7412, "spec", "ingress", 0, "ports", 0, "port"), "the port"),
    "workers connect elsewhere": ("Deployment", change(["work", "--connect", "tcp://head:7411", "--drain", "10"], *MAIN, "args"),
                                  "do not connect"),
    "workers are killed too early": ("Deployment", change(10, *POD, "terminationGracePeriodSeconds"), "killed"),
    "reading may not take long": ("StatefulSet", change(3, *MAIN, "startupProbe", "failureThreshold"), "startupProbe"),
    "a worker shares its core": ("Deployment", change("2", *MAIN, "resources", "limits", "cpu"), "cores"),
    "the image is of another version": ("Deployment", change("palpate:latest", *MAIN, "image"), "image"),
    "it may be root": ("Deployment", change(None, *POD, "securityContext", "runAsNonRoot"), "root"),
    "it has a token": ("StatefulSet", change(None, *POD, "automountServiceAccountToken"), "token"),
    "it may gain privileges": ("StatefulSet", change(None, *MAIN, "securityContext", "allowPrivilegeEscalation"), "privileges"),
    "it sees the machine": ("StatefulSet", change({"name": "scene", "hostPath": {"path": "/"}}, *POD, "volumes", 0), "restricted pod"),
}


class Kubernetes(unittest.TestCase):
    def testTheManifestsMatchTheirSchemasAndEachOther(self):
        self.assertEqual(manifests.faults(liver(), ROOT), [])
        self.assertEqual(len(liver()), 7)

    def testEveryPlantedMistakeIsFound(self):
        for mistake, (kind, make, part) in MISTAKES.items():
            with self.subTest(mistake):
                objects = copy.deepcopy(liver())
                make(manifests.of_kind(objects, kind)[0])
                self.assertIn(part, "\n".join(manifests.faults(objects, ROOT)))

    def testCommandsOfTheManualNameExistingObjects(self):
        objects = liver()
        names = {manifests.named(entry) for entry in objects}
        setting_up, later = typed()
        self.assertIn("kubectl apply --server-side -k deploy/scenes/liver", setting_up)
        for folder in re.findall(r"(?:-k|-f) (\S+)", setting_up):
            self.assertTrue(os.path.exists(os.path.join(ROOT, folder)), folder)
        secrets = {volume["secret"]["secretName"] for workload in manifests.workloads(objects)
                   for volume in manifests.pod_of(workload)["volumes"] if "secret" in volume}
        self.assertEqual(set(re.findall(r"create secret generic (\S+)", setting_up)), secrets)
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


if __name__ == "__main__":
    unittest.main()
