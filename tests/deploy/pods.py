"""Pods without a cluster: the containers of a manifest with its words, users, mounts, volumes as kubelet lays them, and a root
that cannot be written, in namespaces of their own (bubblewrap). They share one network, which is no other's. Needs root."""
import os
import shutil
import signal
import subprocess
import tempfile
import time

import manifests


def folders_above(path):
    """Words for bubblewrap, which by itself makes these for root alone."""
    above = os.path.dirname(path)
    return [word for end in range(1, len(above) + 1) if above[end:end + 1] in ("/", "")
            for word in ("--perms", "0755", "--dir", above[:end])]


class Cluster:
    """The network, the volumes that outlive pods, and what is mounted by name."""

    def __init__(self, programs, config_maps, secrets):
        self.root = tempfile.mkdtemp(prefix="palpate-pods-")
        os.chmod(self.root, 0o755)
        self.programs, self.config_maps, self.secrets, self.pods = programs, config_maps, secrets, []
        self.network = subprocess.Popen(["unshare", "--net", "sh", "-c", "ip link set lo up && echo up && exec sleep 3600"],
                                        stdout=subprocess.PIPE)
        if self.network.stdout.readline() != b"up\n":
            raise RuntimeError("no network of its own")

    def close(self):
        for pod in self.pods:
            pod.signal(signal.SIGKILL)
            pod.process.wait()
            pod.log.close()
        self.network.kill()
        self.network.wait()
        self.network.stdout.close()
        shutil.rmtree(self.root)

    def start(self, workload, name):
        self.pods.append(Pod(self, workload, name))
        return self.pods[-1]


