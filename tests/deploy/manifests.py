"""Kubernetes manifests as kustomize would make them, and checks of them: against their schemas, for consistent ports,
times and cores, and for the privileges of pods."""
import json
import os
import re

import jsonschema
import yaml

HERE = os.path.dirname(os.path.abspath(__file__))


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def built(folder):
    """The objects of a folder with a kustomization.yaml. Supports the part of kustomize that the project uses, without
    hash suffixes of names. Raises ValueError for anything else."""
    kustomization = yaml.safe_load(read(os.path.join(folder, "kustomization.yaml")))
    unknown = set(kustomization) - {"apiVersion", "kind", "namespace", "resources", "configMapGenerator"}
    if unknown:
        raise ValueError(f"{folder}/kustomization.yaml: this test knows nothing of {', '.join(sorted(unknown))}")
    objects = []
    for resource in kustomization.get("resources", ()):
        path = os.path.join(folder, resource)
        objects += built(path) if os.path.isdir(path) else list(yaml.safe_load_all(read(path)))
    for generator in kustomization.get("configMapGenerator", ()):
        pairs = [entry.split("=", 1) if "=" in entry else (entry, entry) for entry in generator["files"]]
        objects.append({"apiVersion": "v1", "kind": "ConfigMap", "metadata": {"name": generator["name"]},
                        "data": {key: read(os.path.join(folder, file)) for key, file in pairs}})
    for entry in objects:
        if "namespace" in kustomization and entry["kind"] != "Namespace":
            entry["metadata"]["namespace"] = kustomization["namespace"]
    return objects


def named(entry):
    return f"{entry['kind']} {entry['metadata']['name']}"


def of_kind(objects, *kinds):
    return [entry for entry in objects if entry["kind"] in kinds]


def workloads(objects):
    return of_kind(objects, "StatefulSet", "Deployment")


def pod_of(workload):
    return workload["spec"]["template"]["spec"]


def containers_of(workload):
    return pod_of(workload).get("initContainers", []) + pod_of(workload)["containers"]


def words_of(container):
    return container.get("command", []) + container.get("args", [])


def after(option, words):
    """The word after an option; None without it."""
    return words[words.index(option) + 1] if option in words[:-1] else None


def component(objects, name):
    """The only workload that is the scheduler, or the worker."""
    return next(w for w in workloads(objects)
                if w["spec"]["template"]["metadata"]["labels"].get("app.kubernetes.io/component") == name)


# ---- Schemas ----

def schema_faults(objects):
    schemas = json.loads(read(os.path.join(HERE, "kubernetes-schemas.json")))
    for entry in objects:
        name = schemas["kinds"].get(f"{entry.get('apiVersion')} {entry.get('kind')}")
        if name is None:
            yield f"{entry.get('apiVersion')} {entry.get('kind')}: no kind that this test has a schema of"
            continue
        check = jsonschema.Draft4Validator({"$ref": f"#/definitions/{name}", "definitions": schemas["definitions"]})
        for error in check.iter_errors(entry):
            yield f"{named(entry)}: {'/'.join(map(str, error.path))}: {error.message}"


# ---- Consistency ----

def ports_in(objects):
    """Every place that names the port of the scheduler, with its value."""
    scheduler, worker = component(objects, "scheduler"), component(objects, "worker")
    serve, work = containers_of(scheduler)[-1], containers_of(worker)[-1]
    yield "--listen", int(after("--listen", words_of(serve)).rsplit(":", 1)[1])
    yield "--connect", int(after("--connect", words_of(work)).rsplit(":", 1)[1])
    for port in serve["ports"]:
        yield "containerPort", port["containerPort"]
    for service in of_kind(objects, "Service"):
        for port in service["spec"]["ports"]:
            yield named(service), port.get("targetPort", port["port"])
            yield named(service), port["port"]
    for policy in of_kind(objects, "NetworkPolicy"):
        for rule in policy["spec"].get("ingress", []) + policy["spec"].get("egress", []):
            if any(set(peer) == {"podSelector"} for peer in rule.get("from", rule.get("to"))):
                for port in rule["ports"]:
                    yield named(policy), port["port"]