class Pod:
    def __init__(self, cluster, workload, name):
        self.cluster, self.name, self.process = cluster, name, None
        self.spec = manifests.pod_of(workload)
        self.context = self.spec["securityContext"]
        self.folder = tempfile.mkdtemp(prefix=name + "-", dir=cluster.root)
        os.chmod(self.folder, 0o755)
        self.volumes = {volume["name"]: self.lay(volume) for volume in self.spec["volumes"]}
        for claim in workload["spec"].get("volumeClaimTemplates", ()):
            self.volumes[claim["metadata"]["name"]] = self.claimed(claim["metadata"]["name"])
        for container in self.spec.get("initContainers", ()):
            subprocess.run(self.command_line(container), check=True, timeout=60)
        (self.container,) = self.spec["containers"]
        self.log = open(os.path.join(self.folder, "log"), "w+", encoding="utf-8")
        self.begin()

    # ---- Volumes, as kubelet makes them: root's, and the group's of fsGroup ----

    def claimed(self, name):
        path = os.path.join(self.cluster.root, f"claim-{name}-{self.name}")
        if not os.path.exists(path):
            os.mkdir(path)
            self.own(path, 0o2775)
        return path

    def own(self, path, mode):
        os.chown(path, 0, self.context["fsGroup"])
        os.chmod(path, mode)

    def lay(self, volume):
        path = os.path.join(self.folder, volume["name"])
        os.mkdir(path)
        if "emptyDir" in volume:
            self.own(path, 0o2777)
            return path
        secret = "secret" in volume
        contents = self.cluster.secrets[volume["secret"]["secretName"]] if secret \
            else self.cluster.config_maps[volume["configMap"]["name"]]
        os.mkdir(os.path.join(path, "..2026"))
        os.symlink("..2026", os.path.join(path, "..data"))
        for key, text in contents.items():
            file = os.path.join(path, "..2026", key)
            with open(file, "w", encoding="utf-8") as out:
                out.write(text)
            self.own(file, 0o440 if secret else 0o644)
            os.symlink(f"..data/{key}", os.path.join(path, key))
        self.own(os.path.join(path, "..2026"), 0o2755)
        self.own(path, 0o3777)
        return path

    # ---- Containers ----

    def as_user(self):
        return ["setpriv", f"--reuid={self.context['runAsUser']}", f"--regid={self.context['runAsGroup']}",
                f"--groups={self.context['fsGroup']}", "--bounding-set=-all", "--inh-caps=-all", "--no-new-privs"]

    def environment(self, container):
        return {"PATH": "/opt/palpate:/usr/sbin:/usr/bin:/sbin:/bin",
                **{entry["name"]: entry["value"] for entry in container.get("env", ())}}

    def command_line(self, container):
        hosts = os.path.join(self.folder, "hosts")
        with open(hosts, "w", encoding="utf-8") as file:
            file.write("127.0.0.1 localhost palpate-scheduler\n")
        line = ["nsenter", f"--net=/proc/{self.cluster.network.pid}/ns/net", "bwrap", "--die-with-parent", "--unshare-pid",
                "--as-pid-1", "--unshare-ipc", "--unshare-uts", "--hostname", self.name, "--cap-add", "ALL", "--clearenv",
                "--ro-bind", "/usr", "/usr", "--proc", "/proc", "--dev", "/dev",
                *folders_above("/etc/hosts"), "--ro-bind", hosts, "/etc/hosts",
                *folders_above("/opt/palpate"), "--ro-bind", self.cluster.programs, "/opt/palpate"]
        for folder in "bin", "sbin", "lib", "lib64":
            line += ["--symlink", f"usr/{folder}", f"/{folder}"]
        for file in "ld.so.cache", "alternatives":
            line += ["--ro-bind", f"/etc/{file}", f"/etc/{file}"]
        for mount in container.get("volumeMounts", ()):
            line += [*folders_above(mount["mountPath"]), "--ro-bind" if mount.get("readOnly") else "--bind",
                     self.volumes[mount["name"]], mount["mountPath"]]
        if container["securityContext"]["readOnlyRootFilesystem"]:
            line += ["--remount-ro", "/"]
        for name, value in self.environment(container).items():
            line += ["--setenv", name, value]
        return line + ["--chdir", "/", *self.as_user(), *manifests.words_of(container)]

    def begin(self):
        """Starts the container: the first time, and again as kubelet does when it ended."""
        self.process = subprocess.Popen(self.command_line(self.container), stdout=self.log, stderr=subprocess.STDOUT)

    def kept(self):
        """Begins the container again when it had nothing more to do, as a deployment does. False when it failed."""
        if self.process.poll() == 0:
            self.begin()
        return self.process.poll() is None

    def first_process(self):
        """Its process 1, by the number that it has here; None before there is one, and when it ended."""
        with open(f"/proc/{self.process.pid}/task/{self.process.pid}/children", encoding="utf-8") as file:
            children = file.read().split()
        return int(children[0]) if children else None

    def signal(self, number):
        child = None if self.process.poll() is not None else self.first_process()
        if child:
            os.kill(child, number)

    def end(self):
        """What `kubectl delete pod` does: the exit code, or None when it had to be killed."""
        self.signal(signal.SIGTERM)
        try:
            return self.process.wait(self.spec["terminationGracePeriodSeconds"])
        except subprocess.TimeoutExpired:
            self.signal(signal.SIGKILL)
            return None

    def execute(self, words):
        """What `kubectl exec` does, and probes."""
        child = self.first_process()
        if child is None:
            return subprocess.CompletedProcess(words, -1, "there is no process")
        settings = [f"{name}={value}" for name, value in self.environment(self.container).items()]
        return subprocess.run(["nsenter", f"--target={child}", "--all", "--wd=/", *self.as_user(), "env", "-i", *settings, *words],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=60, check=False)

    def answers(self, probe):
        return self.execute(self.container[probe]["exec"]["command"]).returncode == 0

    def said(self):
        with open(self.log.name, encoding="utf-8") as file:
            return file.read()


def eventually(condition, pod, seconds=300):
    """Waits until it holds: False when it does not in time, or cannot any more because the pod has ended."""
    until = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > until or pod.process.poll() is not None:
            return False
        time.sleep(0.1)
    return True