def agreement_faults(objects, sources):
    ports = list(ports_in(objects))
    if len({port for _, port in ports}) != 1 or len(ports) < 7:
        yield f"the port is not the same everywhere: {ports}"
    scheduler, worker = component(objects, "scheduler"), component(objects, "worker")
    work = containers_of(worker)[-1]
    host = re.fullmatch(r"tcp://([\w-]+):\d+", after("--connect", words_of(work)))
    if not host or host[1] != scheduler["spec"]["serviceName"]:
        yield "workers do not connect to the Service of the scheduler"
    # Defaults of the programs, from their sources: a missing constant fails the test.
    served_build = read(os.path.join(sources, "scheduler/verbs/served_build.hpp"))
    serve_command = read(os.path.join(sources, "scheduler/verbs/serve_command.cpp"))
    drain = int(re.search(r"std::chrono::seconds drain_limit\{(\d+)\}", served_build)[1])
    longest = 3600 * int(re.search(r"std::chrono::hours longest_pause\{(\d+)\}", serve_command)[1])
    for workload, least in (scheduler, drain + 30), (worker, int(after("--drain", words_of(work))) + 10):
        if pod_of(workload).get("terminationGracePeriodSeconds", 0) < least:
            yield f"{named(workload)}: it is killed before it had its {least} s"
    for probe in "startupProbe", "livenessProbe":
        has = containers_of(scheduler)[-1][probe]
        if has["periodSeconds"] * has["failureThreshold"] < longest:
            yield f"{named(scheduler)}: its {probe} ends it before the {longest} s that reading may take"
    cores = after("-j", words_of(work)) or "1"
    for container in containers_of(worker):
        if container["resources"]["requests"] != container["resources"]["limits"] \
                or container["resources"]["limits"]["cpu"] != cores:
            yield f"{named(worker)}, {container['name']}: not as many cores, kept for it, as it has workers"
    version = re.search(r"project\(palpate VERSION ([\d.]+)", read(os.path.join(sources, "CMakeLists.txt")))[1]
    for workload in workloads(objects):
        for container in containers_of(workload):
            if container["image"] != f"palpate:{version}":
                yield f"{named(workload)}, {container['name']}: the image is not palpate:{version}"


# ---- Pod Security Standards, "restricted" ----

def privilege_faults(objects):
    for workload in workloads(objects):
        pod, context = pod_of(workload), pod_of(workload).get("securityContext", {})
        if context.get("seccompProfile") != {"type": "RuntimeDefault"} or not context.get("runAsNonRoot") \
                or context.get("runAsUser", 0) == 0:
            yield f"{named(workload)}: it may be root, or call whatever it likes"
        if pod.get("automountServiceAccountToken", True) or {"hostNetwork", "hostPID", "hostIPC"} & pod.keys():
            yield f"{named(workload)}: it has a token of the cluster, or what is the machine's"
        for volume in pod.get("volumes", []):
            if not volume.keys() - {"name"} <= {"configMap", "emptyDir", "persistentVolumeClaim", "secret"}:
                yield f"{named(workload)}: volume {volume['name']} is none that a restricted pod may have"
        for container in containers_of(workload):
            if container.get("securityContext") != {"allowPrivilegeEscalation": False, "readOnlyRootFilesystem": True,
                                                    "capabilities": {"drop": ["ALL"]}}:
                yield f"{named(workload)}, {container['name']}: it may gain privileges, or write where it should not"


def faults(objects, sources):
    wrong = list(schema_faults(objects))
    # Objects that do not match their schema are not checked further.
    return wrong or [*agreement_faults(objects, sources), *privilege_faults(objects)]
